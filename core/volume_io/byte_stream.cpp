#include "core/volume_io/byte_stream.h"

#include <algorithm>
#include <limits>
#include <string>

#include <zlib.h>

namespace isoslider::io {
namespace fs = std::filesystem;
namespace {

class PartsStream final : public ByteStream {
public:
    PartsStream(std::vector<FilePart> parts, std::uint64_t partBytes)
        : parts_(std::move(parts)), partBytes_(partBytes) {}

    std::uint64_t sizeBytes() const override { return parts_.size() * partBytes_; }

    Status readAt(std::uint64_t offset, std::span<std::byte> out) override {
        while (!out.empty()) {
            const auto part = static_cast<std::size_t>(offset / partBytes_);
            const std::uint64_t within = offset % partBytes_;
            const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(out.size(), partBytes_ - within));
            ISO_TRY(open(part));
            ISO_TRY(file_->readExactlyAt(parts_[part].offset + within, out.first(count)));
            out = out.subspan(count);
            offset += count;
        }
        return {};
    }

    Status open(std::size_t part) {
        if (file_ && part == openPart_)
            return {};
        auto file = defaultFileSystem().openForReading(parts_[part].path);
        if (!file.isOk())
            return std::move(file).error();
        file_ = std::move(file).value();
        openPart_ = part;
        const std::uint64_t size = file_->sizeBytes();
        if (size < parts_[part].offset || size - parts_[part].offset < partBytes_)
            return makeError(ErrorCode::Corruption,
                             "data ends early: the header asks for " + std::to_string(partBytes_) +
                                 " bytes from byte " + std::to_string(parts_[part].offset) + ", the file has " +
                                 std::to_string(size) + " bytes",
                             parts_[part].path);
        return {};
    }

private:
    std::vector<FilePart> parts_;
    std::uint64_t partBytes_;
    std::unique_ptr<RandomAccessFile> file_;
    std::size_t openPart_ = 0;
};

/// Unpacks from one end of a file towards the other.
class Inflater {
public:
    Inflater(const RandomAccessFile& file, std::uint64_t offset)
        : file_(file), position_(offset), input_(std::size_t{1} << 18) {
        // 32: gzip and zlib headers told apart by zlib itself.
        isReady_ = ::inflateInit2(&stream_, 15 + 32) == Z_OK;
    }
    ~Inflater() {
        if (isReady_)
            ::inflateEnd(&stream_);
    }
    Inflater(const Inflater&) = delete;
    Inflater& operator=(const Inflater&) = delete;

    /// Number of bytes unpacked into `out`: fewer than asked for only at the end.
    Result<std::size_t> read(std::span<std::byte> out) {
        if (!isReady_)
            return makeError(ErrorCode::OutOfSpace, "no memory to unpack", file_.path());
        std::size_t done = 0;
        while (done < out.size() && !isAtEnd_) {
            ISO_TRY(refill());
            const std::size_t wanted = std::min<std::size_t>(out.size() - done, std::size_t{1} << 30);
            stream_.next_out = reinterpret_cast<Bytef*>(out.data() + done);
            stream_.avail_out = static_cast<uInt>(wanted);
            const int outcome = ::inflate(&stream_, Z_NO_FLUSH);
            done += wanted - stream_.avail_out;
            if (outcome == Z_STREAM_END)
                ISO_TRY(nextMember());
            else if (outcome != Z_OK && outcome != Z_BUF_ERROR)
                return makeError(ErrorCode::Corruption,
                                 std::string("compressed data is damaged: ") +
                                     (stream_.msg != nullptr ? stream_.msg : "unknown reason"),
                                 file_.path(), position_ - stream_.avail_in);
        }
        return done;
    }

private:
    Status refill() {
        if (stream_.avail_in > 0)
            return {};
        auto got = file_.readAt(position_, input_);
        if (!got.isOk())
            return std::move(got).error();
        if (got.value() == 0)
            return makeError(ErrorCode::Corruption, "compressed data ends early", file_.path(), position_);
        position_ += got.value();
        stream_.next_in = reinterpret_cast<Bytef*>(input_.data());
        stream_.avail_in = static_cast<uInt>(got.value());
        return {};
    }

    // Two gzip files written one after the other unpack to both; anything else behind is left alone.
    Status nextMember() {
        const std::uint64_t begin = position_ - stream_.avail_in;
        std::byte mark[2]{};
        auto got = file_.readAt(begin, mark);
        if (!got.isOk())
            return std::move(got).error();
        isAtEnd_ = got.value() < 2 || mark[0] != std::byte{0x1f} || mark[1] != std::byte{0x8b};
        if (!isAtEnd_)
            ::inflateReset(&stream_);
        return {};
    }

    const RandomAccessFile& file_;
    std::uint64_t position_;
    std::vector<std::byte> input_;
    z_stream stream_{};
    bool isReady_ = false;
    bool isAtEnd_ = false;
};

class DeflatedStream final : public ByteStream {
public:
    DeflatedStream(std::unique_ptr<RandomAccessFile> file, std::uint64_t offset, std::uint64_t skipBytes,
                   std::uint64_t size)
        : file_(std::move(file)), fileOffset_(offset), skipBytes_(skipBytes), size_(size) {}

    std::uint64_t sizeBytes() const override { return size_; }

    Status readAt(std::uint64_t offset, std::span<std::byte> out) override {
        const std::uint64_t wanted = skipBytes_ + offset;
        if (!inflater_ || wanted < position_) {
            inflater_ = std::make_unique<Inflater>(*file_, fileOffset_);
            position_ = 0;
        }
        std::vector<std::byte> ignored(std::min<std::uint64_t>(wanted - position_, std::uint64_t{1} << 18));
        while (position_ < wanted)
            ISO_TRY(unpack(std::span(ignored).first(std::min<std::uint64_t>(ignored.size(), wanted - position_))));
        ISO_TRY(unpack(out));
        return position_ == skipBytes_ + size_ ? checkEnd() : Status();
    }

private:
    Status unpack(std::span<std::byte> out) {
        auto got = inflater_->read(out);
        if (!got.isOk())
            return std::move(got).error();
        position_ += got.value();
        if (got.value() < out.size())
            return makeError(ErrorCode::Corruption,
                             "compressed data unpacks to " + std::to_string(position_) + " bytes, " +
                                 std::to_string(skipBytes_ + size_) + " expected",
                             file_->path());
        return {};
    }

    // One byte more is asked for: it makes zlib verify the checksum, and must not exist.
    Status checkEnd() {
        std::byte extra{};
        auto got = inflater_->read({&extra, 1});
        if (!got.isOk())
            return std::move(got).error();
        inflater_.reset();
        if (got.value() != 0)
            return makeError(ErrorCode::Corruption,
                             "compressed data unpacks to more than the " + std::to_string(skipBytes_ + size_) +
                                 " bytes expected",
                             file_->path());
        return {};
    }

    std::unique_ptr<RandomAccessFile> file_;
    std::uint64_t fileOffset_;
    std::uint64_t skipBytes_;
    std::uint64_t size_;
    std::unique_ptr<Inflater> inflater_;
    std::uint64_t position_ = 0;
};

} // namespace

Result<std::unique_ptr<ByteStream>> openParts(std::vector<FilePart> parts, std::uint64_t partBytes) {
    ISO_CHECK(!parts.empty() && partBytes > 0);
    const std::size_t count = parts.size();
    auto stream = std::make_unique<PartsStream>(std::move(parts), partBytes);
    for (std::size_t i = count; i-- > 0;) // ends with the first one open
        ISO_TRY(stream->open(i));
    return std::unique_ptr<ByteStream>(std::move(stream));
}

Result<std::unique_ptr<ByteStream>> openDeflated(const fs::path& path, std::uint64_t offset, std::uint64_t skipBytes,
                                                 std::uint64_t sizeBytes) {
    auto file = defaultFileSystem().openForReading(path);
    if (!file.isOk())
        return std::move(file).error();
    const std::uint64_t fileSize = file.value()->sizeBytes();
    const std::uint64_t packed = fileSize > offset ? fileSize - offset : 0;
    constexpr std::uint64_t kMaxRatio = 1032; // of deflate, by its design
    if ((skipBytes + sizeBytes) / kMaxRatio > packed)
        return makeError(ErrorCode::Corruption,
                         "the header asks for " + std::to_string(sizeBytes) + " bytes, which " +
                             std::to_string(packed) + " compressed bytes cannot hold",
                         path, offset);
    return std::unique_ptr<ByteStream>(
        std::make_unique<DeflatedStream>(std::move(file).value(), offset, skipBytes, sizeBytes));
}

Result<std::vector<std::byte>> inflateStart(const fs::path& path, std::size_t maxBytes) {
    auto file = defaultFileSystem().openForReading(path);
    if (!file.isOk())
        return std::move(file).error();
    std::vector<std::byte> bytes(maxBytes);
    auto got = Inflater(*file.value(), 0).read(bytes);
    if (!got.isOk())
        return std::move(got).error();
    bytes.resize(got.value());
    return bytes;
}

} // namespace isoslider::io
