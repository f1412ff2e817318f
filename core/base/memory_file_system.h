#pragma once

#include <map>
#include <mutex>

#include "core/base/file_system.h"

namespace isoslider {

/// Files that live in memory, for what is built and used within one run. An open file keeps its bytes
/// though the file system goes or the file is replaced. Any number of threads at once.
class MemoryFileSystem final : public FileSystem {
public:
    Result<std::unique_ptr<RandomAccessFile>> openForReading(const std::filesystem::path& path) override;
    Result<std::unique_ptr<WritableFile>> create(const std::filesystem::path& path) override;
    Status renameDurably(const std::filesystem::path& from, const std::filesystem::path& to) override;
    Status removeFile(const std::filesystem::path& path) override;
    /// `path`: there are neither folders nor links, and what the disk holds is of no interest.
    Result<std::filesystem::path> outputTarget(const std::filesystem::path& path) override;
    bool keepsFiles() const override { return false; }

private:
    using Bytes = std::shared_ptr<std::vector<std::byte>>;
    std::mutex mutex_;
    std::map<std::filesystem::path, Bytes> files_;
};

} // namespace isoslider
