#include "app/cli/output_check.h"

#include <system_error>

#include <fmt/format.h>
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

// What is written before it takes the output's name replaces a file just as well.
Outcome checkPartial(const fs::path& output, const fs::path& file) {
    const auto target = linkTarget(output);
    if (!target.isOk() || !isSameFile(partialPath(target.value()), file))
        return {};
    return Outcome::wrongUsage(makeError(ErrorCode::InvalidArgument,
                                         fmt::format("is written as '{}' first, which is the input; choose another "
                                                     "output",
                                                     partialPath(target.value()).string()),
                                         output.string())
                                   .line());
}

bool isBelow(const fs::path& file, const fs::path& folder) {
    for (fs::path above = file.parent_path(); above.has_relative_path(); above = above.parent_path())
        if (isSameFile(above, folder))
            return true;
    return false;
}

} // namespace

Outcome checkOutput(const fs::path& output, const fs::path& input) {
    const Error here = makeError(ErrorCode::IoError, "", output.string());
    if (output.empty())
        return Outcome::wrongUsage("the output has no name");
    ISO_CLI_TRY(checkNotRead(output, {input}));
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

Outcome checkNotRead(const fs::path& output, const std::vector<fs::path>& files) {
    for (const fs::path& file : files) {
        if (isSameFile(output, file))
            return isTheInput(output);
        ISO_CLI_TRY(checkPartial(output, file));
    }
    return {};
}

Outcome checkNotRead(const fs::path& output, const fs::path& volume, const io::VolumeInfo& info) {
    ISO_CLI_TRY(checkNotRead(output, {volume}));
    if (isFolder(volume) && info.dataFiles.empty()) { // too many to be listed: each file in the folder may be one
        const auto file = canonicalPath(output);
        return file.isOk() && isPresent(output) && isBelow(file.value(), volume) ? isTheInput(output) : Outcome();
    }
    return checkNotRead(output, info.dataFiles);
}

Outcome checkMeshOutput(const fs::path& output, const fs::path& input) {
    if (!mesh::isExportSuffix(output)) {
        const auto message = "its suffix names no mesh format; known: .ply .obj .stl .off .om";
        return Outcome::wrongUsage(makeError(ErrorCode::InvalidArgument, message, output.string()).line());
    }
    return checkOutput(output, input);
}

} // namespace isoslider::cli
