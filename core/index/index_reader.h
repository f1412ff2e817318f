#pragma once

#include <filesystem>
#include <memory>

#include "core/base/file_system.h"
#include "core/index/format/index_format.h"

namespace isoslider::index {

/// An open index: its directory in memory, its pages on disk. Any number of threads at once.
class IndexReader {
public:
    /// Reads preamble and directory, nothing else. Errors: NotFound, IoError, InvalidArgument (not an
    /// index), UnsupportedVersion, Corruption.
    static Result<std::unique_ptr<IndexReader>> open(const std::filesystem::path& path,
                                                     FileSystem& fileSystem = defaultFileSystem());

    const IndexMeta& meta() const { return meta_; }
    const IndexInfo& info() const { return meta_.info; }
    const BrickGrid& grid() const { return grid_; }
    /// What no two indexes share.
    std::span<const std::byte> preambleBytes() const { return preambleBytes_; }
    /// Where the parts end: the first byte of meta.
    std::uint64_t metaOffset() const { return metaOffset_; }
    /// Where files beside the index may lie; null where it lies in memory only. Must still be there then.
    FileSystem* disk() const { return disk_; }
    std::string pathString() const { return file_->path().string(); }

    /// One page's bytes into `bytes`, its checksum verified. Errors: IoError, Corruption.
    Status readPage(const PageEntry& page, std::vector<std::byte>& bytes) const;
    /// Any other part that has a place, a size and a checksum; likewise.
    Status readPart(std::uint64_t offset, std::size_t size, std::uint64_t checksum,
                    std::vector<std::byte>& bytes) const;
    /// Asks the system to read a range before it is needed.
    void willNeed(std::uint64_t offset, std::uint64_t size) const { file_->willNeed(offset, size); }

private:
    IndexReader() = default;

    std::unique_ptr<RandomAccessFile> file_;
    FileSystem* disk_ = nullptr;
    std::vector<std::byte> preambleBytes_;
    std::uint64_t seed_ = 0;
    std::uint64_t metaOffset_ = 0;
    IndexMeta meta_;
    BrickGrid grid_;
};

} // namespace isoslider::index
