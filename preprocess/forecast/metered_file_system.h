#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <mutex>

#include "core/base/file_system.h"

namespace isoslider::preprocess {

/// Another file system, and the most bytes that files written through it had at one time, one of them left out: what a
/// build keeps beside its index. Any number of threads at once, where the other one allows it.
class MeteredFileSystem final : public FileSystem {
public:
    /// `leftOut` is the file that is not counted, under this name and while it is partialPath() of it.
    MeteredFileSystem(FileSystem& fileSystem, const std::filesystem::path& leftOut);

    std::uint64_t mostBytes() const { return mostBytes_; }

    Result<std::unique_ptr<RandomAccessFile>> openForReading(const std::filesystem::path& path) override {
        return fileSystem_.openForReading(path);
    }
    Result<std::unique_ptr<WritableFile>> create(const std::filesystem::path& path) override;
    Result<std::unique_ptr<WritableFile>> extend(const std::filesystem::path& path, std::span<const std::byte> head,
                                                 std::uint64_t keepBytes) override;
    Status renameDurably(const std::filesystem::path& from, const std::filesystem::path& to) override;
    Status removeFile(const std::filesystem::path& path) override;
    Result<std::filesystem::path> outputTarget(const std::filesystem::path& path) override {
        return fileSystem_.outputTarget(path);
    }
    void copyPermissions(const std::filesystem::path& from, const std::filesystem::path& to) override {
        fileSystem_.copyPermissions(from, to);
    }
    Result<DiskSpace> space(const std::filesystem::path& folder) override { return fileSystem_.space(folder); }

private:
    class File;
    template <class Open>
    Result<std::unique_ptr<WritableFile>> meter(const std::filesystem::path& path, const Open& open);
    void set(const std::filesystem::path& path, std::uint64_t bytes);
    void forget(const std::filesystem::path& path);

    FileSystem& fileSystem_;
    std::filesystem::path leftOut_, leftOutPartial_;
    std::mutex mutex_;
    std::map<std::filesystem::path, std::uint64_t> sizes_;
    std::uint64_t bytes_ = 0, mostBytes_ = 0;
};

} // namespace isoslider::preprocess
