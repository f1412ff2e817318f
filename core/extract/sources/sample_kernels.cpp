#include "core/extract/sources/sample_kernels.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <optional>

// Compiled once for each instruction set; the best one that the machine has is chosen when the program runs.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/extract/sources/sample_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/extract/live/bit_lists-inl.h"
#include "core/extract/live/wide_bits-inl.h"

#ifndef ISO_FINISH_CLASSIFICATION
#define ISO_FINISH_CLASSIFICATION
namespace isoslider::extract {

/// Do(Stored, Name) for every StoredSample: signed integers of 8 and 16 bits are stored as unsigned ones.
#define ISO_FOR_EACH_STORED_TYPE(Do) \
    Do(std::uint8_t, U8) Do(std::uint16_t, U16) Do(std::int32_t, I32) Do(float, F32) Do(double, F64)

// What follows from the signs, for every instruction set that this is inlined into.
template <class T>
inline __attribute__((always_inline)) void finishClassification(const BrickMasks& masks,
                                                                std::optional<BitsInMemory> before,
                                                                ClassifiedBrick<T>& out) {
    findActive(out.above, masks, out.active);
    std::uint32_t owned = 0, added = 0, removed = 0;
    const auto count = [&](std::size_t axis, int i, std::uint64_t was) {
        const auto w = static_cast<std::size_t>(i);
        const std::uint64_t now = out.active.edges[axis].words[w] & masks.owned[axis].words[w];
        was &= masks.owned[axis].words[w];
        owned += static_cast<std::uint32_t>(std::popcount(now));
        added += static_cast<std::uint32_t>(std::popcount(now & ~was));
        removed += static_cast<std::uint32_t>(std::popcount(was & ~now));
    };
    if (before) {
        UnsetBits flipped;
        for (int i = 0; i < kBitWords; ++i) {
            const auto w = static_cast<std::size_t>(i);
            const std::uint64_t here = before->words[w];
            flipped.words[w] = here ^ out.above.words[w];
            count(0, i, here ^ shiftedDown<1>(*before, i));
            count(1, i, here ^ shiftedDown<9>(*before, i));
            count(2, i, here ^ shiftedDown<81>(*before, i));
        }
        cellsAtPoints(flipped, out.changed);
    } else {
        out.changed.words.fill(~std::uint64_t{0});
        for (int i = 0; i < kBitWords; ++i)
            for (std::size_t axis = 0; axis < 3; ++axis)
                count(axis, i, 0);
    }
    out.ownedEdges = owned;
    out.edgesAdded = added;
    out.edgesRemoved = removed;
}

} // namespace isoslider::extract
#endif

HWY_BEFORE_NAMESPACE();
namespace isoslider::extract::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET == HWY_AVX2
// Bits of 32 lanes, of registers in which each lane has all bits or none: a few packs, for moving the bits of each
// register out takes longer.
HWY_INLINE std::uint32_t bitsOf(std::array<__m256i, 2> lanes) {
    const __m256i bytes = _mm256_packs_epi16(lanes[0], lanes[1]);
    return static_cast<std::uint32_t>(_mm256_movemask_epi8(_mm256_permute4x64_epi64(bytes, 0b11011000)));
}
HWY_INLINE std::uint32_t bitsOf(std::array<__m256i, 4> lanes) {
    const __m256i bytes =
        _mm256_packs_epi16(_mm256_packs_epi32(lanes[0], lanes[1]), _mm256_packs_epi32(lanes[2], lanes[3]));
    const __m256i order = _mm256_setr_epi32(0, 4, 1, 5, 2, 6, 3, 7);
    return static_cast<std::uint32_t>(_mm256_movemask_epi8(_mm256_permutevar8x32_epi32(bytes, order)));
}
#endif

// A bit for each of the samples, which are whole halves of words.
template <std::size_t kSamples, class T>
void findSigns(const T* HWY_RESTRICT samples, T threshold, std::uint64_t* HWY_RESTRICT above, T& leastAbove,
               T& greatestBelow) {
    constexpr std::size_t kHalf = 32;
    static_assert(kSamples % kHalf == 0);
    const hn::CappedTag<T, kHalf> d;
    constexpr std::size_t lanes = hn::MaxLanes(d); // no instruction set of unknown length has fewer
    const auto limit = hn::Set(d, threshold);
    const auto greatest = hn::Set(d, std::numeric_limits<T>::max()),
               least = hn::Set(d, std::numeric_limits<T>::lowest());
    auto up = greatest, down = least;
    // Less the limit, unsigned samples above it are the least ones in their order, and those below, which go round at
    // zero, the greatest ones.
    constexpr bool kIsCyclic = std::is_unsigned_v<T>;
    const auto areBelow = [&](const T* HWY_RESTRICT from) HWY_ATTR {
        const auto sample = hn::Load(d, from);
#if HWY_TARGET == HWY_AVX2
        if constexpr (std::is_same_v<T, float>) {
            // What is left out becomes no number, and of one and a number the least and the greatest are the second
            // operand: to choose between two values takes this instruction set two or three steps.
            const __m256 isBelow = _mm256_cmp_ps(sample.raw, limit.raw, _CMP_LT_OQ),
                         isAbove = _mm256_cmp_ps(sample.raw, limit.raw, _CMP_NLT_UQ);
            up.raw = _mm256_min_ps(_mm256_or_ps(sample.raw, isBelow), up.raw);
            down.raw = _mm256_max_ps(_mm256_or_ps(sample.raw, isAbove), down.raw);
            return hn::MaskFromVec(hn::Vec<decltype(d)>{isBelow});
        }
#endif
        const auto isBelow = hn::Lt(sample, limit);
        if constexpr (kIsCyclic) {
            const auto beyond = hn::Sub(sample, limit);
            up = hn::Min(up, beyond);
            down = hn::Max(down, beyond);
        } else {
            up = hn::Min(up, hn::IfThenElse(isBelow, greatest, sample));
            down = hn::Max(down, hn::IfThenElse(isBelow, sample, least));
        }
        return isBelow;
    };
    const auto halfOf = [&](const T* HWY_RESTRICT from) HWY_ATTR -> std::uint32_t {
#if HWY_TARGET == HWY_AVX2
        if constexpr (lanes == 8 || lanes == 16) {
            std::array<__m256i, kHalf / lanes> below;
            for (std::size_t i = 0; i < below.size(); ++i)
                below[i] =
                    hn::BitCast(hn::RebindToSigned<decltype(d)>(), hn::VecFromMask(d, areBelow(from + i * lanes))).raw;
            return ~bitsOf(below);
        }
#endif
        // As wide as a mask is stored: reading it wider than it was written would wait until it is in the cache.
        using Mask =
            std::conditional_t<lanes <= 8, std::uint8_t, std::conditional_t<lanes <= 16, std::uint16_t, std::uint32_t>>;
        std::uint32_t half = 0;
        for (std::size_t i = 0; i < kHalf; i += lanes) {
            Mask bits = 0;
            hn::StoreMaskBits(d, areBelow(from + i), reinterpret_cast<std::uint8_t*>(&bits));
            if constexpr (lanes < 8)
                bits &= static_cast<Mask>((1u << lanes) - 1);
            half |= std::uint32_t{bits} << i;
        }
        return ~half;
    };
    for (std::size_t w = 0; w < kSamples / (2 * kHalf); ++w)
        above[w] = halfOf(samples + 2 * kHalf * w) | std::uint64_t{halfOf(samples + 2 * kHalf * w + kHalf)} << 32;
    if constexpr (kSamples % (2 * kHalf) != 0)
        above[kSamples / (2 * kHalf)] = halfOf(samples + kSamples - kHalf);
    // Lane by lane: reductions of some types are missing in some sets, and this is once in many samples.
    alignas(64) T ups[kHalf], downs[kHalf];
    hn::Store(up, d, ups);
    hn::Store(down, d, downs);
    for (std::size_t half = lanes / 2; half > 0; half /= 2)
        for (std::size_t i = 0; i < half; ++i) {
            ups[i] = ups[i + half] < ups[i] ? ups[i + half] : ups[i];
            downs[i] = downs[i + half] > downs[i] ? downs[i + half] : downs[i];
        }
    leastAbove = ups[0];
    greatestBelow = downs[0];
    if constexpr (kIsCyclic) {
        const auto most = static_cast<T>(std::numeric_limits<T>::max() - threshold); // of those above
        leastAbove = ups[0] <= most ? static_cast<T>(ups[0] + threshold) : std::numeric_limits<T>::max();
        greatestBelow = downs[0] > most ? static_cast<T>(downs[0] + threshold) : T{0};
    }
}

#if HWY_TARGET <= HWY_AVX2
// As finishClassification().
template <class T>
HWY_INLINE void finish(const BrickMasks& masks, std::optional<BitsInMemory> before, ClassifiedBrick<T>& out) {
    const WideBits above = WideBits::load(out.above);
    const WideBits right = above.down<1>();
    const std::array<WideBits, 3> edges{(above ^ right) & WideBits::load(masks.edges[0]),
                                        (above ^ above.down<9>()) & WideBits::load(masks.edges[1]),
                                        (above ^ above.down<81>()) & WideBits::load(masks.edges[2])};
    const WideBits anyX = above | right, allX = above & right;
    const WideBits anyXy = anyX | anyX.down<9>(), allXy = allX & allX.down<9>();
    ((anyXy | anyXy.down<81>()) & WideBits::load(masks.cells))
        .without(allXy & allXy.down<81>())
        .store(out.active.cells);
    BitCounter owned, added, removed;
    const auto count = [&](std::size_t axis, const WideBits& were) HWY_ATTR {
        edges[axis].store(out.active.edges[axis]);
        const WideBits own = WideBits::load(masks.owned[axis]), now = edges[axis] & own, was = were & own;
        owned.add(now);
        added.add(now.without(was));
        removed.add(was.without(now));
    };
    if (before) {
        const WideBits had = WideBits::load(*before);
        count(0, had ^ had.down<1>());
        count(1, had ^ had.down<9>());
        count(2, had ^ had.down<81>());
        const WideBits flipped = had ^ above;
        const WideBits x = flipped | flipped.down<1>(), xy = x | x.down<9>();
        (xy | xy.down<81>()).store(out.changed);
    } else {
        for (std::size_t axis = 0; axis < 3; ++axis)
            count(axis, WideBits::none());
        out.changed.words.fill(~std::uint64_t{0});
    }
    out.ownedEdges = owned.total();
    out.edgesAdded = added.total();
    out.edgesRemoved = removed.total();
}
#else
template <class T>
HWY_INLINE void finish(const BrickMasks& masks, std::optional<BitsInMemory> before, ClassifiedBrick<T>& out) {
    finishClassification(masks, before, out);
}
#endif

template <class T>
void classifyInVectors(const T* HWY_RESTRICT samples, T threshold, const BrickMasks& masks,
                       std::optional<BitsInMemory> before, ClassifiedBrick<T>& out) {
    findSigns<kKeptPoints>(samples, threshold, out.above.words.data(), out.up, out.down);
    finish(masks, before, out);
}

#define ISO_CLASSIFY(Stored, Name) \
    void classify##Name(const Stored* s, Stored t, const BrickMasks& m, std::optional<BitsInMemory> b, \
                        ClassifiedBrick<Stored>& out) { \
        classifyInVectors(s, t, m, b, out); \
    } \
    void classifyAgain##Name(const BrickMasks& m, std::optional<BitsInMemory> b, ClassifiedBrick<Stored>& out) { \
        finish(m, b, out); \
    } \
    void classifyLeafEdges##Name(const LeafEdgeSamples<Stored>& e, Stored t, ClassifiedLeafEdges<Stored>& out) { \
        findSigns<LeafEdgeSamples<Stored>::kCount>(e.samples.data(), t, out.above.data(), out.up, out.down); \
    }
ISO_FOR_EACH_STORED_TYPE(ISO_CLASSIFY)
#undef ISO_CLASSIFY

std::uint32_t numberEdgesHere(const ActiveBits& active, VertexCode* HWY_RESTRICT codes, VertexTable& vertices) {
    static_assert(vertexCode(closedEdge(1, ClosedPoint(5))) == 4 * 5 + 1); // also its place in the vertex table
    VertexCode* end = codes;
    end = listBits<4>(active.edges[0], 0, end);
    end = listBits<4>(active.edges[1], 1, end);
    end = listBits<4>(active.edges[2], 2, end);
    const auto count = static_cast<std::uint32_t>(end - codes);
#pragma GCC unroll 4
    for (std::uint32_t k = 0; k < count; ++k)
        vertices.numbers[codes[k]] = static_cast<std::uint16_t>(k);
    return count;
}

} // namespace isoslider::extract::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace isoslider::extract {

#define ISO_CLASSIFY(Stored, Name) \
    HWY_EXPORT(classify##Name); \
    template <> \
    void classify(const Stored* s, Stored t, const BrickMasks& m, std::optional<BitsInMemory> b, \
                  ClassifiedBrick<Stored>& out) { \
        HWY_DYNAMIC_DISPATCH(classify##Name)(s, t, m, b, out); \
    } \
    HWY_EXPORT(classifyAgain##Name); \
    template <> \
    void classifyAgain(const BrickMasks& m, std::optional<BitsInMemory> b, ClassifiedBrick<Stored>& out) { \
        HWY_DYNAMIC_DISPATCH(classifyAgain##Name)(m, b, out); \
    } \
    HWY_EXPORT(classifyLeafEdges##Name); \
    template <> \
    void classifyLeafEdges(const LeafEdgeSamples<Stored>& e, Stored t, ClassifiedLeafEdges<Stored>& out) { \
        HWY_DYNAMIC_DISPATCH(classifyLeafEdges##Name)(e, t, out); \
    }
ISO_FOR_EACH_STORED_TYPE(ISO_CLASSIFY)
#undef ISO_CLASSIFY

HWY_EXPORT(numberEdgesHere);
std::uint32_t numberEdges(const ActiveBits& active, VertexCode* codes, VertexTable& vertices) {
    return HWY_DYNAMIC_DISPATCH(numberEdgesHere)(active, codes, vertices);
}

template <class Stored>
void classifyReference(const Stored* samples, Stored threshold, const BrickMasks& masks,
                       std::optional<BitsInMemory> before, ClassifiedBrick<Stored>& out) {
    out.above = {};
    out.up = std::numeric_limits<Stored>::max();
    out.down = std::numeric_limits<Stored>::lowest();
    for (unsigned p = 0; p < kKeptPoints; ++p) {
        if (samples[p] >= threshold) {
            out.above.set(ClosedPoint(p));
            out.up = std::min(out.up, samples[p]);
        } else {
            out.down = std::max(out.down, samples[p]);
        }
    }
    finishClassification(masks, before, out);
}
#define ISO_INSTANTIATE(Stored, Name) \
    template void classifyReference(const Stored*, Stored, const BrickMasks&, std::optional<BitsInMemory>, \
                                    ClassifiedBrick<Stored>&);
ISO_FOR_EACH_STORED_TYPE(ISO_INSTANTIATE)
#undef ISO_INSTANTIATE

namespace {
std::vector<std::int64_t> supportedTargets() {
    std::vector<std::int64_t> targets;
    for (auto rest = static_cast<std::uint64_t>(hwy::SupportedTargets() & HWY_TARGETS); rest != 0; rest &= rest - 1)
        targets.push_back(static_cast<std::int64_t>(std::uint64_t{1} << std::countr_zero(rest)));
    return targets; // better ones have lower bits
}
} // namespace

std::vector<std::string> kernelTargets() {
    std::vector<std::string> names;
    for (const std::int64_t target : supportedTargets())
        names.emplace_back(hwy::TargetName(target));
    return names;
}

void useKernelTarget(std::size_t number) {
    hwy::SetSupportedTargetsForTest(0);
    const auto targets = supportedTargets();
    if (number > 0)
        hwy::SetSupportedTargetsForTest(targets.at(number));
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

} // namespace isoslider::extract
#endif
