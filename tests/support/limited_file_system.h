#pragma once

#include <cstdint>
#include <filesystem>
#include <map>

#include "core/base/file_system.h"

namespace isoslider::test {

/// The real file system, except for the room it states: as much as a test sets for a folder, each folder a file system
/// of its own where it has a number of its own. Remembers what was created.
class LimitedFileSystem final : public FileSystem {
public:
    void set(const std::filesystem::path& folder, std::uint64_t freeBytes, std::uint64_t fileSystemId = 1) {
        spaces_[folder] = {freeBytes, freeBytes, fileSystemId};
    }
    int created() const { return created_; }

    Result<std::unique_ptr<RandomAccessFile>> openForReading(const std::filesystem::path& path) override {
        return defaultFileSystem().openForReading(path);
    }
    Result<std::unique_ptr<WritableFile>> create(const std::filesystem::path& path) override {
        ++created_;
        return defaultFileSystem().create(path);
    }
    Result<std::unique_ptr<WritableFile>> extend(const std::filesystem::path& path, std::span<const std::byte> head,
                                                 std::uint64_t keepBytes) override {
        return defaultFileSystem().extend(path, head, keepBytes);
    }
    Status renameDurably(const std::filesystem::path& from, const std::filesystem::path& to) override {
        return defaultFileSystem().renameDurably(from, to);
    }
    Status removeFile(const std::filesystem::path& path) override { return defaultFileSystem().removeFile(path); }
    /// Errors: IoError where a test has set none.
    Result<DiskSpace> space(const std::filesystem::path& folder) override {
        const auto found = spaces_.find(folder);
        if (found == spaces_.end())
            return makeError(ErrorCode::IoError, "cannot find the free space", folder.string());
        return found->second;
    }

private:
    std::map<std::filesystem::path, DiskSpace> spaces_;
    int created_ = 0;
};

} // namespace isoslider::test
