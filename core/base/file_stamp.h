#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <vector>

#include "core/base/result.h"

namespace isoslider {

/// What a file's inode states of its content. Times in nanoseconds since 1970.
struct FileStamp {
    std::uint64_t size = 0;
    std::int64_t modified = 0;
    std::int64_t changed = 0; ///< of the inode: no program sets it back
    bool isSettled = false; ///< the last change was long enough ago that a later one has other times
};

/// Errors: NotFound, IoError.
Result<FileStamp> stampFile(const std::filesystem::path& file);
/// Sizes and times are the same.
bool isUntouched(const FileStamp& a, const FileStamp& b);

/// All regular files below a folder, ascending. Errors: IoError; InvalidArgument (more than 100000).
Result<std::vector<std::filesystem::path>> filesBelow(const std::filesystem::path& folder);

/// Finds out whether files change while they are read, by their stamps: also when they are overwritten in place and
/// their modification times set back. Reads no bytes of them.
class FileWatch {
public:
    /// From now on; of a folder, the files that are below it now. What is watched already stays as it is.
    void add(const std::filesystem::path& path);
    /// Only these from now on, and those that were not watched before, too.
    void keepOnly(const std::vector<std::filesystem::path>& files);
    /// Errors: InvalidArgument (naming a file that changed or went away).
    Status check() const;
    /// Of names without folders, sizes and times; the same as long as check() would find nothing changed.
    std::uint64_t digest() const;

private:
    void addFile(const std::filesystem::path& file);

    std::map<std::filesystem::path, std::optional<FileStamp>> files_; ///< by absolute path; none: was not there
};

} // namespace isoslider
