#include "core/volume_io/parsing/byte_stream.h"

#include <algorithm>
#include <string>

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

class DecodedStream final : public ByteStream {
public:
    DecodedStream(std::vector<FilePart> parts, std::uint64_t partBytes, Encoded how)
        : parts_(std::move(parts)), partBytes_(partBytes), how_(how) {}

    std::uint64_t sizeBytes() const override { return parts_.size() * partBytes_; }

    Status readAt(std::uint64_t offset, std::span<std::byte> out) override {
        while (!out.empty()) {
            const std::uint64_t within = offset % partBytes_;
            const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(out.size(), partBytes_ - within));
            ISO_TRY(moveTo(static_cast<std::size_t>(offset / partBytes_), how_.skipBytes + within));
            ISO_TRY(unpack(out.first(count)));
            if (position_ == how_.skipBytes + partBytes_)
                ISO_TRY(checkEnd());
            out = out.subspan(count);
            offset += count;
        }
        return {};
    }

    /// Decodes the first bytes once and keeps nothing of them, if they are many.
    Status probe() {
        constexpr std::uint64_t kManyBytes = std::uint64_t{32} << 20;
        if (how_.probeBytes <= kManyBytes)
            return {};
        std::uint64_t left = std::min(how_.probeBytes, sizeBytes());
        for (std::size_t part = 0; left > 0; ++part) {
            ISO_TRY(moveTo(part, how_.skipBytes + std::min(left, partBytes_)));
            left -= std::min(left, partBytes_);
        }
        return {};
    }

    Status open(std::size_t part) {
        auto file = defaultFileSystem().openForReading(parts_[part].path);
        if (!file.isOk())
            return std::move(file).error();
        const std::uint64_t fileSize = file.value()->sizeBytes(), offset = parts_[part].offset;
        const std::uint64_t encoded = fileSize > offset ? fileSize - offset : 0;
        if (leastEncodedBytes(how_.encoding, how_.skipBytes + partBytes_, how_.textType) > encoded)
            return makeError(ErrorCode::Corruption,
                             "the header asks for " + std::to_string(partBytes_) + " bytes of samples, which " +
                                 std::to_string(encoded) + " bytes " + contentName() + " cannot hold",
                             parts_[part].path, offset);
        decoder_ = makeDecoder(std::move(file).value(), offset, how_.encoding, how_.textType);
        openPart_ = part;
        position_ = 0;
        return {};
    }

private:
    Status moveTo(std::size_t part, std::uint64_t wanted) {
        if (!decoder_ || part != openPart_ || wanted < position_)
            ISO_TRY(open(part));
        std::vector<std::byte> ignored(std::min<std::uint64_t>(wanted - position_, std::uint64_t{1} << 18));
        while (position_ < wanted)
            ISO_TRY(unpack(std::span(ignored).first(std::min<std::uint64_t>(ignored.size(), wanted - position_))));
        return {};
    }

    Status unpack(std::span<std::byte> out) {
        auto got = decoder_->read(out);
        if (!got.isOk())
            return std::move(got).error();
        position_ += got.value();
        if (got.value() < out.size())
            return makeError(ErrorCode::Corruption,
                             makesText() + std::to_string(position_) + " bytes, " +
                                 std::to_string(how_.skipBytes + partBytes_) + " expected",
                             parts_[openPart_].path);
        return {};
    }

    // One byte more is asked for: it makes a decoder verify its checksum, and must not exist.
    Status checkEnd() {
        std::byte extra{};
        auto got = how_.allowsTrailing ? Result<std::size_t>(0) : decoder_->read({&extra, 1});
        decoder_.reset();
        if (!got.isOk())
            return std::move(got).error();
        if (got.value() != 0)
            return makeError(ErrorCode::Corruption,
                             makesText() + "more than the " + std::to_string(how_.skipBytes + partBytes_) +
                                 " bytes expected (trailing bytes have to be allowed)",
                             parts_[openPart_].path);
        return {};
    }

    bool isText() const { return how_.encoding == Encoding::Text || how_.encoding == Encoding::Hex; }
    std::string contentName() const { return isText() ? "of text" : "of compressed data"; }
    std::string makesText() const { return isText() ? "text comes to " : "compressed data unpacks to "; }

    std::vector<FilePart> parts_;
    std::uint64_t partBytes_;
    Encoded how_;
    std::unique_ptr<ByteDecoder> decoder_;
    std::size_t openPart_ = 0;
    std::uint64_t position_ = 0; ///< in the decoded bytes of the open part, those skipped included
};

class RunsStream final : public ByteStream {
public:
    RunsStream(std::unique_ptr<ByteStream> bytes, Runs runs) : bytes_(std::move(bytes)), runs_(runs) {}

    std::uint64_t sizeBytes() const override { return bytes_->sizeBytes() / runs_.strideBytes * runs_.runBytes; }

    Status readAt(std::uint64_t offset, std::span<std::byte> out) override {
        while (!out.empty()) {
            const std::uint64_t within = offset % runs_.runBytes;
            const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(out.size(), runs_.runBytes - within));
            ISO_TRY(bytes_->readAt(runs_.firstByte + offset / runs_.runBytes * runs_.strideBytes + within,
                                   out.first(count)));
            out = out.subspan(count);
            offset += count;
        }
        return {};
    }

private:
    std::unique_ptr<ByteStream> bytes_;
    Runs runs_;
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

Result<std::unique_ptr<ByteStream>> openEncoded(std::vector<FilePart> parts, std::uint64_t partBytes, Encoded how) {
    ISO_CHECK(!parts.empty() && partBytes > 0);
    if (how.encoding == Encoding::Plain) {
        for (FilePart& part : parts)
            part.offset += how.skipBytes;
        return openParts(std::move(parts), partBytes);
    }
    const std::size_t count = parts.size();
    auto stream = std::make_unique<DecodedStream>(std::move(parts), partBytes, how);
    for (std::size_t i = count; i-- > 0;)
        ISO_TRY(stream->open(i));
    ISO_TRY(stream->probe());
    return std::unique_ptr<ByteStream>(std::move(stream));
}

Result<std::unique_ptr<ByteStream>> openDeflated(const fs::path& path, std::uint64_t offset, std::uint64_t skipBytes,
                                                 std::uint64_t sizeBytes) {
    return openEncoded({{path, offset}}, sizeBytes, {Encoding::Deflate, FileType::U8, skipBytes, false});
}

std::unique_ptr<ByteStream> takeRuns(std::unique_ptr<ByteStream> bytes, const Runs& runs) {
    ISO_CHECK(runs.runBytes > 0 && runs.firstByte + runs.runBytes <= runs.strideBytes &&
              bytes->sizeBytes() % runs.strideBytes == 0);
    return std::make_unique<RunsStream>(std::move(bytes), runs);
}

Result<std::vector<std::byte>> inflateStart(const fs::path& path, std::size_t maxBytes) {
    auto file = defaultFileSystem().openForReading(path);
    if (!file.isOk())
        return std::move(file).error();
    std::vector<std::byte> bytes(maxBytes);
    auto got = makeDecoder(std::move(file).value(), 0, Encoding::Deflate)->read(bytes);
    if (!got.isOk())
        return std::move(got).error();
    bytes.resize(got.value());
    return bytes;
}

} // namespace isoslider::io
