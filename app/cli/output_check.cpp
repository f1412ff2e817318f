#include "app/cli/output_check.h"

#include <system_error>

#include <fmt/format.h>
#include <unistd.h>

#include "core/base/build_leftovers.h"
#include "core/base/file_system.h"
#include "core/base/folders.h"
#include "core/base/read_conflict.h"
#include "core/mesh/mesh_export.h"

namespace isoslider::cli {

namespace fs = std::filesystem;
namespace {

Outcome isTheInput(const fs::path& output) {
    return Outcome::wrongUsage(
        makeError(ErrorCode::InvalidArgument, "is the input; choose another output", output.string()).line());
}

// What is written before it takes the output's name replaces a file just as well.
Outcome isTheInputFirst(const fs::path& output) {
    const auto target = linkTarget(output);
    return Outcome::wrongUsage(
        makeError(ErrorCode::InvalidArgument,
                  fmt::format("is written as '{}' first, which is the input; choose another output",
                              partialPath(target.isOk() ? target.value() : output).string()),
                  output.string())
            .line());
}

Outcome outcomeOf(ReadConflict conflict, const fs::path& output) {
    switch (conflict) {
        case ReadConflict::Itself: return isTheInput(output);
        case ReadConflict::Partial: return isTheInputFirst(output);
        case ReadConflict::None: break;
    }
    return {};
}

} // namespace

Outcome checkOutput(const fs::path& output, const fs::path& input) {
    const Error here = makeError(ErrorCode::IoError, "", output.string());
    if (output.empty())
        return Outcome::wrongUsage("the output has no name");
    if (const auto index = indexOfLeftover(output))
        return Outcome::wrongUsage(
            makeError(ErrorCode::InvalidArgument,
                      fmt::format("has the name of a part of the index '{}'; choose another output",
                                  index->filename().string()),
                      output.string())
                .line());
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
    return outcomeOf(conflictWith(output, files), output);
}

Outcome checkNotRead(const fs::path& output, const fs::path& volume, const io::VolumeInfo& info) {
    ISO_CLI_TRY(checkNotRead(output, {volume}));
    if (isFolder(volume) && info.dataFiles.empty()) // too many to be listed: each file in the folder may be one
        return outcomeOf(conflictWithFolder(output, volume), output);
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
