#include "core/volume_io/parsing/byte_decoder.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include <bzlib.h>
#include <zlib.h>

#include "core/volume_io/parsing/header_checks.h"
#include "core/volume_io/parsing/text_scanner.h"

namespace isoslider::io {
namespace {

constexpr std::size_t kBufferBytes = std::size_t{1} << 18;

// The bytes of a file in order, a buffer at a time.
class Input {
public:
    Input(std::unique_ptr<RandomAccessFile> file, std::uint64_t offset)
        : file_(std::move(file)), position_(offset), buffer_(kBufferBytes) {}

    const std::filesystem::path& path() const { return file_->path(); }
    const RandomAccessFile& file() const { return *file_; }
    std::uint64_t position() const { return position_; } ///< behind the last bytes given out

    /// Empty at the end of the file.
    Result<std::span<std::byte>> next() {
        const auto got = file_->readAt(position_, buffer_);
        if (!got.isOk())
            return got.error();
        position_ += got.value();
        return std::span(buffer_).first(got.value());
    }

    Result<bool> hasAt(std::uint64_t offset, std::string_view mark) const {
        std::array<std::byte, 4> bytes{};
        const auto got = file_->readAt(offset, std::span(bytes).first(mark.size()));
        if (!got.isOk())
            return got.error();
        return got.value() == mark.size() && std::memcmp(bytes.data(), mark.data(), mark.size()) == 0;
    }

    Error endsEarly() const {
        return makeError(ErrorCode::Corruption, "compressed data ends early", path(), position_);
    }
    Error damaged(std::string_view why, std::uint64_t unread) const {
        return makeError(ErrorCode::Corruption, "compressed data is damaged: " + std::string(why), path(),
                         position_ - unread);
    }

private:
    std::unique_ptr<RandomAccessFile> file_;
    std::uint64_t position_;
    std::vector<std::byte> buffer_;
};

class PlainDecoder final : public ByteDecoder {
public:
    PlainDecoder(std::unique_ptr<RandomAccessFile> file, std::uint64_t offset)
        : file_(std::move(file)), position_(offset) {}

    Result<std::size_t> read(std::span<std::byte> out) override {
        auto got = file_->readAt(position_, out);
        if (got.isOk())
            position_ += got.value();
        return got;
    }

private:
    std::unique_ptr<RandomAccessFile> file_;
    std::uint64_t position_;
};

class Inflater final : public ByteDecoder {
public:
    explicit Inflater(Input input) : input_(std::move(input)) {
        // 32: gzip and zlib headers distinguished by zlib itself.
        isReady_ = ::inflateInit2(&stream_, 15 + 32) == Z_OK;
    }
    ~Inflater() override {
        if (isReady_)
            ::inflateEnd(&stream_);
    }
    Inflater(const Inflater&) = delete;
    Inflater& operator=(const Inflater&) = delete;

    Result<std::size_t> read(std::span<std::byte> out) override {
        if (!isReady_)
            return makeError(ErrorCode::OutOfSpace, "no memory to unpack", input_.path());
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
                return input_.damaged(stream_.msg != nullptr ? stream_.msg : "unknown reason", stream_.avail_in);
        }
        return done;
    }

private:
    Status refill() {
        if (stream_.avail_in > 0)
            return {};
        const auto bytes = input_.next();
        if (!bytes.isOk())
            return bytes.error();
        if (bytes.value().empty())
            return input_.endsEarly();
        stream_.next_in = reinterpret_cast<Bytef*>(bytes.value().data());
        stream_.avail_in = static_cast<uInt>(bytes.value().size());
        return {};
    }

    // Two gzip files written one after the other unpack to both; anything else behind is left alone.
    Status nextMember() {
        const auto isMember = input_.hasAt(input_.position() - stream_.avail_in, "\x1f\x8b");
        if (!isMember.isOk())
            return isMember.error();
        isAtEnd_ = !isMember.value();
        if (!isAtEnd_)
            ::inflateReset(&stream_);
        return {};
    }

    Input input_;
    z_stream stream_{};
    bool isReady_ = false;
    bool isAtEnd_ = false;
};

class Bunzipper final : public ByteDecoder {
public:
    explicit Bunzipper(Input input) : input_(std::move(input)) { begin(); }
    ~Bunzipper() override { end(); }
    Bunzipper(const Bunzipper&) = delete;
    Bunzipper& operator=(const Bunzipper&) = delete;

    Result<std::size_t> read(std::span<std::byte> out) override {
        std::size_t done = 0;
        while (done < out.size() && !isAtEnd_) {
            if (!isReady_)
                return makeError(ErrorCode::OutOfSpace, "no memory to unpack", input_.path());
            ISO_TRY(refill());
            const std::size_t wanted = std::min<std::size_t>(out.size() - done, std::size_t{1} << 30);
            stream_.next_out = reinterpret_cast<char*>(out.data() + done);
            stream_.avail_out = static_cast<unsigned>(wanted);
            const int outcome = ::BZ2_bzDecompress(&stream_);
            done += wanted - stream_.avail_out;
            if (outcome == BZ_STREAM_END)
                ISO_TRY(nextMember());
            else if (outcome != BZ_OK)
                return input_.damaged(outcome == BZ_DATA_ERROR_MAGIC ? "is not bzip2" : "a checksum or code is wrong",
                                      stream_.avail_in);
        }
        return done;
    }

private:
    void begin() { isReady_ = ::BZ2_bzDecompressInit(&stream_, 0, 0) == BZ_OK; }
    void end() {
        if (isReady_)
            ::BZ2_bzDecompressEnd(&stream_);
        isReady_ = false;
    }

    Status refill() {
        if (stream_.avail_in > 0)
            return {};
        const auto bytes = input_.next();
        if (!bytes.isOk())
            return bytes.error();
        if (bytes.value().empty())
            return input_.endsEarly();
        stream_.next_in = reinterpret_cast<char*>(bytes.value().data());
        stream_.avail_in = static_cast<unsigned>(bytes.value().size());
        return {};
    }

    Status nextMember() {
        const auto isMember = input_.hasAt(input_.position() - stream_.avail_in, "BZh");
        if (!isMember.isOk())
            return isMember.error();
        isAtEnd_ = !isMember.value();
        if (isAtEnd_)
            return {};
        const auto unread = std::pair(stream_.next_in, stream_.avail_in);
        end();
        stream_ = {};
        begin();
        std::tie(stream_.next_in, stream_.avail_in) = unread;
        return {};
    }

    Input input_;
    bz_stream stream_{};
    bool isReady_ = false;
    bool isAtEnd_ = false;
};

class HexDecoder final : public ByteDecoder {
public:
    explicit HexDecoder(Input input) : input_(std::move(input)) {}

    Result<std::size_t> read(std::span<std::byte> out) override {
        for (std::size_t done = 0; done < out.size();) {
            if (rest_.empty()) {
                const auto bytes = input_.next();
                if (!bytes.isOk())
                    return bytes.error();
                if (bytes.value().empty() && high_)
                    return makeError(ErrorCode::Corruption, "hexadecimal data ends within a byte", input_.path());
                if (bytes.value().empty())
                    return done;
                rest_ = bytes.value();
            }
            const char c = static_cast<char>(rest_.front());
            rest_ = rest_.subspan(1);
            if (c == ' ' || c == '\t' || c == '\r' || c == '\n')
                continue;
            const int digit = c >= '0' && c <= '9'   ? c - '0'
                              : c >= 'a' && c <= 'f' ? c - 'a' + 10
                              : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                                     : -1;
            if (digit < 0)
                return makeError(ErrorCode::InvalidArgument, inQuotes({&c, 1}) + " is not a hexadecimal digit",
                                 input_.path(), input_.position() - rest_.size() - 1);
            if (high_)
                out[done++] = static_cast<std::byte>(*high_ * 16 + digit);
            high_ = high_ ? std::nullopt : std::optional<int>(digit);
        }
        return out.size();
    }

private:
    Input input_;
    std::span<const std::byte> rest_;
    std::optional<int> high_;
};

// False where the word is no number or none of this type.
template <class T>
bool parseSample(std::string_view word, T& out) {
    if constexpr (std::is_same_v<T, Half>) {
        return false;
    } else if constexpr (std::is_floating_point_v<T>) {
        if (parseNumber(word, out))
            return true;
        const auto value = parseFortranReal(word); // also what is too small for T
        out = value ? static_cast<T>(*value) : T{};
        return value && (std::isfinite(out) || !std::isfinite(*value));
    } else {
        return parseNumber(word, out);
    }
}

class TextDecoder final : public ByteDecoder {
public:
    TextDecoder(std::unique_ptr<RandomAccessFile> file, std::uint64_t offset, FileType type)
        : path_(file->path()), bytes_(std::move(file), offset), text_(bytes_), type_(type) {}

    Result<std::size_t> read(std::span<std::byte> out) override {
        for (std::size_t done = 0; done < out.size();) {
            if (pending_.empty()) {
                ISO_TRY(nextSample());
                if (pending_.empty())
                    return done;
            }
            const std::size_t count = std::min(pending_.size(), out.size() - done);
            std::memcpy(out.data() + done, pending_.data(), count);
            pending_ = pending_.subspan(count);
            done += count;
        }
        return out.size();
    }

private:
    Status nextSample() {
        do { // a comma may stand behind a number, or alone
            if (!text_.word(word_))
                return text_.status();
            if (word_.ends_with(','))
                word_.pop_back();
        } while (word_.empty());
        const bool isNumber = visitFileType(type_, [&](auto sample) {
            const bool parsed = word_.size() <= kMaxScannedWord && parseSample(word_, sample);
            std::memcpy(sample_.data(), &sample, sizeof sample);
            pending_ = std::span(sample_).first(sizeof sample);
            return parsed;
        });
        if (!isNumber)
            return makeError(ErrorCode::InvalidArgument,
                             "sample " + std::to_string(samples_) + ": " + inQuotes(word_) +
                                 " is not a number of type " + std::string(fileTypeName(type_)),
                             path_);
        ++samples_;
        return {};
    }

    std::filesystem::path path_;
    PlainDecoder bytes_;
    TextReader text_;
    FileType type_;
    std::string word_;
    std::array<std::byte, 8> sample_{};
    std::span<const std::byte> pending_;
    std::uint64_t samples_ = 0;
};

} // namespace

std::unique_ptr<ByteDecoder> makeDecoder(std::unique_ptr<RandomAccessFile> file, std::uint64_t offset,
                                         Encoding encoding, FileType textType) {
    switch (encoding) {
        case Encoding::Plain: return std::make_unique<PlainDecoder>(std::move(file), offset);
        case Encoding::Deflate: return std::make_unique<Inflater>(Input(std::move(file), offset));
        case Encoding::Bzip2: return std::make_unique<Bunzipper>(Input(std::move(file), offset));
        case Encoding::Hex: return std::make_unique<HexDecoder>(Input(std::move(file), offset));
        case Encoding::Text: return std::make_unique<TextDecoder>(std::move(file), offset, textType);
    }
    checkFailed("known Encoding", __FILE__, __LINE__);
}

std::uint64_t leastEncodedBytes(Encoding encoding, std::uint64_t sizeBytes, FileType textType) {
    constexpr std::uint64_t kMaxRatio = 1032; // of deflate, by its design
    switch (encoding) {
        case Encoding::Plain: return sizeBytes;
        case Encoding::Deflate: return sizeBytes / kMaxRatio;
        case Encoding::Bzip2: return 0; // no bound worth the name: runs of runs
        case Encoding::Hex: return 2 * sizeBytes;
        case Encoding::Text: return sizeBytes == 0 ? 0 : 2 * (sizeBytes / fileTypeSizeBytes(textType)) - 1;
    }
    checkFailed("known Encoding", __FILE__, __LINE__);
}

bool TextReader::fill() {
    window_.resize(std::size_t{1} << 16);
    at_ = 0;
    auto got = bytes_.read(std::as_writable_bytes(std::span(window_)));
    window_.resize(got.isOk() ? got.value() : 0);
    if (!got.isOk())
        status_ = std::move(got).error();
    return !window_.empty();
}

bool TextReader::line(std::string& out) {
    out.clear();
    while (at_ < window_.size() || fill()) {
        const char c = window_[at_++];
        if (c == '\n')
            return true;
        if (out.size() < kMaxHeaderLine)
            out += c;
    }
    return !out.empty() && status_.isOk();
}

bool TextReader::word(std::string& out) {
    out.clear();
    while (at_ < window_.size() || fill()) {
        const char c = window_[at_];
        const bool isBlank = c == ' ' || c == '\n' || c == '\t' || c == '\r';
        if (isBlank && !out.empty())
            return true;
        ++at_;
        if (!isBlank && out.size() <= kMaxScannedWord)
            out += c;
    }
    return !out.empty() && status_.isOk();
}

std::optional<double> parseFortranReal(std::string_view word) {
    std::string text(word.starts_with('+') ? word.substr(1) : word);
    std::replace_if(
        text.begin(), text.end(), [](char c) { return c == 'D' || c == 'd'; }, 'e');
    const auto isDigit = [](char c) { return c >= '0' && c <= '9'; };
    const auto sign = text.size() > 4 ? text.size() - 4 : 0; // of an exponent of three digits
    if (sign > 0 && (text[sign] == '+' || text[sign] == '-') && (isDigit(text[sign - 1]) || text[sign - 1] == '.') &&
        std::all_of(text.begin() + static_cast<std::ptrdiff_t>(sign) + 1, text.end(), isDigit))
        text.insert(sign, 1, 'e');
    double value = 0.0;
    const char* end = text.data() + text.size();
    const auto [stop, problem] = std::from_chars(text.data(), end, value);
    if (stop != end || problem == std::errc::invalid_argument)
        return std::nullopt;
    if (problem == std::errc{})
        return value;
    // Out of range: too small is zero, too large is no number.
    const auto exponent = text.find_first_of("eE");
    if (exponent == std::string::npos || text.find('-', exponent) == std::string::npos)
        return std::nullopt;
    return text.starts_with('-') ? -0.0 : 0.0;
}

} // namespace isoslider::io
