#include "core/extract/sources/edge_change_kernels.h"

#include <algorithm>
#include <array>
#include <bit>

// Compiled once for each instruction set; the best one that the machine has is chosen when the program runs.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/extract/sources/edge_change_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#ifndef ISO_EDGE_CHANGE_KERNELS
#define ISO_EDGE_CHANGE_KERNELS
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

} // namespace isoslider::extract
#endif

HWY_BEFORE_NAMESPACE();
namespace isoslider::extract::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

template <class Key>
HWY_INLINE void findOfPoint(const Key* far, unsigned mask, Key last, Key first, std::uint8_t& above,
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

} // namespace isoslider::extract
#endif
