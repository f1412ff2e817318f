#pragma once

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "core/base/file_system.h"

namespace isoslider::test {

/// Passes all calls on and keeps what was asked of the disk, in order.
class RecordingFileSystem final : public FileSystem {
public:
    enum class Kind { Create, Write, Sync, Rename, Remove };
    struct Call {
        Kind kind;
        std::filesystem::path path, to; ///< `to` of a rename
        std::uint64_t offset = 0;
        std::vector<std::byte> bytes;
    };

    explicit RecordingFileSystem(FileSystem& inner) : inner_(inner) {}
    const std::vector<Call>& calls() const { return calls_; }

    Result<std::unique_ptr<RandomAccessFile>> openForReading(const std::filesystem::path& path) override {
        return inner_.openForReading(path);
    }
    Result<std::unique_ptr<WritableFile>> create(const std::filesystem::path& path) override {
        auto file = inner_.create(path);
        if (!file.isOk())
            return std::move(file).error();
        keep({Kind::Create, path, {}, 0, {}});
        return std::unique_ptr<WritableFile>(std::make_unique<File>(*this, std::move(file).value()));
    }
    Status renameDurably(const std::filesystem::path& from, const std::filesystem::path& to) override {
        keep({Kind::Rename, from, to, 0, {}});
        return inner_.renameDurably(from, to);
    }
    Status removeFile(const std::filesystem::path& path) override {
        keep({Kind::Remove, path, {}, 0, {}});
        return inner_.removeFile(path);
    }

private:
    class File final : public WritableFile {
    public:
        File(RecordingFileSystem& owner, std::unique_ptr<WritableFile> file) : owner_(owner), file_(std::move(file)) {}
        const std::filesystem::path& path() const override { return file_->path(); }
        std::uint64_t sizeBytes() const override { return file_->sizeBytes(); }
        Status writeAll(std::span<const std::byte> bytes) override {
            owner_.keep({Kind::Write, path(), {}, sizeBytes(), {bytes.begin(), bytes.end()}});
            return file_->writeAll(bytes);
        }
        Status writeAt(std::uint64_t offset, std::span<const std::byte> bytes) override {
            owner_.keep({Kind::Write, path(), {}, offset, {bytes.begin(), bytes.end()}});
            return file_->writeAt(offset, bytes);
        }
        Status sync() override {
            owner_.keep({Kind::Sync, path(), {}, 0, {}});
            return file_->sync();
        }
        Status close() override { return file_->close(); }

    private:
        RecordingFileSystem& owner_;
        std::unique_ptr<WritableFile> file_;
    };

    void keep(Call call) {
        const std::lock_guard lock(mutex_);
        calls_.push_back(std::move(call));
    }

    FileSystem& inner_;
    std::mutex mutex_;
    std::vector<Call> calls_;
};

/// A disk that loses its power: what was synced is there, of other writes each one may be there or not.
class LostPower {
public:
    using Bytes = std::vector<std::byte>;

    /// The state after the first `count` calls. `survives` is asked of each write that was not synced.
    template <class Survives>
    static std::map<std::filesystem::path, Bytes> after(const std::vector<RecordingFileSystem::Call>& calls,
                                                        std::size_t count, const Survives& survives) {
        using Kind = RecordingFileSystem::Kind;
        std::map<std::filesystem::path, Bytes> files;
        for (std::size_t i = 0; i < count; ++i) {
            const auto& call = calls[i];
            if (call.kind == Kind::Create)
                files[call.path].clear();
            else if (call.kind == Kind::Remove)
                files.erase(call.path);
            else if (call.kind == Kind::Rename && files.count(call.path) > 0)
                files[call.to] = std::exchange(files[call.path], {}), files.erase(call.path);
            else if (call.kind == Kind::Write && (isSynced(calls, i, count) || survives()))
                write(files[call.path], call);
        }
        return files;
    }

private:
    static bool isSynced(const std::vector<RecordingFileSystem::Call>& calls, std::size_t write, std::size_t count) {
        for (std::size_t i = write + 1; i < count; ++i)
            if (calls[i].kind == RecordingFileSystem::Kind::Sync && calls[i].path == calls[write].path)
                return true;
        return false;
    }
    static void write(Bytes& file, const RecordingFileSystem::Call& call) {
        file.resize(std::max<std::size_t>(file.size(), call.offset + call.bytes.size()));
        std::copy(call.bytes.begin(), call.bytes.end(), file.begin() + static_cast<std::ptrdiff_t>(call.offset));
    }
};

} // namespace isoslider::test
