#include "core/volume_io/formats/inflated_file.h"

#include <algorithm>
#include <cstring>

#include <zlib.h>

namespace isoslider::io {
namespace {

constexpr std::size_t kChunk = std::size_t{1} << 16;
constexpr std::uint64_t kMostPerByte = 1032; // no deflate stream unpacks to more

} // namespace

InflatedFile::InflatedFile(std::shared_ptr<const RandomAccessFile> packed, std::uint64_t begin)
    : packed_(std::move(packed)), begin_(begin) {}

InflatedFile::~InflatedFile() {
    if (stream_)
        ::inflateEnd(stream_.get());
}

std::uint64_t InflatedFile::sizeBytes() const {
    return std::min(kMaxBytes, (packed_->sizeBytes() - std::min(begin_, packed_->sizeBytes())) * kMostPerByte);
}

void InflatedFile::allow(std::uint64_t bytes) const {
    const std::scoped_lock lock(mutex_);
    limit_ = std::max(limit_, std::min(bytes, kMaxBytes));
}

Result<std::size_t> InflatedFile::readAt(std::uint64_t offset, std::span<std::byte> out) const {
    const std::scoped_lock lock(mutex_);
    if (offset >= limit_)
        return std::size_t{0};
    ISO_TRY(inflateTo(std::min<std::uint64_t>(limit_, offset + out.size())));
    if (offset >= unpacked_.size())
        return std::size_t{0};
    const std::size_t count = std::min(out.size(), unpacked_.size() - static_cast<std::size_t>(offset));
    std::memcpy(out.data(), unpacked_.data() + offset, count);
    return count;
}

Status InflatedFile::inflateTo(std::uint64_t end) const {
    const auto fail = [&](const char* what) {
        return makeError(ErrorCode::Corruption, std::string("deflated data set: ") + what, packed_->path(),
                         begin_ + taken_);
    };
    if (!stream_) {
        stream_ = std::make_unique<z_stream>();
        if (::inflateInit2(stream_.get(), -MAX_WBITS) != Z_OK) {
            stream_.reset();
            return fail("cannot be unpacked");
        }
    }
    while (!isAtEnd_ && unpacked_.size() < end) {
        if (stream_->avail_in == 0) {
            input_.resize(kChunk);
            const auto count = packed_->readAt(begin_ + taken_, input_);
            if (!count.isOk())
                return count.error();
            if (count.value() == 0)
                return fail("ends early");
            taken_ += count.value();
            stream_->next_in = reinterpret_cast<Bytef*>(input_.data());
            stream_->avail_in = static_cast<uInt>(count.value());
        }
        const std::size_t before = unpacked_.size();
        unpacked_.resize(before + kChunk);
        stream_->next_out = reinterpret_cast<Bytef*>(unpacked_.data() + before);
        stream_->avail_out = static_cast<uInt>(kChunk);
        const int outcome = ::inflate(stream_.get(), Z_NO_FLUSH);
        unpacked_.resize(before + kChunk - stream_->avail_out);
        isAtEnd_ = outcome == Z_STREAM_END;
        if (outcome != Z_OK && outcome != Z_STREAM_END && outcome != Z_BUF_ERROR)
            return fail("is damaged");
    }
    return {};
}

} // namespace isoslider::io
