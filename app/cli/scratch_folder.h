#pragma once

#include <filesystem>
#include <string>

#include "core/base/result.h"

namespace isoslider::cli {

/// A folder for files that are needed only while the program runs. It goes with all that is in it: with this object, or
/// by removeScratchFolders().
class ScratchFolder {
public:
    ScratchFolder() = default;
    ~ScratchFolder();
    ScratchFolder(const ScratchFolder&) = delete;
    ScratchFolder& operator=(const ScratchFolder&) = delete;

    /// Makes `name`-XXXXXX below `parent`, which only this user may look into. Errors: NotFound, OutOfSpace, IoError.
    Status make(const std::filesystem::path& parent, const std::string& name);
    /// Empty until it has been made.
    const std::filesystem::path& path() const { return path_; }

private:
    std::filesystem::path path_;
};

/// Removes all that are there, for an end that runs no destructors. Any thread; others may still be writing.
void removeScratchFolders();

} // namespace isoslider::cli
