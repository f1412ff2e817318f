#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <span>
#include <utility>

#include "core/base/file_system.h"

namespace isoslider {

/// A file for what memory does not hold while something is made. It comes to be with begin() or the first bytes, and
/// has no name from then on: nothing of it is left, however the program ends. Any number of threads at once.
class ScratchFile {
public:
    /// An earlier file at `path` would be lost.
    explicit ScratchFile(std::filesystem::path path, FileSystem& fileSystem = defaultFileSystem())
        : path_(std::move(path)), fileSystem_(fileSystem) {}

    /// Makes the file without bytes, where it is not there: what is wrong with its place shows before they are found.
    /// Errors: those of FileSystem::create.
    Status begin();
    /// Returns where they are. Errors: those of begin() and WritableFile.
    Result<std::uint64_t> append(std::span<const std::byte> bytes);
    /// REQUIRES: they were appended. Errors: IoError, Corruption (another program cut the file off).
    Status readAt(std::uint64_t offset, std::span<std::byte> out) const;
    std::uint64_t sizeBytes() const;

private:
    Status create();

    std::filesystem::path path_;
    FileSystem& fileSystem_;
    mutable std::mutex mutex_; ///< of what is written
    std::unique_ptr<WritableFile> out_;
    std::unique_ptr<RandomAccessFile> in_; ///< there once something was appended
};

} // namespace isoslider
