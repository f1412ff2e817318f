#include "core/extract/brick_signs.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <type_traits>

#if defined(__SSE4_1__)
#include <smmintrin.h>
#endif

#include "core/grid/classification.h"

namespace isoslider::extract {

// How the samples between two isovalues are found was measured (256^3, one core of a 2.6 GHz EPYC, ns per brick of
// 9^3): comparing all of them takes 110 (u8), 160 (u16), 280 (f32), 440 (f64). Keeping each brick's samples in
// order takes 18000 for the sort when the brick is first touched, and then 25, 55 or 185 for 4, 16 or 64 samples in
// between: it pays after some 150 moves through the same brick, for 3 to 6 KB held by each active one, and the
// samples must be read all the same for what they emit. So all are compared.

namespace {

struct Extent {
    int x, y, z; // one past the last
};

template <class Sample>
Extent extentOf(const SampleBlock<Sample>& block) {
    return {std::min(9, block.end[0]), std::min(9, block.end[1]), std::min(9, block.end[2])};
}

void setSign(SignWords& words, int x, int y, int z) {
    const auto plane = static_cast<std::size_t>(z);
    if (x < 8 && y < 8)
        words.here[plane] |= std::uint64_t{1} << (x + 8 * y);
    if (x > 0 && y < 8)
        words.right[plane] |= std::uint64_t{1} << (x - 1 + 8 * y);
    if (x < 8 && y > 0)
        words.behind[plane] |= std::uint64_t{1} << (x + 8 * (y - 1));
}

#if defined(__SSE4_1__)

// The bits of all rows at one threshold: bit x + 1 of row y + 9 z, as vectors give them.
using RowBits = std::array<std::uint16_t, 9 * 9>;

// `inBox`: the bits of a row that count.
SignWords wordsOf(const RowBits& rows, unsigned inBox) {
    const __m128i keep = _mm_set1_epi16(static_cast<short>(inBox));
    const __m128i low = _mm_set1_epi16(0xff);
    SignWords words;
    for (std::size_t z = 0; z < 9; ++z) {
        const std::uint16_t* plane = rows.data() + 9 * z;
        const __m128i bits = _mm_and_si128(_mm_loadu_si128(reinterpret_cast<const __m128i*>(plane)), keep);
        const __m128i here = _mm_and_si128(_mm_srli_epi16(bits, 1), low);
        const __m128i right = _mm_srli_epi16(bits, 2); // bits 2 to 9: fit a byte
        const __m128i both = _mm_packus_epi16(here, right);
        words.here[z] = static_cast<std::uint64_t>(_mm_cvtsi128_si64(both));
        words.right[z] = static_cast<std::uint64_t>(_mm_extract_epi64(both, 1));
        words.behind[z] = words.here[z] >> 8 | static_cast<std::uint64_t>(plane[8] & inBox & 0x1fe) << 55;
    }
    return words;
}

// Rows of a block as vectors: sample x is lane x + 1 of the row. Masks of a row become 16 bits.
template <std::size_t kSampleBytes>
struct IntegerRow;

template <>
struct IntegerRow<1> {
    static constexpr int kVectors = 1;
    static __m128i fill(std::uint64_t v) { return _mm_set1_epi8(static_cast<char>(v)); }
    static __m128i minus(__m128i a, __m128i b) { return _mm_sub_epi8(a, b); }
    static __m128i least(__m128i a, __m128i b) { return _mm_min_epu8(a, b); }
    static __m128i greatest(__m128i a, __m128i b) { return _mm_max_epu8(a, b); }
    static __m128i areEqual(__m128i a, __m128i b) { return _mm_cmpeq_epi8(a, b); }
    static int bits(const __m128i* masks) { return _mm_movemask_epi8(masks[0]); }
};

template <>
struct IntegerRow<2> {
    static constexpr int kVectors = 2;
    static __m128i fill(std::uint64_t v) { return _mm_set1_epi16(static_cast<short>(v)); }
    static __m128i minus(__m128i a, __m128i b) { return _mm_sub_epi16(a, b); }
    static __m128i least(__m128i a, __m128i b) { return _mm_min_epu16(a, b); }
    static __m128i greatest(__m128i a, __m128i b) { return _mm_max_epu16(a, b); }
    static __m128i areEqual(__m128i a, __m128i b) { return _mm_cmpeq_epi16(a, b); }
    static int bits(const __m128i* masks) { return _mm_movemask_epi8(_mm_packs_epi16(masks[0], masks[1])); }
};

int bitsOfDwords(__m128i a, __m128i b, __m128i c) {
    return _mm_movemask_epi8(_mm_packs_epi16(_mm_packs_epi32(a, b), _mm_packs_epi32(c, c)));
}

template <>
struct IntegerRow<4> {
    static constexpr int kVectors = 3;
    static __m128i fill(std::uint64_t v) { return _mm_set1_epi32(static_cast<int>(v)); }
    static __m128i minus(__m128i a, __m128i b) { return _mm_sub_epi32(a, b); }
    static __m128i least(__m128i a, __m128i b) { return _mm_min_epu32(a, b); }
    static __m128i greatest(__m128i a, __m128i b) { return _mm_max_epu32(a, b); }
    static __m128i areEqual(__m128i a, __m128i b) { return _mm_cmpeq_epi32(a, b); }
    static int bits(const __m128i* masks) { return bitsOfDwords(masks[0], masks[1], masks[2]); }
};

// Keys less a threshold, wrapping: those above come to 0 .. last, those below to what is greater. So the least
// and the greatest difference are the nearest keys above and below without any selection, and a sign is
// one comparison; whatever was added to make the sample a key cancels.
template <class Sample>
struct Difference {
    using Bits = std::make_unsigned_t<Sample>;
    static constexpr std::uint64_t kMost = std::numeric_limits<Bits>::max();

    std::uint64_t threshold; // at most kMost + 1, which is above all keys

    explicit Difference(KeyThreshold t) : threshold(std::min(t, kMost + 1)) {}
    bool isAboveAll() const { return threshold > kMost; }
    Bits subtrahend() const {
        return static_cast<Bits>(threshold + static_cast<std::uint64_t>(std::numeric_limits<Sample>::lowest()));
    }
    std::uint64_t last() const { return kMost - threshold; } // unless above all
    std::uint64_t up(std::uint64_t least) const {
        return !isAboveAll() && least <= last() ? threshold + least : ~std::uint64_t{0};
    }
    std::uint64_t down(std::uint64_t greatest) const {
        return isAboveAll() || greatest > last() ? greatest + threshold - (kMost + 1) : 0;
    }
};

template <class Sample>
BrickSigns signsOfIntegers(const SampleBlock<Sample>& block, KeyThreshold fromKey, KeyThreshold toKey) {
    using Row = IntegerRow<sizeof(Sample)>;
    using Bits = typename Difference<Sample>::Bits;
    constexpr int kVectors = Row::kVectors, kLanes = 16 / sizeof(Sample);
    const Extent extent = extentOf(block);
    const Difference<Sample> from(fromKey), to(toKey);
    const __m128i minusFrom = Row::fill(from.subtrahend()), minusTo = Row::fill(to.subtrahend());
    const __m128i lastFrom = Row::fill(from.last()), lastTo = Row::fill(to.last());

    // Lanes are places along x: what lies outside the box is left out at the end, not in every row.
    __m128i least[kVectors], greatest[kVectors];
    for (int v = 0; v < kVectors; ++v) {
        least[v] = _mm_set1_epi8(-1);
        greatest[v] = _mm_setzero_si128();
    }
    RowBits aboveFrom{}, aboveTo{};
    for (int z = 0; z < extent.z; ++z)
        for (int y = 0; y < extent.y; ++y) {
            const Sample* row = block.samples.data() + block.offset(-1, y, z);
            __m128i isAboveFrom[kVectors], isAboveTo[kVectors];
            for (int v = 0; v < kVectors; ++v) {
                const __m128i samples = _mm_load_si128(reinterpret_cast<const __m128i*>(row + kLanes * v));
                const __m128i old = Row::minus(samples, minusFrom), now = Row::minus(samples, minusTo);
                least[v] = Row::least(least[v], now);
                greatest[v] = Row::greatest(greatest[v], now);
                isAboveFrom[v] = Row::areEqual(Row::least(old, lastFrom), old);
                isAboveTo[v] = Row::areEqual(Row::least(now, lastTo), now);
            }
            const auto at = static_cast<std::size_t>(y + 9 * z);
            aboveFrom[at] = static_cast<std::uint16_t>(Row::bits(isAboveFrom));
            aboveTo[at] = static_cast<std::uint16_t>(Row::bits(isAboveTo));
        }

    alignas(16) std::array<Bits, kVectors * kLanes> leastOf, greatestOf;
    for (int v = 0; v < kVectors; ++v) {
        _mm_store_si128(reinterpret_cast<__m128i*>(leastOf.data() + kLanes * v), least[v]);
        _mm_store_si128(reinterpret_cast<__m128i*>(greatestOf.data() + kLanes * v), greatest[v]);
    }
    const unsigned inBox = ((1u << extent.x) - 1) << 1;
    BrickSigns signs;
    signs.from = wordsOf(aboveFrom, from.isAboveAll() ? 0 : inBox);
    signs.to = wordsOf(aboveTo, to.isAboveAll() ? 0 : inBox);
    signs.up = to.up(*std::min_element(leastOf.begin() + 1, leastOf.begin() + 1 + extent.x));
    signs.down = to.down(*std::max_element(greatestOf.begin() + 1, greatestOf.begin() + 1 + extent.x));
    signs.hasMissing = false;
    return signs;
}

// REQUIRES of minimum and maximum: the second operand is no NaN; it is the result where the first is one.
template <class Sample>
struct FloatRow;

template <>
struct FloatRow<float> {
    using Vector = __m128;
    static constexpr int kVectors = 3;
    static Vector fill(float v) { return _mm_set1_ps(v); }
    static Vector load(const float* p) { return _mm_load_ps(p); }
    static void store(float* p, Vector v) { _mm_store_ps(p, v); }
    static Vector minus(Vector a, Vector b) { return _mm_sub_ps(a, b); }
    static Vector either(Vector a, Vector b) { return _mm_or_ps(a, b); }
    static Vector minimum(Vector a, Vector b) { return _mm_min_ps(a, b); }
    static Vector maximum(Vector a, Vector b) { return _mm_max_ps(a, b); }
    static Vector isAtLeast(Vector a, Vector b) { return _mm_cmpge_ps(a, b); }
    static Vector isBelow(Vector a, Vector b) { return _mm_cmplt_ps(a, b); }
    static int bits(const Vector* m) {
        return bitsOfDwords(_mm_castps_si128(m[0]), _mm_castps_si128(m[1]), _mm_castps_si128(m[2]));
    }
};

template <>
struct FloatRow<double> {
    using Vector = __m128d;
    static constexpr int kVectors = 5;
    static Vector fill(double v) { return _mm_set1_pd(v); }
    static Vector load(const double* p) { return _mm_load_pd(p); }
    static void store(double* p, Vector v) { _mm_store_pd(p, v); }
    static Vector minus(Vector a, Vector b) { return _mm_sub_pd(a, b); }
    static Vector either(Vector a, Vector b) { return _mm_or_pd(a, b); }
    static Vector minimum(Vector a, Vector b) { return _mm_min_pd(a, b); }
    static Vector maximum(Vector a, Vector b) { return _mm_max_pd(a, b); }
    static Vector isAtLeast(Vector a, Vector b) { return _mm_cmpge_pd(a, b); }
    static Vector isBelow(Vector a, Vector b) { return _mm_cmplt_pd(a, b); }
    static int bits(const Vector* m) {
        return bitsOfDwords(halves(m[0], m[1]), halves(m[2], m[3]), halves(m[4], m[4]));
    }

private:
    static __m128i halves(Vector a, Vector b) {
        return _mm_castps_si128(_mm_shuffle_ps(_mm_castpd_ps(a), _mm_castpd_ps(b), _MM_SHUFFLE(2, 0, 2, 0)));
    }
};

// The sample with which comparisons say what the key says, for all finite samples: keys of NaNs become the nearest
// number, and infinity lies above all finite ones.
template <class Sample>
Sample thresholdSample(KeyThreshold t) {
    using Limits = std::numeric_limits<Sample>;
    if (t <= keyOf(Limits::lowest()))
        return Limits::lowest();
    return t >= keyOf(Limits::infinity()) ? Limits::infinity() : sampleOfKey<Sample>(static_cast<KeyOf<Sample>>(t));
}

template <class Sample>
BrickSigns signsOfFloats(const SampleBlock<Sample>& block, KeyThreshold fromKey, KeyThreshold toKey) {
    using Row = FloatRow<Sample>;
    using Vector = typename Row::Vector;
    constexpr int kVectors = Row::kVectors, kLanes = 16 / sizeof(Sample);
    constexpr Sample kInfinity = std::numeric_limits<Sample>::infinity();
    const Extent extent = extentOf(block);
    const Vector from = Row::fill(thresholdSample<Sample>(fromKey)), to = Row::fill(thresholdSample<Sample>(toKey));

    Vector up[kVectors], down[kVectors], missing[kVectors]; // lanes as with integers
    for (int v = 0; v < kVectors; ++v) {
        up[v] = Row::fill(kInfinity);
        down[v] = Row::fill(-kInfinity);
        missing[v] = Row::fill(0);
    }
    RowBits aboveFrom{}, aboveTo{};
    for (int z = 0; z < extent.z; ++z)
        for (int y = 0; y < extent.y; ++y) {
            const Sample* row = block.samples.data() + block.offset(-1, y, z);
            Vector isAboveFrom[kVectors], isAboveTo[kVectors];
            for (int v = 0; v < kVectors; ++v) {
                const Vector samples = Row::load(row + kLanes * v);
                isAboveFrom[v] = Row::isAtLeast(samples, from);
                isAboveTo[v] = Row::isAtLeast(samples, to);
                // All ones are a NaN: what is not asked about is made one. Infinities change nothing.
                up[v] = Row::minimum(Row::either(samples, Row::isBelow(samples, to)), up[v]);
                down[v] = Row::maximum(Row::either(samples, isAboveTo[v]), down[v]);
                missing[v] = Row::either(missing[v], Row::minus(samples, samples)); // 0, or NaN
            }
            const auto at = static_cast<std::size_t>(y + 9 * z);
            aboveFrom[at] = static_cast<std::uint16_t>(Row::bits(isAboveFrom));
            aboveTo[at] = static_cast<std::uint16_t>(Row::bits(isAboveTo));
        }

    alignas(16) std::array<Sample, kVectors * kLanes> upOf, downOf, missingOf;
    for (int v = 0; v < kVectors; ++v) {
        Row::store(upOf.data() + kLanes * v, up[v]);
        Row::store(downOf.data() + kLanes * v, down[v]);
        Row::store(missingOf.data() + kLanes * v, missing[v]);
    }
    const unsigned inBox = ((1u << extent.x) - 1) << 1;
    const Sample least = *std::min_element(upOf.begin() + 1, upOf.begin() + 1 + extent.x);
    const Sample greatest = *std::max_element(downOf.begin() + 1, downOf.begin() + 1 + extent.x);
    BrickSigns signs;
    signs.from = wordsOf(aboveFrom, inBox);
    signs.to = wordsOf(aboveTo, inBox);
    signs.up = least < kInfinity ? keyOf(least) : ~std::uint64_t{0};
    signs.down = greatest > -kInfinity ? keyOf(greatest) : 0;
    signs.hasMissing = std::any_of(missingOf.begin() + 1, missingOf.begin() + 1 + extent.x, isMissing<Sample>);
    return signs;
}

#endif

} // namespace

template <class Sample>
BrickSigns findBrickSignsPlainly(const SampleBlock<Sample>& block, KeyThreshold from, KeyThreshold to) {
    const Extent extent = extentOf(block);
    BrickSigns signs{{}, {}, ~std::uint64_t{0}, 0, false};
    for (int z = 0; z < extent.z; ++z)
        for (int y = 0; y < extent.y; ++y)
            for (int x = 0; x < extent.x; ++x) {
                const Sample sample = block.samples[static_cast<std::size_t>(block.offset(x, y, z))];
                if (isMissing(sample)) {
                    signs.hasMissing = true;
                    continue;
                }
                const std::uint64_t key = keyOf(sample);
                if (key >= from)
                    setSign(signs.from, x, y, z);
                if (key >= to) {
                    setSign(signs.to, x, y, z);
                    signs.up = std::min(signs.up, key);
                } else {
                    signs.down = std::max(signs.down, key);
                }
            }
    return signs;
}

template <class Sample>
BrickSigns findBrickSigns(const SampleBlock<Sample>& block, KeyThreshold from, KeyThreshold to) {
#if !defined(__SSE4_1__)
    return findBrickSignsPlainly(block, from, to);
#else
    if constexpr (std::is_floating_point_v<Sample>)
        return signsOfFloats(block, from, to);
    else
        return signsOfIntegers(block, from, to);
#endif
}

#define ISO_INSTANTIATE(Sample)                                                                                        \
    template BrickSigns findBrickSigns(const SampleBlock<Sample>&, KeyThreshold, KeyThreshold);                        \
    template BrickSigns findBrickSignsPlainly(const SampleBlock<Sample>&, KeyThreshold, KeyThreshold);
ISO_INSTANTIATE(std::uint8_t)
ISO_INSTANTIATE(std::int8_t)
ISO_INSTANTIATE(std::uint16_t)
ISO_INSTANTIATE(std::int16_t)
ISO_INSTANTIATE(std::int32_t)
ISO_INSTANTIATE(float)
ISO_INSTANTIATE(double)
#undef ISO_INSTANTIATE

} // namespace isoslider::extract
