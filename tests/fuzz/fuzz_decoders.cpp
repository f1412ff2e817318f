#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/byte_codec.h"
#include "core/volume_io/formats/inflated_file.h"
#include "core/volume_io/parsing/byte_decoder.h"
#include "core/volume_io/parsing/header_checks.h"
#include "tests/fuzz/fuzz_support.h"
#include "tests/fuzz/fuzz_targets.h"

namespace isoslider::fuzz {
namespace {

constexpr std::size_t kMaxDecoded = std::size_t{1} << 20;

struct Decoded {
    std::vector<std::byte> bytes;
    bool isCut = false; ///< there would be more
    Status status;
};

Decoded decode(std::span<const std::byte> bytes, io::Encoding encoding, io::FileType type, std::size_t step) {
    const auto decoder = io::makeDecoder(std::make_unique<BytesFile>(bytes), 0, encoding, type);
    Decoded out;
    std::vector<std::byte> part(step);
    while (out.bytes.size() < kMaxDecoded) {
        const auto count = decoder->read(part);
        if (!count.isOk()) {
            requireGoodError(count.error());
            out.status = count.error();
            return out;
        }
        ISO_REQUIRE(count.value() <= step, "");
        out.bytes.insert(out.bytes.end(), part.begin(), part.begin() + static_cast<std::ptrdiff_t>(count.value()));
        if (count.value() < step)
            return out;
    }
    out.isCut = true;
    return out;
}

// However it is cut into pieces, the same comes out.
void decodeTwice(std::span<const std::byte> bytes, io::Encoding encoding, io::FileType type) {
    const std::size_t sample = fileTypeSizeBytes(type);
    const Decoded large = decode(bytes, encoding, type, 4096 * sample),
                  small = decode(bytes, encoding, type, 24 * sample);
    ISO_REQUIRE(large.isCut || small.isCut || large.status.isOk() == small.status.isOk(), "");
    const std::size_t both = std::min(large.bytes.size(), small.bytes.size());
    ISO_REQUIRE(
        std::equal(large.bytes.begin(), large.bytes.begin() + static_cast<std::ptrdiff_t>(both), small.bytes.begin()),
        "");
    if (large.status.isOk() && !large.isCut)
        ISO_REQUIRE(large.bytes.size() == small.bytes.size() &&
                        io::leastEncodedBytes(encoding, large.bytes.size(), type) <= bytes.size(),
                    std::to_string(large.bytes.size()));
}

void readText(std::span<const std::byte> bytes) {
    for (const bool byLines : {false, true}) {
        const auto decoder = io::makeDecoder(std::make_unique<BytesFile>(bytes), 0, io::Encoding::Plain);
        io::TextReader reader(*decoder);
        std::string text;
        while (byLines ? reader.line(text) : reader.word(text)) {
            const auto real = io::parseFortranReal(text);
            ISO_REQUIRE(!real || !text.empty(), text);
            (void)io::parseReal(text);
            (void)io::parseInteger(text);
        }
        ISO_REQUIRE(reader.status().isOk(), "plain text in memory has no errors");
    }
}

void inflate(std::span<const std::byte> bytes) {
    const io::InflatedFile file(std::make_shared<BytesFile>(bytes), 0);
    std::vector<std::byte> out(1000);
    for (const std::uint64_t offset : {std::uint64_t{0}, std::uint64_t{100'000}, std::uint64_t{7}, kMaxDecoded - 500}) {
        const auto count = file.readAt(offset, out);
        if (!count.isOk())
            return requireGoodError(count.error());
        ISO_REQUIRE(count.value() <= out.size(), "");
    }
}

} // namespace

/// A byte for the encoding and one for the type of samples in text, then what is encoded.
void fuzzDecoders(std::span<const std::byte> bytes) {
    constexpr io::Encoding kEncodings[] = {io::Encoding::Plain, io::Encoding::Deflate, io::Encoding::Bzip2,
                                           io::Encoding::Hex, io::Encoding::Text};
    ByteReader in(bytes);
    const std::size_t choice = in.get<std::uint8_t>() % (std::size(kEncodings) + 2);
    const auto type = static_cast<io::FileType>(in.get<std::uint8_t>() % (static_cast<int>(io::FileType::F64) + 1));
    const auto content = in.getBytes(in.remaining());
    if (choice < std::size(kEncodings))
        decodeTwice(content, kEncodings[choice], kEncodings[choice] == io::Encoding::Text ? type : io::FileType::U8);
    else if (choice == std::size(kEncodings))
        readText(content);
    else
        inflate(content);
}

} // namespace isoslider::fuzz
