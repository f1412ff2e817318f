#include "app/cli/scratch_folder.h"

#include <mutex>
#include <set>

#include "core/base/folders.h"

namespace isoslider::cli {
namespace {

/// Never destroyed: the thread that waits for signals may ask while the program ends.
struct Registry {
    std::mutex mutex;
    std::set<std::filesystem::path> folders;
};

Registry& registry() {
    static auto* const all = new Registry;
    return *all;
}

} // namespace

ScratchFolder::~ScratchFolder() {
    if (path_.empty())
        return;
    removeFolder(path_);
    const std::scoped_lock lock(registry().mutex);
    registry().folders.erase(path_);
}

// Under the lock from before it is there: an end in between would not find it.
Status ScratchFolder::make(const std::filesystem::path& parent, const std::string& name) {
    const std::scoped_lock lock(registry().mutex);
    auto made = makeUniqueFolder(parent, name);
    if (!made.isOk())
        return made.error();
    path_ = std::move(made).value();
    registry().folders.insert(path_);
    return {};
}

// Another thread may add a file while the folder is emptied, which then cannot be removed: hence again.
void removeScratchFolders() {
    constexpr int kTries = 20;
    const std::scoped_lock lock(registry().mutex);
    for (const auto& folder : registry().folders)
        for (int i = 0; i < kTries && isPresent(folder); ++i)
            removeFolder(folder);
}

} // namespace isoslider::cli
