#include "core/extract/sources/edge_kernels.h"

#include <algorithm>
#include <bit>

// Compiled once for each instruction set; the best one that the machine has is chosen when the program runs.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/extract/sources/edge_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/extract/live/wide_bits-inl.h"

#ifndef ISO_EDGE_KERNELS
#define ISO_EDGE_KERNELS
namespace isoslider::extract {

/// Lanes that are read of a point's far keys, of which there are at most six.
inline constexpr std::size_t kFarLanes = 8;
static_assert(index::kPointEdges <= kFarLanes);

/// By mask and bits in the order of the mask's: the bits at the mask's places.
inline constexpr auto kAtPlaces = [] {
    constexpr std::size_t kMasks = 1u << index::kPointEdges;
    std::array<std::array<std::uint8_t, kMasks>, kMasks> places{};
    for (unsigned mask = 0; mask < kMasks; ++mask)
        for (unsigned bits = 0; bits < kMasks; ++bits) {
            unsigned left = bits, at = 0;
            for (unsigned e = 0; e < index::kPointEdges; ++e)
                if (mask >> e & 1) {
                    at |= (left & 1u) << e;
                    left >>= 1;
                }
            places[mask][bits] = static_cast<std::uint8_t>(at);
        }
    return places;
}();

/// A bit string as its words, where vectors do not hold one.
struct PlainBits {
    std::array<std::uint64_t, kBitWords + BitString::kGuard> words; ///< those behind the last are zero

    static ISO_ALWAYS_INLINE PlainBits load(const BitString& bits) { return {bits.words}; }
    ISO_ALWAYS_INLINE void store(BitString& bits) const { bits.words = words; }
    template <int K>
    ISO_ALWAYS_INLINE PlainBits down() const {
        return ofWords([this](int i) { return shiftedDown<K>(*this, i); });
    }
    template <int K>
    ISO_ALWAYS_INLINE PlainBits up() const {
        constexpr int kWord = K / 64, kBit = K % 64;
        const auto word = [this](int i) { return i >= 0 ? words[static_cast<std::size_t>(i)] : 0; };
        return ofWords([&](int i) { return word(i - kWord) << kBit | word(i - kWord - 1) >> (64 - kBit); });
    }
    friend ISO_ALWAYS_INLINE PlainBits operator&(const PlainBits& a, const PlainBits& b) {
        return ofWords([&](int i) { return a.at(i) & b.at(i); });
    }
    friend ISO_ALWAYS_INLINE PlainBits operator|(const PlainBits& a, const PlainBits& b) {
        return ofWords([&](int i) { return a.at(i) | b.at(i); });
    }
    friend ISO_ALWAYS_INLINE PlainBits operator^(const PlainBits& a, const PlainBits& b) {
        return ofWords([&](int i) { return a.at(i) ^ b.at(i); });
    }
    ISO_ALWAYS_INLINE PlainBits without(const PlainBits& others) const {
        return ofWords([&](int i) { return at(i) & ~others.at(i); });
    }
    ISO_ALWAYS_INLINE bool isEmpty() const {
        std::uint64_t any = 0;
        for (int i = 0; i < kBitWords; ++i)
            any |= at(i);
        return any == 0;
    }

private:
    std::uint64_t at(int i) const { return words[static_cast<std::size_t>(i)]; }
    template <class Word>
    static ISO_ALWAYS_INLINE PlainBits ofWords(const Word& word) {
        PlainBits bits;
        for (int i = 0; i < kBitWords; ++i)
            bits.words[static_cast<std::size_t>(i)] = word(i);
        bits.words[kBitWords] = bits.words[kBitWords + 1] = 0;
        return bits;
    }
};

/// Sets of edges by the point at one of their ends: eight bit strings side by side, the last two empty, so that the
/// edges of a point go into one line of memory.
struct EdgesByPoint {
    alignas(64) std::array<std::array<std::uint64_t, 8>, kBitWords + BitString::kGuard> rows;

    void clear() {
        for (auto& row : rows)
            row = {};
    }
    /// Word w of the points whose edge e is listed.
    std::uint64_t word(std::size_t edge, int w) const { return rows[static_cast<std::size_t>(w)][edge]; }
    /// Word w of the points from which a point whose edge e is listed lies K further on.
    template <int K>
    std::uint64_t wordBelow(std::size_t edge, int w) const {
        constexpr int kWord = K / 64, kBit = K % 64;
        return word(edge, w + kWord) >> kBit | word(edge, w + kWord + 1) << (64 - kBit);
    }
};

/// Upwards along an axis an edge starts at the point, downwards a step before it. Activated edges of a move up have
/// their other end above, of a move down the point itself.
template <int kAxis>
ISO_ALWAYS_INLINE void toggleAlong(const EdgesByPoint& activated, const EdgesByPoint& deactivated,
                                   const BrickMasks& masks, bool goesUp, ToggledEdges& out) {
    constexpr int kStride = kPointStride[kAxis];
    constexpr std::size_t kDown = 2 * kAxis, kUp = kDown + 1;
    BitString aboveAtEnd; // of edges, by their start
    for (int i = 0; i < kBitWords; ++i) {
        const auto w = static_cast<std::size_t>(i);
        const std::uint64_t mask = masks.edges[kAxis].words[w];
        const std::uint64_t down = activated.wordBelow<kStride>(kDown, i) & mask, up = activated.word(kUp, i) & mask;
        out.activated[kAxis].words[w] = down | up;
        out.deactivated[kAxis].words[w] = (deactivated.wordBelow<kStride>(kDown, i) | deactivated.word(kUp, i)) & mask;
        out.above.words[w] = (kAxis == 0 ? 0 : out.above.words[w]) | (goesUp ? down : up);
        aboveAtEnd.words[w] = goesUp ? up : down;
    }
    for (int i = 0; i < kBitWords; ++i)
        out.above.words[static_cast<std::size_t>(i)] |= shiftedUp<kStride>(aboveAtEnd, i);
}

} // namespace isoslider::extract
#endif

HWY_BEFORE_NAMESPACE();
namespace isoslider::extract::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

template <class Key>
ISO_ALWAYS_INLINE void findOfPoint(const Key* far, unsigned mask, Key last, Key first, std::uint8_t& above,
                                   std::uint8_t& below) {
    const hn::CappedTag<Key, kFarLanes> d;
    const auto isAbove = hn::Set(d, last), isBelow = hn::Set(d, first);
    constexpr std::size_t kLanes = hn::MaxLanes(d);
    unsigned aboveBits = 0, belowBits = 0;
    for (std::size_t i = 0; i < static_cast<std::size_t>(index::kPointEdges); i += kLanes) {
        const auto keys = hn::LoadU(d, far + i);
        std::uint8_t bits[8] = {}; // Highway writes up to so many
        hn::StoreMaskBits(d, hn::Gt(keys, isAbove), bits);
        aboveBits |= unsigned{bits[0]} << i;
        hn::StoreMaskBits(d, hn::Lt(keys, isBelow), bits);
        belowBits |= unsigned{bits[0]} << i;
    }
    constexpr unsigned kAll = (1u << index::kPointEdges) - 1;
    above = kAtPlaces[mask][aboveBits & kAll];
    below = kAtPlaces[mask][belowBits & kAll];
}

template <class Key>
void findChangedEdgesHere(const std::uint8_t* masks, std::size_t count, const Key* far, std::size_t farCount,
                          KeyThreshold lower, KeyThreshold upper, std::uint8_t* above, std::uint8_t* below) {
    const Key last = static_cast<Key>(upper - 1), first = static_cast<Key>(lower);
    std::size_t i = 0, entry = 0;
    for (; i < count && entry + kFarLanes <= farCount; ++i) {
        const unsigned mask = masks[i];
        findOfPoint(far + entry, mask, last, first, above[i], below[i]);
        entry += static_cast<std::size_t>(std::popcount(mask));
    }
    if (i == count)
        return;
    Key rest[2 * kFarLanes] = {}; // the column's end, less than kFarLanes
    const std::size_t from = entry;
    std::copy(far + from, far + farCount, rest);
    for (; i < count; ++i) {
        const unsigned mask = masks[i];
        findOfPoint(rest + (entry - from), mask, last, first, above[i], below[i]);
        entry += static_cast<std::size_t>(std::popcount(mask));
    }
}

void listToggledEdgesHere(const CrossedEdges* points, std::size_t stride, std::size_t count, const BrickMasks& masks,
                          bool goesUp, ToggledEdges& out) {
    EdgesByPoint activated, deactivated;
    activated.clear();
    deactivated.clear();
    const hn::CappedTag<std::uint64_t, 8> d;
    constexpr std::size_t kLanes = hn::MaxLanes(d);
    const auto* at = reinterpret_cast<const std::byte*>(points);
    for (std::size_t i = 0; i < count; ++i, at += stride) {
        const auto& edges = *reinterpret_cast<const CrossedEdges*>(at);
        const std::size_t w = edges.point.index() >> 6;
        const auto bit = hn::Set(d, std::uint64_t{1} << (edges.point.number() & 63u));
        const auto add = [&](EdgesByPoint& to, unsigned mask) {
            for (std::size_t e = 0; e < 8; e += kLanes) {
                const std::uint8_t bits[8] = {static_cast<std::uint8_t>(mask >> e)};
                std::uint64_t* const lanes = to.rows[w].data() + e;
                hn::Store(hn::Or(hn::Load(d, lanes), hn::IfThenElseZero(hn::LoadMaskBits(d, bits), bit)), d, lanes);
            }
        };
        add(activated, edges.activated);
        add(deactivated, edges.deactivated);
    }
    toggleAlong<0>(activated, deactivated, masks, goesUp, out);
    toggleAlong<1>(activated, deactivated, masks, goesUp, out);
    toggleAlong<2>(activated, deactivated, masks, goesUp, out);
}

#if HWY_TARGET <= HWY_AVX3_DL
using Bits = WideBits;
#else
using Bits = PlainBits;
#endif

struct Edges {
    Bits x, y, z;
    static HWY_INLINE Edges load(const std::array<BitString, 3>& edges) {
        return {Bits::load(edges[0]), Bits::load(edges[1]), Bits::load(edges[2])};
    }
    HWY_INLINE Bits ends() const { return x | x.up<1>() | y | y.up<9>() | z | z.up<81>(); }
    // The cells around them: those at an edge's point and a step back across it.
    HWY_INLINE Bits cells() const {
        const Bits xy = x | x.down<9>(), yx = y | y.down<1>(), zx = z | z.down<1>();
        return (xy | xy.down<81>()) | (yx | yx.down<81>()) | (zx | zx.down<9>());
    }
};

HWY_INLINE Bits spread(const Bits& seeds, const Edges& still, int rounds) {
    Bits above = seeds;
    for (int round = 0; round < rounds; ++round) {
        const Bits further = above | (above & still.x).up<1>() | (above.down<1>() & still.x) |
                             (above & still.y).up<9>() | (above.down<9>() & still.y) | (above & still.z).up<81>() |
                             (above.down<81>() & still.z);
        if ((further ^ above).isEmpty())
            break;
        above = further;
    }
    return above;
}

HWY_INLINE bool areEdgesOf(const Edges& edges, const Bits& cells, const Bits& above) {
    const Bits xy = cells | cells.up<9>(), yx = cells | cells.up<1>();
    const Bits wrong = ((above ^ above.down<1>() ^ edges.x) & (xy | xy.up<81>())) |
                       ((above ^ above.down<9>() ^ edges.y) & (yx | yx.up<81>())) |
                       ((above ^ above.down<81>() ^ edges.z) & (yx | yx.up<9>()));
    return wrong.isEmpty();
}

void spreadSignsHere(const std::array<BitString, 3>& edges, const std::array<BitString, 3>& still,
                     const BitString& seeds, const BitString& validCells, int rounds, EdgeSigns& out) {
    (Edges::load(edges).cells() & Bits::load(validCells)).store(out.cells);
    spread(Bits::load(seeds), Edges::load(still), rounds).store(out.above);
}

bool areEdgesOfSignsHere(const std::array<BitString, 3>& edges, const EdgeSigns& signs) {
    return areEdgesOf(Edges::load(edges), Bits::load(signs.cells), Bits::load(signs.above));
}

void changeEdgesHere(const ToggledEdges& toggled, const BrickMasks& masks, const BitString& aboveBefore,
                     std::array<BitString, 3>& edges, ChangedBrick& out) {
    const Edges before = Edges::load(edges), on = Edges::load(toggled.activated),
                off = Edges::load(toggled.deactivated), valid = Edges::load(masks.edges);
    const Edges stay{before.x.without(off.x), before.y.without(off.y), before.z.without(off.z)};
    const Bits twice = off.x.without(before.x) | off.y.without(before.y) | off.z.without(before.z) | (on.x & stay.x) |
                       (on.y & stay.y) | (on.z & stay.z);
    const Edges after{stay.x | on.x, stay.y | on.y, stay.z | on.z};
    after.x.store(edges[0]);
    after.y.store(edges[1]);
    after.z.store(edges[2]);
    const Bits cells = after.cells() & Bits::load(masks.cells);
    const Edges still{valid.x.without(after.x), valid.y.without(after.y), valid.z.without(after.z)};
    // An edge that stays active keeps the signs of its ends.
    const Bits above =
        spread((stay.ends() & Bits::load(aboveBefore)) | Bits::load(toggled.above), still, kRoundsInCells);
    cells.store(out.signs.cells);
    above.store(out.signs.above);
    const Edges flipped{before.x ^ after.x, before.y ^ after.y, before.z ^ after.z};
    const Bits ends = flipped.ends(), right = ends | ends.down<1>(), front = right | right.down<9>();
    (front | front.down<81>()).store(out.changed);
    std::uint32_t owned = 0;
    for (std::size_t a = 0; a < 3; ++a)
        for (std::size_t w = 0; w < kBitWords; ++w)
            owned += static_cast<std::uint32_t>(std::popcount(edges[a].words[w] & masks.owned[a].words[w]));
    out.ownedEdges = owned;
    out.isConsistent = twice.isEmpty();
    out.isOfSigns = areEdgesOf(after, cells, above);
}

#define ISO_KERNEL(Key, Name) \
    void findChangedEdges##Name(const std::uint8_t* masks, std::size_t count, const Key* far, std::size_t farCount, \
                                KeyThreshold lower, KeyThreshold upper, std::uint8_t* above, std::uint8_t* below) { \
        findChangedEdgesHere(masks, count, far, farCount, lower, upper, above, below); \
    }
ISO_KERNEL(std::uint16_t, U16)
ISO_KERNEL(std::uint32_t, U32)
ISO_KERNEL(std::uint64_t, U64)
#undef ISO_KERNEL

} // namespace isoslider::extract::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace isoslider::extract {

#define ISO_DISPATCH(Key, Name) \
    HWY_EXPORT(findChangedEdges##Name); \
    template <> \
    void findChangedEdges(std::span<const std::uint8_t> masks, std::span<const Key> far, KeyThreshold lower, \
                          KeyThreshold upper, std::uint8_t* above, std::uint8_t* below) { \
        HWY_DYNAMIC_DISPATCH(findChangedEdges##Name) \
        (masks.data(), masks.size(), far.data(), far.size(), lower, upper, above, below); \
    }
ISO_DISPATCH(std::uint16_t, U16)
ISO_DISPATCH(std::uint32_t, U32)
ISO_DISPATCH(std::uint64_t, U64)
#undef ISO_DISPATCH

template <class Key>
void findChangedEdgesReference(std::span<const std::uint8_t> masks, std::span<const Key> far, KeyThreshold lower,
                               KeyThreshold upper, std::uint8_t* above, std::uint8_t* below) {
    std::size_t entry = 0;
    for (std::size_t i = 0; i < masks.size(); ++i) {
        above[i] = below[i] = 0;
        for (unsigned e = 0; e < index::kPointEdges; ++e) {
            if ((masks[i] >> e & 1) == 0)
                continue;
            const std::uint64_t key = far[entry++];
            above[i] |= static_cast<std::uint8_t>(unsigned{key >= upper} << e);
            below[i] |= static_cast<std::uint8_t>(unsigned{key < lower} << e);
        }
    }
}
#define ISO_INSTANTIATE(Key) \
    template void findChangedEdgesReference(std::span<const std::uint8_t>, std::span<const Key>, KeyThreshold, \
                                            KeyThreshold, std::uint8_t*, std::uint8_t*);
ISO_INSTANTIATE(std::uint16_t)
ISO_INSTANTIATE(std::uint32_t)
ISO_INSTANTIATE(std::uint64_t)
#undef ISO_INSTANTIATE

HWY_EXPORT(listToggledEdgesHere);
void listToggledEdges(const CrossedEdges* points, std::size_t stride, std::size_t count, const BrickMasks& masks,
                      bool goesUp, ToggledEdges& out) {
    HWY_DYNAMIC_DISPATCH(listToggledEdgesHere)(points, stride, count, masks, goesUp, out);
}

HWY_EXPORT(spreadSignsHere);
void spreadSigns(const std::array<BitString, 3>& edges, const std::array<BitString, 3>& still, const BitString& seeds,
                 const BitString& validCells, int rounds, EdgeSigns& out) {
    HWY_DYNAMIC_DISPATCH(spreadSignsHere)(edges, still, seeds, validCells, rounds, out);
}

HWY_EXPORT(areEdgesOfSignsHere);
bool areEdgesOfSigns(const std::array<BitString, 3>& edges, const EdgeSigns& signs) {
    return HWY_DYNAMIC_DISPATCH(areEdgesOfSignsHere)(edges, signs);
}

HWY_EXPORT(changeEdgesHere);
void changeEdges(const ToggledEdges& toggled, const BrickMasks& masks, const BitString& aboveBefore,
                 std::array<BitString, 3>& edges, ChangedBrick& out) {
    HWY_DYNAMIC_DISPATCH(changeEdgesHere)(toggled, masks, aboveBefore, edges, out);
}

} // namespace isoslider::extract
#endif
