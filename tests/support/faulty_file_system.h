#pragma once

#include <atomic>
#include <memory>
#include <utility>

#include "core/base/file_system.h"

namespace isoslider::test {

/// The real file system, except that call number `failingCall` (from 0, counting every create,
/// write, sync, close, rename and removal) fails with `errorNumber`. -1: none fails.
class FaultyFileSystem final : public FileSystem {
public:
    enum class Fails { Writing, Reading };

    explicit FaultyFileSystem(int failingCall, int errorNumber, Fails fails = Fails::Writing)
        : failingCall_(failingCall), errorNumber_(errorNumber), fails_(fails) {}

    int calls() const { return *calls_; }

    Result<std::unique_ptr<RandomAccessFile>> openForReading(const std::filesystem::path& path) override {
        ISO_TRY(countReading(path));
        auto file = defaultFileSystem().openForReading(path);
        if (!file.isOk())
            return std::move(file).error();
        return std::unique_ptr<RandomAccessFile>(std::make_unique<Source>(*this, std::move(file).value()));
    }

    Result<std::unique_ptr<WritableFile>> create(const std::filesystem::path& path) override {
        ISO_TRY(countCall(path));
        auto file = defaultFileSystem().create(path);
        if (!file.isOk())
            return std::move(file).error();
        return std::unique_ptr<WritableFile>(std::make_unique<File>(*this, std::move(file).value()));
    }

    Result<std::unique_ptr<WritableFile>> extend(const std::filesystem::path& path, std::span<const std::byte> head,
                                                 std::uint64_t keepBytes) override {
        ISO_TRY(countCall(path));
        auto file = defaultFileSystem().extend(path, head, keepBytes);
        if (!file.isOk())
            return std::move(file).error();
        return std::unique_ptr<WritableFile>(std::make_unique<File>(*this, std::move(file).value()));
    }

    Status renameDurably(const std::filesystem::path& from, const std::filesystem::path& to) override {
        ISO_TRY(countCall(to));
        return defaultFileSystem().renameDurably(from, to);
    }

    // Never fails: a test must find what the code under test leaves behind, not what it could not remove.
    Status removeFile(const std::filesystem::path& path) override { return defaultFileSystem().removeFile(path); }

private:
    class File final : public WritableFile {
    public:
        File(FaultyFileSystem& owner, std::unique_ptr<WritableFile> file) : owner_(owner), file_(std::move(file)) {}
        const std::filesystem::path& path() const override { return file_->path(); }
        std::uint64_t sizeBytes() const override { return file_->sizeBytes(); }
        Status writeAll(std::span<const std::byte> bytes) override {
            // A full disk takes part of the bytes before it reports it.
            if (auto status = owner_.countCall(path()); !status.isOk()) {
                static_cast<void>(file_->writeAll(bytes.first(bytes.size() / 2)));
                return status;
            }
            return file_->writeAll(bytes);
        }
        Status writeAt(std::uint64_t offset, std::span<const std::byte> bytes) override {
            ISO_TRY(owner_.countCall(path()));
            return file_->writeAt(offset, bytes);
        }
        // Never fails, like a removal.
        Status cut(std::uint64_t bytes) override { return file_->cut(bytes); }
        Status sync() override {
            ISO_TRY(owner_.countCall(path()));
            return file_->sync();
        }
        Status close() override {
            ISO_TRY(owner_.countCall(path()));
            return file_->close();
        }

    private:
        FaultyFileSystem& owner_;
        std::unique_ptr<WritableFile> file_;
    };

    class Source final : public RandomAccessFile {
    public:
        Source(FaultyFileSystem& owner, std::unique_ptr<RandomAccessFile> file)
            : owner_(owner), file_(std::move(file)) {}
        const std::filesystem::path& path() const override { return file_->path(); }
        std::uint64_t sizeBytes() const override { return file_->sizeBytes(); }
        Result<std::size_t> readAt(std::uint64_t offset, std::span<std::byte> out) const override {
            ISO_TRY(owner_.countReading(path()));
            return file_->readAt(offset, out);
        }

    private:
        FaultyFileSystem& owner_;
        std::unique_ptr<RandomAccessFile> file_;
    };

    Status countCall(const std::filesystem::path& path) {
        if (fails_ == Fails::Writing && (*calls_)++ == failingCall_)
            return systemError(errorNumber_, "cannot write", path);
        return {};
    }
    Status countReading(const std::filesystem::path& path) {
        if (fails_ == Fails::Reading && (*calls_)++ == failingCall_)
            return systemError(errorNumber_, "cannot read", path);
        return {};
    }

    int failingCall_;
    int errorNumber_;
    Fails fails_;
    std::shared_ptr<std::atomic<int>> calls_ = std::make_shared<std::atomic<int>>(0);
};

} // namespace isoslider::test
