#include "preprocess/forecast/metered_file_system.h"

#include <algorithm>
#include <utility>

namespace isoslider::preprocess {

class MeteredFileSystem::File final : public WritableFile {
public:
    explicit File(MeteredFileSystem& owner) : owner_(owner) {}
    void take(std::unique_ptr<WritableFile> file) {
        file_ = std::move(file);
        owner_.set(path(), sizeBytes());
    }
    const std::filesystem::path& path() const override { return file_->path(); }
    std::uint64_t sizeBytes() const override { return file_->sizeBytes(); }
    Status writeAll(std::span<const std::byte> bytes) override {
        ISO_TRY(file_->writeAll(bytes));
        owner_.set(path(), sizeBytes());
        return {};
    }
    Status writeAt(std::uint64_t offset, std::span<const std::byte> bytes) override {
        return file_->writeAt(offset, bytes);
    }
    Status cut(std::uint64_t bytes) override {
        ISO_TRY(file_->cut(bytes));
        owner_.set(path(), bytes);
        return {};
    }
    Status sync() override { return file_->sync(); }
    Status close() override { return file_->close(); }

private:
    MeteredFileSystem& owner_;
    std::unique_ptr<WritableFile> file_;
};

MeteredFileSystem::MeteredFileSystem(FileSystem& fileSystem, const std::filesystem::path& leftOut)
    : fileSystem_(fileSystem) {
    const auto target = linkTarget(leftOut);
    leftOut_ = target.isOk() ? target.value() : leftOut;
    leftOutPartial_ = partialPath(leftOut_);
}

void MeteredFileSystem::set(const std::filesystem::path& path, std::uint64_t bytes) {
    if (path == leftOut_ || path == leftOutPartial_)
        return;
    const std::lock_guard lock(mutex_);
    std::uint64_t& size = sizes_[path];
    bytes_ += bytes - size;
    size = bytes;
    mostBytes_ = std::max(mostBytes_, bytes_);
}

void MeteredFileSystem::forget(const std::filesystem::path& path) {
    const std::lock_guard lock(mutex_);
    const auto found = sizes_.find(path);
    if (found == sizes_.end())
        return;
    bytes_ -= found->second;
    sizes_.erase(found);
}

// All that needs memory comes before the file: without any there would be one that nobody removes.
template <class Open>
Result<std::unique_ptr<WritableFile>> MeteredFileSystem::meter(const std::filesystem::path& path, const Open& open) {
    auto metered = std::make_unique<File>(*this);
    set(path, 0);
    auto file = open();
    if (!file.isOk())
        return file;
    metered->take(std::move(file).value());
    return std::unique_ptr<WritableFile>(std::move(metered));
}

Result<std::unique_ptr<WritableFile>> MeteredFileSystem::create(const std::filesystem::path& path) {
    return meter(path, [&] { return fileSystem_.create(path); });
}

Result<std::unique_ptr<WritableFile>> MeteredFileSystem::extend(const std::filesystem::path& path,
                                                                std::span<const std::byte> head,
                                                                std::uint64_t keepBytes) {
    return meter(path, [&] { return fileSystem_.extend(path, head, keepBytes); });
}

// A file that is replaced is gone only then: both were there.
Status MeteredFileSystem::renameDurably(const std::filesystem::path& from, const std::filesystem::path& to) {
    ISO_TRY(fileSystem_.renameDurably(from, to));
    std::uint64_t bytes = 0;
    {
        const std::lock_guard lock(mutex_);
        const auto found = sizes_.find(from);
        bytes = found == sizes_.end() ? 0 : found->second;
    }
    forget(from);
    forget(to);
    if (bytes > 0)
        set(to, bytes);
    return {};
}

Status MeteredFileSystem::removeFile(const std::filesystem::path& path) {
    ISO_TRY(fileSystem_.removeFile(path));
    forget(path);
    return {};
}

} // namespace isoslider::preprocess
