#include "app/cli/output_check.h"

#include <system_error>

#include <unistd.h>

#include "core/mesh/mesh_export.h"

namespace isoslider::cli {

namespace fs = std::filesystem;

Outcome checkOutput(const fs::path& output, const fs::path& input) {
    std::error_code ignored;
    const Error here = makeError(ErrorCode::IoError, "", output.string());
    if (output.empty())
        return Outcome::wrongUsage("the output has no name");
    if (fs::equivalent(output, input, ignored))
        return Outcome::wrongUsage(
            makeError(ErrorCode::InvalidArgument, "is the input; choose another output", output.string())
                .line());
    if (fs::is_directory(output, ignored))
        return makeError(ErrorCode::IoError, "is a directory; give a file name", output.string());
    const fs::path folder = output.has_parent_path() ? output.parent_path() : fs::path(".");
    if (!fs::exists(folder, ignored))
        return makeError(ErrorCode::NotFound, "its folder does not exist", output.string());
    if (!fs::is_directory(folder, ignored))
        return makeError(ErrorCode::IoError, "its folder is a file", output.string());
    if (::access(folder.c_str(), W_OK | X_OK) != 0)
        return makeError(ErrorCode::IoError, "its folder may not be written to", output.string());
    return {};
}

Outcome checkMeshOutput(const fs::path& output, const fs::path& input) {
    if (!mesh::isExportSuffix(output)) {
        const auto message = "its suffix names no mesh format; known: .ply .obj .stl .off .om";
        return Outcome::wrongUsage(makeError(ErrorCode::InvalidArgument, message, output.string()).line());
    }
    return checkOutput(output, input);
}

} // namespace isoslider::cli
