#include "core/base/read_conflict.h"

#include "core/base/file_system.h"
#include "core/base/folders.h"

namespace isoslider {
namespace fs = std::filesystem;

namespace {

bool isBelow(const fs::path& file, const fs::path& folder) {
    for (fs::path above = file.parent_path(); above.has_relative_path(); above = above.parent_path())
        if (isSameFile(above, folder))
            return true;
    return false;
}

} // namespace

ReadConflict conflictWith(const fs::path& output, const std::vector<fs::path>& read) {
    const auto target = linkTarget(output);
    for (const fs::path& file : read) {
        if (isSameFile(output, file))
            return ReadConflict::Itself;
        if (target.isOk() && isSameFile(partialPath(target.value()), file))
            return ReadConflict::Partial;
    }
    return ReadConflict::None;
}

ReadConflict conflictWithFolder(const fs::path& output, const fs::path& folder) {
    const auto file = canonicalPath(output);
    return file.isOk() && isPresent(output) && isBelow(file.value(), folder) ? ReadConflict::Itself
                                                                             : ReadConflict::None;
}

} // namespace isoslider
