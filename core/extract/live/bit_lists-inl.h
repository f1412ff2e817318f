// Lists of set bits, for kernels that are compiled for several instruction sets: include it inside foreach_target.
#if defined(ISO_BIT_LISTS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef ISO_BIT_LISTS_INL_H
#undef ISO_BIT_LISTS_INL_H
#else
#define ISO_BIT_LISTS_INL_H
#endif

#include <hwy/highway.h>

#include "core/extract/live/brick_bits.h"

HWY_BEFORE_NAMESPACE();
namespace isoslider::extract::HWY_NAMESPACE {

/// Writes Scale * p + offset for each set bit p, ascending; returns the end of what is written, behind which there is
/// room for 32 more.
template <int Scale>
HWY_INLINE std::uint16_t* listBits(const BitString& bits, std::uint16_t offset, std::uint16_t* HWY_RESTRICT out) {
#if HWY_TARGET <= HWY_AVX3_DL
    namespace hn = hwy::HWY_NAMESPACE;
    const hn::CappedTag<std::uint16_t, 32> d;
    constexpr int kLanes = 32;
    const auto step = hn::Set(d, static_cast<std::uint16_t>(kLanes * Scale));
    auto numbers = hn::Add(hn::Mul(hn::Iota(d, 0), hn::Set(d, static_cast<std::uint16_t>(Scale))), hn::Set(d, offset));
    for (int half = 0; half < 2 * kBitWords; ++half) {
        const std::uint64_t word = bits.words[static_cast<std::size_t>(half / 2)];
        const auto some = static_cast<std::uint32_t>(half % 2 == 0 ? word : word >> 32);
        const auto mask = hn::LoadMaskBits(d, reinterpret_cast<const std::uint8_t*>(&some));
        hn::StoreU(hn::Compress(numbers, mask), d, out);
        out += std::popcount(some);
        numbers = hn::Add(numbers, step);
    }
    return out;
#else
    // Four at a time, which leaves the processor less to guess than a loop per bit.
    for (int i = 0; i < kBitWords; ++i) {
        std::uint64_t word = bits.words[static_cast<std::size_t>(i)];
        std::uint16_t* at = out;
        out += std::popcount(word);
        do {
            for (int k = 0; k < 4; ++k) {
                at[k] = static_cast<std::uint16_t>(Scale * (64 * i + std::countr_zero(word | std::uint64_t{1} << 63)) +
                                                   offset);
                word &= word - 1;
            }
            at += 4;
        } while (at < out);
    }
    return out;
#endif
}

} // namespace isoslider::extract::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
