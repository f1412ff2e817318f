// Bit strings in registers, for kernels that are compiled for several instruction sets: include it inside
// foreach_target.
#if defined(ISO_WIDE_BITS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef ISO_WIDE_BITS_INL_H
#undef ISO_WIDE_BITS_INL_H
#else
#define ISO_WIDE_BITS_INL_H
#endif

#include <hwy/highway.h>

#include "core/extract/live/brick_bits.h"

HWY_BEFORE_NAMESPACE();
namespace isoslider::extract::HWY_NAMESPACE {

#if HWY_TARGET <= HWY_AVX3_DL
// A bit string in two registers: reading one at shifted places just after it was written waits for the cache.
struct WideBits {
    __m512i lower, upper; // the upper half of `upper` is zero

    static HWY_INLINE WideBits load(const BitString& bits) {
        return {_mm512_load_si512(bits.words.data()), _mm512_maskz_loadu_epi64(kUpperWords, bits.words.data() + 8)};
    }
    static HWY_INLINE WideBits load(BitsInMemory bits) {
        return {_mm512_loadu_si512(bits.words), _mm512_maskz_loadu_epi64(kUpperWords, bits.words + 8)};
    }
    template <class Bits>
    HWY_INLINE void store(Bits& bits) const {
        _mm512_store_si512(bits.words.data(), lower);
        _mm512_mask_storeu_epi64(bits.words.data() + 8, kUpperWords, upper);
    }
    // The string in which bit p is bit p + K.
    template <int K>
    HWY_INLINE WideBits down() const {
        constexpr int kWord = K / 64, kBit = K % 64;
        static_assert(kBit != 0);
        const __m512i none = _mm512_setzero_si512();
        return {_mm512_shrdi_epi64(_mm512_alignr_epi64(upper, lower, kWord),
                                   _mm512_alignr_epi64(upper, lower, kWord + 1), kBit),
                _mm512_shrdi_epi64(_mm512_alignr_epi64(none, upper, kWord), _mm512_alignr_epi64(none, upper, kWord + 1),
                                   kBit)};
    }
    friend HWY_INLINE WideBits operator&(const WideBits& a, const WideBits& b) {
        return {_mm512_and_si512(a.lower, b.lower), _mm512_and_si512(a.upper, b.upper)};
    }
    friend HWY_INLINE WideBits operator|(const WideBits& a, const WideBits& b) {
        return {_mm512_or_si512(a.lower, b.lower), _mm512_or_si512(a.upper, b.upper)};
    }
    friend HWY_INLINE WideBits operator^(const WideBits& a, const WideBits& b) {
        return {_mm512_xor_si512(a.lower, b.lower), _mm512_xor_si512(a.upper, b.upper)};
    }
    HWY_INLINE WideBits without(const WideBits& others) const {
        return {_mm512_andnot_si512(others.lower, lower), _mm512_andnot_si512(others.upper, upper)};
    }
    HWY_INLINE __m512i counts() const {
        return _mm512_add_epi64(_mm512_popcnt_epi64(lower), _mm512_popcnt_epi64(upper));
    }

private:
    static constexpr __mmask8 kUpperWords = (1u << (kBitWords - 8)) - 1;
};
#endif

} // namespace isoslider::extract::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
