#include "core/base/memory_file_system.h"

#include <algorithm>
#include <cstring>

namespace isoslider {
namespace {

using Bytes = std::shared_ptr<std::vector<std::byte>>;

class MemoryFile final : public RandomAccessFile {
public:
    MemoryFile(std::filesystem::path path, Bytes bytes)
        : path_(std::move(path)), bytes_(std::move(bytes)), size_(bytes_->size()) {}
    const std::filesystem::path& path() const override { return path_; }
    std::uint64_t sizeBytes() const override { return size_; }
    Result<std::size_t> readAt(std::uint64_t offset, std::span<std::byte> out) const override {
        const std::size_t begin = std::min<std::uint64_t>(offset, size_);
        const std::size_t count = std::min(out.size(), size_ - begin);
        if (count > 0)
            std::memcpy(out.data(), bytes_->data() + begin, count);
        return count;
    }

private:
    std::filesystem::path path_;
    Bytes bytes_;
    std::size_t size_;
};

class MemoryWriter final : public WritableFile {
public:
    MemoryWriter(std::filesystem::path path, Bytes bytes) : path_(std::move(path)), bytes_(std::move(bytes)) {}
    const std::filesystem::path& path() const override { return path_; }
    std::uint64_t sizeBytes() const override { return bytes_->size(); }
    Status writeAll(std::span<const std::byte> bytes) override {
        bytes_->insert(bytes_->end(), bytes.begin(), bytes.end());
        return {};
    }
    Status writeAt(std::uint64_t offset, std::span<const std::byte> bytes) override {
        std::copy(bytes.begin(), bytes.end(), bytes_->begin() + static_cast<std::ptrdiff_t>(offset));
        return {};
    }
    Status sync() override { return {}; }
    Status close() override { return {}; }

private:
    std::filesystem::path path_;
    Bytes bytes_;
};

} // namespace

Result<std::unique_ptr<RandomAccessFile>> MemoryFileSystem::openForReading(const std::filesystem::path& path) {
    const std::lock_guard lock(mutex_);
    const auto found = files_.find(path);
    if (found == files_.end())
        return makeError(ErrorCode::NotFound, "no such file", path);
    return std::unique_ptr<RandomAccessFile>(std::make_unique<MemoryFile>(path, found->second));
}

Result<std::unique_ptr<WritableFile>> MemoryFileSystem::create(const std::filesystem::path& path) {
    const std::lock_guard lock(mutex_);
    Bytes& bytes = files_[path];
    bytes = std::make_shared<std::vector<std::byte>>();
    return std::unique_ptr<WritableFile>(std::make_unique<MemoryWriter>(path, bytes));
}

Status MemoryFileSystem::renameDurably(const std::filesystem::path& from, const std::filesystem::path& to) {
    const std::lock_guard lock(mutex_);
    const auto found = files_.find(from);
    if (found == files_.end())
        return makeError(ErrorCode::NotFound, "no such file", from);
    files_[to] = std::move(found->second);
    files_.erase(found);
    return {};
}

Status MemoryFileSystem::removeFile(const std::filesystem::path& path) {
    const std::lock_guard lock(mutex_);
    files_.erase(path);
    return {};
}

Result<std::filesystem::path> MemoryFileSystem::outputTarget(const std::filesystem::path& path) { return path; }

} // namespace isoslider
