// Lists of set bits, for kernels that are compiled for several instruction sets: include it inside foreach_target.
#if defined(ISO_BIT_LISTS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef ISO_BIT_LISTS_INL_H
#undef ISO_BIT_LISTS_INL_H
#else
#define ISO_BIT_LISTS_INL_H
#endif

#include <array>
#include <atomic>
#include <bit>

#include <hwy/highway.h>

#include "core/extract/live/brick_bits.h"

HWY_BEFORE_NAMESPACE();
namespace isoslider::extract::HWY_NAMESPACE {

/// Place of the first bit; anything without one.
HWY_INLINE unsigned firstBit(std::uint64_t word) {
#if HWY_TARGET <= HWY_AVX2
    // Not std::countr_zero(), which asks whether there is a bit, nor _tzcnt_u64(): before each the compiler clears the
    // register that is written, for processors of before 2015.
    std::uint64_t place;
    asm("tzcnt %1, %0" : "=r"(place) : "r"(word) : "cc");
    return static_cast<unsigned>(place);
#else
    return static_cast<unsigned>(std::countr_zero(word | std::uint64_t{1} << 63));
#endif
}

/// Writes Scale * p + offset for each set bit p, ascending; returns the end of what is written, behind which there is
/// room for 32 more.
template <int Scale>
HWY_INLINE std::uint16_t* listBits(const BitString& bits, std::uint16_t offset, std::uint16_t* HWY_RESTRICT out) {
#if HWY_TARGET <= HWY_AVX3_DL
    // A word at a time, as bytes; more than 32 of its bits are seldom set.
    alignas(64) static constexpr auto kUpwards = [] {
        std::array<std::uint8_t, 64> upwards{};
        for (std::size_t i = 0; i < upwards.size(); ++i)
            upwards[i] = static_cast<std::uint8_t>(i);
        return upwards;
    }();
    const __m512i upwards = _mm512_load_si512(kUpwards.data());
    constexpr int kShift = std::countr_zero(static_cast<unsigned>(Scale));
    static_assert(1 << kShift == Scale);
    __m512i base = _mm512_set1_epi16(static_cast<short>(offset));
    const __m512i step = _mm512_set1_epi16(64 * Scale);
    const auto widen = [&](__m256i places) HWY_ATTR {
        return _mm512_add_epi16(_mm512_slli_epi16(_mm512_cvtepu8_epi16(places), kShift), base);
    };
    for (int i = 0; i < kBitWords; ++i) {
        const std::uint64_t word = bits.words[static_cast<std::size_t>(i)];
        const __m512i places = _mm512_maskz_compress_epi8(word, upwards);
        const int count = std::popcount(word);
        _mm512_storeu_si512(out, widen(_mm512_castsi512_si256(places)));
        if (HWY_UNLIKELY(count > 32))
            _mm512_storeu_si512(out + 32, widen(_mm512_extracti64x4_epi64(places, 1)));
        out += count;
        base = _mm512_add_epi16(base, step);
    }
    return out;
#else
    // Six at a time, which leaves the processor less to guess than a loop per bit.
    auto base = static_cast<unsigned>(offset);
    for (int i = 0; i < kBitWords; ++i, base += 64 * Scale) {
        std::uint64_t word = bits.words[static_cast<std::size_t>(i)];
        std::uint16_t* at = out;
        out += std::popcount(word);
        do {
#pragma GCC unroll 6
            for (int k = 0; k < 6; ++k) {
                at[k] = static_cast<std::uint16_t>(Scale * firstBit(word) + base);
                // One by one: to put some together for one store takes the compiler twice as many instructions.
                std::atomic_signal_fence(std::memory_order_seq_cst);
                word &= word - 1;
            }
            at += 6;
        } while (at < out);
    }
    return out;
#endif
}

} // namespace isoslider::extract::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
