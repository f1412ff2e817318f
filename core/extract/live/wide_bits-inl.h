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

namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET <= HWY_AVX3_DL
// A bit string in two registers: reading one at shifted places just after it was written waits for the cache.
struct WideBits {
    __m512i lower, upper; // the upper half of `upper` is zero

    static HWY_INLINE WideBits load(const BitString& bits) {
        return {_mm512_load_si512(bits.words.data()), _mm512_maskz_loadu_epi64(kUpperWords, bits.words.data() + 8)};
    }
    static HWY_INLINE WideBits none() { return {_mm512_setzero_si512(), _mm512_setzero_si512()}; }
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

private:
    friend class BitCounter;
    static constexpr __mmask8 kUpperWords = (1u << (kBitWords - 8)) - 1;
};

// How many bits are set in all of some strings.
class BitCounter {
public:
    HWY_INLINE BitCounter() : counts_(_mm512_setzero_si512()) {}
    HWY_INLINE void add(const WideBits& bits) {
        counts_ = _mm512_add_epi64(counts_,
                                   _mm512_add_epi64(_mm512_popcnt_epi64(bits.lower), _mm512_popcnt_epi64(bits.upper)));
    }
    HWY_INLINE std::uint32_t total() const { return static_cast<std::uint32_t>(_mm512_reduce_add_epi64(counts_)); }

private:
    __m512i counts_;
};
#elif HWY_TARGET <= HWY_AVX2
// The same in three registers of half the size.
struct WideBits {
    using D = hn::FixedTag<std::uint64_t, 4>;
    using V = hn::Vec<D>;
    V first, second, third;

    static HWY_INLINE WideBits of(const std::uint64_t* words) {
        const D d;
        return {hn::LoadU(d, words), hn::LoadU(d, words + 4), hn::LoadU(d, words + 8)};
    }
    static HWY_INLINE WideBits load(const BitString& bits) { return of(bits.words.data()); }
    static HWY_INLINE WideBits load(BitsInMemory bits) { return of(bits.words); }
    static HWY_INLINE WideBits none() {
        const D d;
        return {hn::Zero(d), hn::Zero(d), hn::Zero(d)};
    }
    template <class Bits>
    HWY_INLINE void store(Bits& bits) const {
        const D d;
        hn::StoreU(first, d, bits.words.data());
        hn::StoreU(second, d, bits.words.data() + 4);
        hn::StoreU(third, d, bits.words.data() + 8);
    }
    template <int K>
    HWY_INLINE WideBits down() const {
        return {down<K>(first, second), down<K>(second, third), down<K>(third, hn::Zero(D()))};
    }
    friend HWY_INLINE WideBits operator&(const WideBits& a, const WideBits& b) {
        return {hn::And(a.first, b.first), hn::And(a.second, b.second), hn::And(a.third, b.third)};
    }
    friend HWY_INLINE WideBits operator|(const WideBits& a, const WideBits& b) {
        return {hn::Or(a.first, b.first), hn::Or(a.second, b.second), hn::Or(a.third, b.third)};
    }
    friend HWY_INLINE WideBits operator^(const WideBits& a, const WideBits& b) {
        return {hn::Xor(a.first, b.first), hn::Xor(a.second, b.second), hn::Xor(a.third, b.third)};
    }
    HWY_INLINE WideBits without(const WideBits& others) const {
        return {hn::AndNot(others.first, first), hn::AndNot(others.second, second), hn::AndNot(others.third, third)};
    }

private:
    template <int K>
    static HWY_INLINE V down(V words, V next) {
        constexpr int kWord = K / 64, kBit = K % 64;
        static_assert(kWord < 2 && kBit != 0);
        const D d;
        const V byTwo = hn::ConcatLowerUpper(d, next, words);
        const V byOne = hn::CombineShiftRightBytes<8>(d, byTwo, words);
        return hn::Or(hn::ShiftRight<kBit>(kWord == 0 ? words : byOne),
                      hn::ShiftLeft<64 - kBit>(kWord == 0 ? byOne : byTwo));
    }
};

class BitCounter {
public:
    HWY_INLINE BitCounter() : counts_(hn::Zero(Bytes())) {}
    HWY_INLINE void add(const WideBits& bits) { // up to 24 in each byte: ten strings at most
        for (const auto& words : {bits.first, bits.second, bits.third})
            counts_ = hn::Add(counts_, hn::PopulationCount(hn::BitCast(Bytes(), words)));
    }
    HWY_INLINE std::uint32_t total() const {
        return static_cast<std::uint32_t>(hn::GetLane(hn::SumOfLanes(WideBits::D(), hn::SumsOf8(counts_))));
    }

private:
    using Bytes = hn::FixedTag<std::uint8_t, 32>;
    hn::Vec<Bytes> counts_;
};
#endif

} // namespace isoslider::extract::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
