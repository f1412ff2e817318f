#include "app/cli/output_check.h"

#include <system_error>

#include <unistd.h>

#include "core/base/file_system.h"
#include "core/base/folders.h"
#include "core/mesh/mesh_export.h"

namespace isoslider::cli {

namespace fs = std::filesystem;
namespace {

Outcome isTheInput(const fs::path& output) {
    return Outcome::wrongUsage(
        makeError(ErrorCode::InvalidArgument, "is the input; choose another output", output.string()).line());
}

} // namespace

Outcome checkOutput(const fs::path& output, const fs::path& input) {
    const Error here = makeError(ErrorCode::IoError, "", output.string());
    if (output.empty())
        return Outcome::wrongUsage("the output has no name");
    if (isSameFile(output, input))
        return isTheInput(output);
    if (isFolder(output))
        return makeError(ErrorCode::IoError, "is a directory; give a file name", output.string());
    const auto target = linkTarget(output);
    if (!target.isOk())
        return target.error();
    const fs::path& written = target.value();
    const fs::path folder = written.has_parent_path() ? written.parent_path() : fs::path(".");
    if (!isPresent(folder))
        return makeError(ErrorCode::NotFound, "its folder does not exist", output.string());
    if (!isFolder(folder))
        return makeError(ErrorCode::IoError, "its folder is a file", output.string());
    if (::access(folder.c_str(), W_OK | X_OK) != 0)
        return makeError(ErrorCode::IoError, "its folder may not be written to", output.string());
    return {};
}

Outcome tryOutput(const fs::path& output) {
    const auto file = AtomicFile::create(output); // and removed: nothing is written
    return file.isOk() ? Outcome() : Outcome(file.error());
}

Outcome checkNotRead(const fs::path& output, const std::vector<fs::path>& dataFiles) {
    for (const fs::path& file : dataFiles)
        if (isSameFile(output, file))
            return isTheInput(output);
    return {};
}

Outcome checkMeshOutput(const fs::path& output, const fs::path& input) {
    if (!mesh::isExportSuffix(output)) {
        const auto message = "its suffix names no mesh format; known: .ply .obj .stl .off .om";
        return Outcome::wrongUsage(makeError(ErrorCode::InvalidArgument, message, output.string()).line());
    }
    ISO_CLI_TRY(checkOutput(output, input));
    return tryOutput(output);
}

} // namespace isoslider::cli
