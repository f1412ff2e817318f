#pragma once

#include <memory>
#include <mutex>
#include <vector>

#include "core/base/file_system.h"

struct z_stream_s;

namespace isoslider::io {

/// What the raw deflate stream from `begin` on unpacks to, as a file. Unpacks as far as is asked for and
/// keeps that. It seems to end at a limit, which is raised once it is known how much there should be.
/// sizeBytes() is how much there can be, by the size of the packed bytes.
class InflatedFile final : public RandomAccessFile {
public:
    static constexpr std::uint64_t kFirstLimit = std::uint64_t{16} << 20;
    static constexpr std::uint64_t kMaxBytes = std::uint64_t{2} << 30; ///< of any limit

    InflatedFile(std::shared_ptr<const RandomAccessFile> packed, std::uint64_t begin);
    ~InflatedFile() override;

    const std::filesystem::path& path() const override { return packed_->path(); }
    std::uint64_t sizeBytes() const override;
    /// Lets the first `bytes` be unpacked; never lowers the limit.
    void allow(std::uint64_t bytes) const;
    /// Errors: Corruption (no deflate stream), IoError.
    Result<std::size_t> readAt(std::uint64_t offset, std::span<std::byte> out) const override;

private:
    Status inflateTo(std::uint64_t end) const;

    std::shared_ptr<const RandomAccessFile> packed_;
    std::uint64_t begin_;
    mutable std::mutex mutex_;
    mutable std::unique_ptr<z_stream_s> stream_;
    mutable std::vector<std::byte> input_, unpacked_;
    mutable std::uint64_t taken_ = 0; ///< packed bytes
    mutable std::uint64_t limit_ = kFirstLimit;
    mutable bool isAtEnd_ = false;
};

} // namespace isoslider::io
