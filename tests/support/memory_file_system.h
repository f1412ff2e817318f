#pragma once

#include <cstring>
#include <memory>
#include <string>
#include <utility>

#include "core/base/file_system.h"

namespace isoslider::test {

/// One file that lies in memory, whatever path is asked for; its bytes may change while it is open. Nothing
/// is written.
class MemoryFileSystem final : public FileSystem {
public:
    explicit MemoryFileSystem(const std::string& bytes) : bytes_(bytes) {}

    Result<std::unique_ptr<RandomAccessFile>> openForReading(const std::filesystem::path& path) override {
        return std::unique_ptr<RandomAccessFile>(std::make_unique<File>(path, bytes_));
    }
    Result<std::unique_ptr<WritableFile>> create(const std::filesystem::path& path) override { return noWriting(path); }
    Status renameDurably(const std::filesystem::path& from, const std::filesystem::path&) override {
        return noWriting(from);
    }
    Status removeFile(const std::filesystem::path& path) override { return noWriting(path); }

private:
    class File final : public RandomAccessFile {
    public:
        File(std::filesystem::path path, const std::string& bytes)
            : path_(std::move(path)), bytes_(bytes), size_(bytes.size()) {}
        const std::filesystem::path& path() const override { return path_; }
        std::uint64_t sizeBytes() const override { return size_; }
        Result<std::size_t> readAt(std::uint64_t offset, std::span<std::byte> out) const override {
            if (offset >= bytes_.size())
                return std::size_t{0};
            const std::size_t count = std::min(out.size(), bytes_.size() - static_cast<std::size_t>(offset));
            std::memcpy(out.data(), bytes_.data() + offset, count);
            return count;
        }

    private:
        std::filesystem::path path_;
        const std::string& bytes_;
        std::uint64_t size_;
    };
    static Error noWriting(const std::filesystem::path& path) {
        return makeError(ErrorCode::IoError, "cannot be written", path);
    }

    const std::string& bytes_;
};

} // namespace isoslider::test
