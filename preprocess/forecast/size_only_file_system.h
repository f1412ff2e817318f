#pragma once

#include <filesystem>
#include <memory>
#include <span>

#include "core/base/file_system.h"

namespace isoslider::preprocess {

/// Files of which only the size is kept, for what is written to see how large it becomes. Nothing can be read back.
class SizeOnlyFileSystem final : public FileSystem {
public:
    Result<std::unique_ptr<RandomAccessFile>> openForReading(const std::filesystem::path& path) override {
        return makeError(ErrorCode::NotFound, "nothing is kept of this file but its size", path);
    }
    Result<std::unique_ptr<WritableFile>> create(const std::filesystem::path& path) override {
        return std::unique_ptr<WritableFile>(std::make_unique<File>(path));
    }
    Status renameDurably(const std::filesystem::path&, const std::filesystem::path&) override { return {}; }
    Status removeFile(const std::filesystem::path&) override { return {}; }
    /// `path`: what the disk holds is of no interest.
    Result<std::filesystem::path> outputTarget(const std::filesystem::path& path) override { return path; }

private:
    class File final : public WritableFile {
    public:
        explicit File(std::filesystem::path path) : path_(std::move(path)) {}
        const std::filesystem::path& path() const override { return path_; }
        std::uint64_t sizeBytes() const override { return sizeBytes_; }
        Status writeAll(std::span<const std::byte> bytes) override {
            sizeBytes_ += bytes.size();
            return {};
        }
        Status writeAt(std::uint64_t, std::span<const std::byte>) override { return {}; }
        Status sync() override { return {}; }
        Status close() override { return {}; }

    private:
        std::filesystem::path path_;
        std::uint64_t sizeBytes_ = 0;
    };
};

} // namespace isoslider::preprocess
