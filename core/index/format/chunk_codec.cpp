#include "core/index/format/chunk_codec.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <memory>
#include <type_traits>

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

#include <zstd.h>

#include "core/base/byte_codec.h"
#include "core/base/check.h"
#include "core/index/format/zigzag.h"
#include "core/index/format/zstd_contexts.h"

namespace isoslider::index {
namespace {

// FORMAT.md, "Chunk of samples", has the bytes.
//
// Measured: bytes / raw bytes, and MB/s of samples on one core of a busy machine, zstd 1.5.4. "packed":
// residuals in groups of 32 cut to their widest, by count. That is the fastest rival: groups of 128, larger
// still, were read at 20,000 MB/s and more before the filter is undone; but it is larger by 10 to 90 %, white
// noise and doubles apart, and this is fast enough.
//
//                        bytes  encode  decode |   packed  zstd 1, one frame | chunks of 8     32
//   white noise    f32   0.815     790    2630 |    0.846              0.854 |       0.839  0.813
//   noise256       f32   0.612     460    1230 |    0.689              0.625 |       0.646  0.579
//   Blunt Fin      f32   0.154     560    1390 |    0.292              0.134 |       0.223  0.146
//   density map    f32   0.292     600    1890 |    0.436              0.303 |       0.311  0.289
//   shell256       u16   0.166     355    1080 |    0.243              0.166 |       0.262  0.139
//   cranium        i16   0.359     445    1320 |    0.396              0.349 |       0.405  0.355
//   tooth          u16   0.383     500    1400 |    0.422              0.379 |       0.439  0.380
//   head (ch2)     u8    0.323     465    1450 |    0.418              0.327 |       0.379  0.319
//   neghip         u8    0.195     285     830 |    0.281              0.198 |       0.229  0.193
//   hurricane      f64   0.767     630    1820 |    0.779              0.779 |       0.793  0.754
//
// The middle columns are with the best of seven filters for each chunk; the last two are of the middle of
// large volumes, where chunks of 16 have 0.593 of noise256. Filters: one of these three is within 3 % of the
// best of those seven (differences along y or z, the mean of two, and a median predictor were tried).
// Float keys in value order instead of bits: no gain. Bit planes: smaller only where all is smooth. zstd
// levels above 1 are slower to write and hardly smaller, those below 0 leave out the entropy coder.

constexpr std::size_t kMaxSamples = std::size_t{kChunkSide} * kChunkSide * kChunkSide;

enum ChunkMode : unsigned { kRaw = 0, kConstant = 1, kPlain = 2, kAlongX = 3, kLorenzo = 4 };

enum PlaneMode : unsigned { kConstantPlane = 0, kRawPlane = 1, kZstdPlane = 2 };
constexpr int kPlaneModeShift = 14;
constexpr unsigned kPlaneLengthMask = (1u << kPlaneModeShift) - 1;
static_assert(kMaxSamples <= kPlaneLengthMask);

// Smaller savings do not pay for undoing them: a raw plane is read ten times faster than a packed one.
constexpr std::size_t minGain(std::size_t planeBytes) { return planeBytes / 16 + 1; }

template <class Sample>
using BitsOf =
    std::conditional_t<sizeof(Sample) == 1, std::uint8_t,
                       std::conditional_t<sizeof(Sample) == 2, std::uint16_t,
                                          std::conditional_t<sizeof(Sample) == 4, std::uint32_t, std::uint64_t>>>;

struct Scratch : ZstdContexts {
    Scratch() {
        // In effect Huffman coding: matches of seven bytes or more are rare, but long runs are found.
        ISO_CHECK(!ZSTD_isError(ZSTD_CCtx_setParameter(compress.get(), ZSTD_c_strategy, ZSTD_fast)));
        ISO_CHECK(!ZSTD_isError(ZSTD_CCtx_setParameter(compress.get(), ZSTD_c_windowLog, 12)));
        ISO_CHECK(!ZSTD_isError(ZSTD_CCtx_setParameter(compress.get(), ZSTD_c_hashLog, 6)));
        ISO_CHECK(!ZSTD_isError(ZSTD_CCtx_setParameter(compress.get(), ZSTD_c_minMatch, 7)));
    }
    std::array<std::array<std::uint8_t, kMaxSamples>, 8> planes;
    std::array<std::byte, ZSTD_COMPRESSBOUND(kMaxSamples)> packed;
    alignas(64) std::array<std::byte, 8 * kMaxSamples> bits, residuals;
};

Scratch& scratch() {
    thread_local const std::unique_ptr<Scratch> kept = std::make_unique<Scratch>();
    return *kept;
}

struct Shape {
    explicit Shape(const ChunkExtent& extent) : x(extent[0]), y(extent[1]), z(extent[2]) {
        for (const int side : extent)
            ISO_CHECK(side >= 1 && side <= kChunkSide);
    }
    std::size_t count() const {
        return static_cast<std::size_t>(x) * static_cast<std::size_t>(y) * static_cast<std::size_t>(z);
    }
    std::uint16_t code(ChunkMode mode) const {
        return static_cast<std::uint16_t>(mode | static_cast<unsigned>((x - 1) << 4 | (y - 1) << 8 | (z - 1) << 12));
    }
    int x, y, z;
};

// Calls function(width), the width of a whole chunk as a constant, so that loops over a row are unrolled.
template <class Function>
void withWidth(int width, const Function& function) {
    if (width == kChunkSide)
        function(std::integral_constant<int, kChunkSide>{});
    else
        function(width);
}

// ---- writing

// Of the row (y, z) of `chunk`, as `mode` states.
template <class Bits, class Width>
void residualsOfRow(ChunkMode mode, const Bits* chunk, const Shape& shape, Width width, int y, int z, Bits* out) {
    const std::ptrdiff_t toPlane = std::ptrdiff_t{width} * shape.y;
    const Bits* row = chunk + width * y + toPlane * z;
    if (mode == kPlain) {
        std::copy_n(row, int{width}, out);
        return;
    }
    std::array<Bits, kChunkSide + 1> line; // line[x + 1]: what is left at x after the other axes
    std::copy_n(row, int{width}, line.begin() + 1);
    if (mode == kAlongX) {
        line[0] = y > 0 ? row[-width] : z > 0 ? row[-toPlane] : Bits(0);
    } else {
        line[0] = 0;
        const auto addRow = [&](const Bits* other, Bits sign) {
            for (int x = 0; x < width; ++x) // 1u: of 16 bits, the product would overflow an int
                line[x + 1] = static_cast<Bits>(line[x + 1] + static_cast<Bits>(1u * sign * other[x]));
        };
        if (y > 0)
            addRow(row - width, static_cast<Bits>(-1));
        if (z > 0)
            addRow(row - toPlane, static_cast<Bits>(-1));
        if (y > 0 && z > 0)
            addRow(row - toPlane - width, 1);
    }
    for (int x = 0; x < width; ++x)
        out[x] = zigzag(static_cast<Bits>(line[x + 1] - line[x]));
}

// 256 n log2 n, rounded down at each step, in integers: the choice is the same on every machine.
constexpr std::size_t kMaxSampled = kMaxSamples / 4;
constexpr auto kEntropyTable = [] {
    std::array<std::uint32_t, kMaxSampled + 1> table{};
    for (std::uint64_t n = 1; n <= kMaxSampled; ++n) {
        const int whole = std::bit_width(n) - 1;
        std::uint64_t mantissa = (n << 30) >> whole; // in [1, 2), 30 fractional bits
        std::uint32_t log = static_cast<std::uint32_t>(whole);
        for (int bit = 0; bit < 8; ++bit) {
            mantissa = (mantissa * mantissa) >> 30;
            log = log << 1 | static_cast<std::uint32_t>(mantissa >> 31);
            mantissa >>= mantissa >> 31;
        }
        table[n] = static_cast<std::uint32_t>(n) * log;
    }
    return table;
}();

// What an ideal coder of single bytes would need for a quarter of the rows, spread over the chunk.
template <class Bits>
class CostEstimate {
public:
    CostEstimate(ChunkMode mode, const Bits* chunk, const Shape& shape) {
        withWidth(shape.x, [&](auto width) {
            std::array<Bits, kChunkSide> row;
            for (int z = 0; z < shape.z; ++z)
                for (int y = -z & 3; y < shape.y; y += 4) {
                    residualsOfRow(mode, chunk, shape, width, y, z, row.data());
                    for (int x = 0; x < width; ++x)
                        for (std::size_t p = 0; p < sizeof(Bits); ++p)
                            ++counts_[p][x & 1][static_cast<std::uint8_t>(row[static_cast<std::size_t>(x)] >> (8 * p))];
                    sampled_ += static_cast<std::size_t>(width);
                }
        });
        for (std::size_t p = 0; p < sizeof(Bits); ++p) {
            std::uint32_t saved = 0;
            for (std::size_t byte = 0; byte < 256; ++byte)
                saved += kEntropyTable[std::size_t{counts_[p][0][byte]} + counts_[p][1][byte]];
            planeCost_[p] = kEntropyTable[sampled_] - saved;
            cost_ += planeCost_[p];
        }
    }
    std::uint32_t cost() const { return cost_; }

    // Less than minGain in sight. So few bytes never look quite random: 1024 random ones cost 7.8 bits each.
    bool looksRandom(std::size_t plane) const {
        return planeCost_[plane] > static_cast<std::uint32_t>(sampled_) * static_cast<std::uint32_t>(7.65 * 256);
    }

private:
    // Two tables taken in turn: a run of equal bytes need not wait for its own counter.
    std::array<std::array<std::array<std::uint16_t, 256>, 2>, sizeof(Bits)> counts_{};
    std::array<std::uint32_t, sizeof(Bits)> planeCost_;
    std::uint32_t cost_ = 0;
    std::size_t sampled_ = 0;
};

void appendPlane(std::vector<std::byte>& chunk, std::size_t tableAt, std::span<const std::uint8_t> plane,
                 bool looksRandom) {
    const auto put = [&](PlaneMode mode, std::span<const std::byte> data) {
        storeLittle<std::uint16_t>(chunk.data() + tableAt,
                                   static_cast<std::uint16_t>(data.size() | mode << kPlaneModeShift));
        chunk.insert(chunk.end(), data.begin(), data.end());
    };
    const std::span<const std::byte> raw = std::as_bytes(plane);
    if (std::memcmp(raw.data(), raw.data() + 1, raw.size() - 1) == 0)
        return put(kConstantPlane, raw.first(1));
    if (!looksRandom) {
        Scratch& s = scratch();
        const std::size_t packed =
            orOutOfMemory(ZSTD_compress2(s.compress.get(), s.packed.data(), s.packed.size(), raw.data(), raw.size()));
        if (!ZSTD_isError(packed) && packed + minGain(raw.size()) <= raw.size())
            return put(kZstdPlane, std::span(s.packed).first(packed));
    }
    put(kRawPlane, raw);
}

template <class Bits>
void appendPlanes(std::vector<std::byte>& chunk, const Bits* bits, const Shape& shape) {
    ChunkMode mode = kPlain;
    CostEstimate<Bits> estimate(mode, bits, shape);
    for (const ChunkMode other : {kAlongX, kLorenzo})
        if (const CostEstimate<Bits> next(other, bits, shape); next.cost() < estimate.cost()) {
            mode = other;
            estimate = next;
        }
    Scratch& s = scratch();
    Bits* residuals = reinterpret_cast<Bits*>(s.residuals.data());
    withWidth(shape.x, [&](auto width) {
        Bits* out = residuals;
        for (int z = 0; z < shape.z; ++z)
            for (int y = 0; y < shape.y; ++y, out += width)
                residualsOfRow(mode, bits, shape, width, y, z, out);
    });
    const std::size_t count = shape.count();
    storeLittle<std::uint16_t>(chunk.data(), shape.code(mode));
    chunk.resize(kChunkHeaderBytes + 2 * sizeof(Bits));
    for (std::size_t p = 0; p < sizeof(Bits); ++p) {
        std::uint8_t* plane = s.planes[0].data();
        for (std::size_t i = 0; i < count; ++i)
            plane[i] = static_cast<std::uint8_t>(residuals[i] >> (8 * p));
        appendPlane(chunk, kChunkHeaderBytes + 2 * p, {plane, count}, estimate.looksRandom(p));
    }
}

template <class Bits>
void appendLittle(std::vector<std::byte>& chunk, std::span<const Bits> values) {
    const std::size_t at = chunk.size();
    chunk.resize(at + values.size_bytes());
    for (std::size_t i = 0; i < values.size(); ++i)
        storeLittle<Bits>(chunk.data() + at + i * sizeof(Bits), values[i]);
}

// ---- reading

// Running sums of a row.
template <class Bits, class Width>
void sumAlongX(Bits* row, Width width) {
#if defined(__SSE2__)
    // Left to itself the compiler adds one narrow sample after the other.
    if constexpr (sizeof(Bits) <= 2 && !std::is_same_v<Width, int>) {
        constexpr int kVectors = sizeof(Bits);
        __m128i carry = _mm_setzero_si128();
        for (int v = 0; v < kVectors; ++v) {
            __m128i* at = reinterpret_cast<__m128i*>(row) + v;
            __m128i sums = _mm_loadu_si128(at);
            if constexpr (sizeof(Bits) == 1) {
                sums = _mm_add_epi8(sums, _mm_slli_si128(sums, 1));
                sums = _mm_add_epi8(sums, _mm_slli_si128(sums, 2));
                sums = _mm_add_epi8(sums, _mm_slli_si128(sums, 4));
                sums = _mm_add_epi8(sums, _mm_slli_si128(sums, 8));
            } else {
                sums = _mm_add_epi16(sums, _mm_slli_si128(sums, 2));
                sums = _mm_add_epi16(sums, _mm_slli_si128(sums, 4));
                sums = _mm_add_epi16(_mm_add_epi16(sums, _mm_slli_si128(sums, 8)), carry);
                carry = _mm_shuffle_epi32(_mm_shufflehi_epi16(sums, 0xff), 0xff);
            }
            _mm_storeu_si128(at, sums);
        }
        return;
    }
#endif
    for (int x = 1; x < width; ++x)
        row[x] = static_cast<Bits>(row[x] + row[x - 1]);
}

template <class Bits, class Count>
void addFrom(Bits* to, const Bits* from, Count count) {
    for (int i = 0; i < count; ++i)
        to[i] = static_cast<Bits>(to[i] + from[i]);
}

template <class Bits, class Width>
void undoAlongX(Bits* bits, const Shape& shape, Width width) {
    Bits* row = bits;
    for (int z = 0; z < shape.z; ++z)
        for (int y = 0; y < shape.y; ++y, row += width) {
            const std::ptrdiff_t toStart = y > 0 ? width : std::ptrdiff_t{width} * shape.y;
            if (y + z > 0)
                row[0] = static_cast<Bits>(row[0] + row[-toStart]);
            sumAlongX(row, width);
        }
}

// The three sums in any order give the same: sums along y and z are sums of whole rows and planes.
template <class Bits, class Width>
void undoLorenzo(Bits* bits, const Shape& shape, Width width) {
    const int planeSamples = width * shape.y;
    for (int z = 0; z < shape.z; ++z) {
        Bits* plane = bits + std::ptrdiff_t{planeSamples} * z;
        sumAlongX(plane, width);
        for (int y = 1; y < shape.y; ++y) {
            Bits* row = plane + width * y;
            sumAlongX(row, width);
            addFrom(row, row - width, width);
        }
        if (z > 0)
            addFrom(plane, plane - planeSamples, planeSamples);
    }
}

// Where the bytes of each plane lie, `count` of each; false when a plane is malformed.
template <std::size_t kPlanes>
bool readPlanes(std::span<const std::byte> data, std::size_t count, std::array<const std::uint8_t*, kPlanes>& planes) {
    if (data.size() < 2 * kPlanes)
        return false;
    Scratch& s = scratch();
    std::span<const std::byte> rest = data.subspan(2 * kPlanes);
    for (std::size_t p = 0; p < kPlanes; ++p) {
        const unsigned entry = loadLittle<std::uint16_t>(data.data() + 2 * p);
        const std::size_t length = entry & kPlaneLengthMask;
        if (length > rest.size())
            return false;
        const std::span<const std::byte> bytes = rest.first(length);
        rest = rest.subspan(length);
        std::uint8_t* plane = s.planes[p].data();
        planes[p] = plane;
        switch (entry >> kPlaneModeShift) {
            case kConstantPlane:
                if (length != 1)
                    return false;
                std::memset(plane, static_cast<int>(bytes[0]), count);
                break;
            case kRawPlane:
                if (length != count)
                    return false;
                planes[p] = reinterpret_cast<const std::uint8_t*>(bytes.data());
                break;
            case kZstdPlane:
                if (ZSTD_decompressDCtx(s.decompress.get(), plane, count, bytes.data(), length) != count)
                    return false; // an error is a number larger than any count
                break;
            default: return false;
        }
    }
    return rest.empty();
}

template <class Bits>
bool decodePlanes(ChunkMode mode, std::span<const std::byte> data, const Shape& shape, Bits* bits) {
    std::array<const std::uint8_t*, sizeof(Bits)> planes;
    const std::size_t count = shape.count();
    if (!readPlanes(data, count, planes))
        return false;
    const auto join = [&](const auto& undo) {
        for (std::size_t i = 0; i < count; ++i) {
            Bits value = 0;
            for (std::size_t p = 0; p < sizeof(Bits); ++p)
                value = static_cast<Bits>(value | static_cast<Bits>(static_cast<Bits>(planes[p][i]) << (8 * p)));
            bits[i] = undo(value);
        }
    };
    if (mode == kPlain) {
        join([](Bits value) { return value; });
        return true;
    }
    join([](Bits value) { return unzigzag(value); });
    withWidth(shape.x,
              [&](auto width) { mode == kAlongX ? undoAlongX(bits, shape, width) : undoLorenzo(bits, shape, width); });
    return true;
}

} // namespace

template <class Sample>
std::vector<std::byte> encodeChunk(std::span<const Sample> samples, const ChunkExtent& extent) {
    using Bits = BitsOf<Sample>;
    const Shape shape(extent);
    ISO_CHECK(samples.size() == shape.count());
    Bits* const bits = reinterpret_cast<Bits*>(scratch().bits.data());
    std::memcpy(bits, samples.data(), samples.size_bytes());
    std::vector<std::byte> chunk;
    chunk.reserve(kChunkHeaderBytes + 2 * sizeof(Bits) + samples.size_bytes());
    chunk.resize(kChunkHeaderBytes);
    if (std::memcmp(bits, bits + 1, samples.size_bytes() - sizeof(Bits)) == 0) {
        storeLittle<std::uint16_t>(chunk.data(), shape.code(kConstant));
        appendLittle<Bits>(chunk, {bits, 1});
        return chunk;
    }
    appendPlanes(chunk, bits, shape);
    if (chunk.size() >= kChunkHeaderBytes + samples.size_bytes()) {
        chunk.resize(kChunkHeaderBytes);
        storeLittle<std::uint16_t>(chunk.data(), shape.code(kRaw));
        appendLittle<Bits>(chunk, {bits, samples.size()});
    }
    return chunk;
}

template <class Sample>
bool decodeChunk(std::span<const std::byte> bytes, const ChunkExtent& extent, std::span<Sample> out) {
    using Bits = BitsOf<Sample>;
    const Shape shape(extent);
    ISO_CHECK(out.size() == shape.count());
    if (bytes.size() < kChunkHeaderBytes)
        return false;
    const unsigned header = loadLittle<std::uint16_t>(bytes.data());
    const ChunkMode mode = static_cast<ChunkMode>(header & 0xf);
    if (header != shape.code(mode) || mode > kLorenzo)
        return false;
    const std::span<const std::byte> data = bytes.subspan(kChunkHeaderBytes);
    if (mode == kConstant) {
        if (data.size() != sizeof(Bits))
            return false;
        std::fill(out.begin(), out.end(), std::bit_cast<Sample>(loadLittle<Bits>(data.data())));
        return true;
    }
    if (mode == kRaw) {
        if (data.size() != out.size_bytes())
            return false;
        for (std::size_t i = 0; i < out.size(); ++i)
            out[i] = std::bit_cast<Sample>(loadLittle<Bits>(data.data() + i * sizeof(Bits)));
        return true;
    }
    Bits* const bits = reinterpret_cast<Bits*>(scratch().bits.data());
    if (!decodePlanes(mode, data, shape, bits))
        return false;
    std::memcpy(out.data(), bits, out.size_bytes());
    return true;
}

template std::vector<std::byte> encodeChunk(std::span<const std::uint8_t>, const ChunkExtent&);
template std::vector<std::byte> encodeChunk(std::span<const std::int8_t>, const ChunkExtent&);
template std::vector<std::byte> encodeChunk(std::span<const std::uint16_t>, const ChunkExtent&);
template std::vector<std::byte> encodeChunk(std::span<const std::int16_t>, const ChunkExtent&);
template std::vector<std::byte> encodeChunk(std::span<const std::int32_t>, const ChunkExtent&);
template std::vector<std::byte> encodeChunk(std::span<const float>, const ChunkExtent&);
template std::vector<std::byte> encodeChunk(std::span<const double>, const ChunkExtent&);
template bool decodeChunk(std::span<const std::byte>, const ChunkExtent&, std::span<std::uint8_t>);
template bool decodeChunk(std::span<const std::byte>, const ChunkExtent&, std::span<std::int8_t>);
template bool decodeChunk(std::span<const std::byte>, const ChunkExtent&, std::span<std::uint16_t>);
template bool decodeChunk(std::span<const std::byte>, const ChunkExtent&, std::span<std::int16_t>);
template bool decodeChunk(std::span<const std::byte>, const ChunkExtent&, std::span<std::int32_t>);
template bool decodeChunk(std::span<const std::byte>, const ChunkExtent&, std::span<float>);
template bool decodeChunk(std::span<const std::byte>, const ChunkExtent&, std::span<double>);

} // namespace isoslider::index
