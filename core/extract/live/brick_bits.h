#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "core/extract/live/closed_brick.h"

/// For small functions that are compiled into kernels for several instruction sets.
#define ISO_ALWAYS_INLINE inline __attribute__((always_inline))

namespace isoslider::extract {

// Points, edges and cells of a closed brick are bits of strings of 12 words: a shift by a stride brings each point's
// neighbour to its place.

inline constexpr int kBitWords = (kClosedPoints + 63) / 64;
inline constexpr int kPaddedPoints = 64 * kBitWords;

static_assert(std::endian::native == std::endian::little, "bits are read by bytes");

/// One bit per point. The words behind the last are zero, so that shifted reads need no check.
struct alignas(64) BitString {
    static constexpr int kGuard = 2;
    std::array<std::uint64_t, kBitWords + kGuard> words{};

    bool test(ClosedPoint p) const { return words[wordOf(p)] >> (p.number() & 63) & 1; }
    void set(ClosedPoint p) { words[wordOf(p)] |= bitOf(p); }
    void flip(ClosedPoint p) { words[wordOf(p)] ^= bitOf(p); }
    bool isEmpty() const {
        std::uint64_t any = 0;
        for (int i = 0; i < kBitWords; ++i)
            any |= words[static_cast<std::size_t>(i)];
        return any == 0;
    }
    int count() const {
        int n = 0;
        for (int i = 0; i < kBitWords; ++i)
            n += std::popcount(words[static_cast<std::size_t>(i)]);
        return n;
    }
    friend bool operator==(const BitString&, const BitString&) = default;

private:
    static constexpr std::size_t wordOf(ClosedPoint p) { return p.index() >> 6; }
    static constexpr std::uint64_t bitOf(ClosedPoint p) { return std::uint64_t{1} << (p.number() & 63); }
};

/// A bit string in memory that holds more than it: what stands in the place of the guard may be anything.
struct BitsInMemory {
    const std::uint64_t* words;

    explicit BitsInMemory(const std::uint64_t* first) : words(first) {}
    BitsInMemory(const BitString& bits) : words(bits.words.data()) {}
    BitString copy() const {
        BitString bits;
        std::memcpy(bits.words.data(), words, kBitWords * sizeof *words);
        return bits;
    }
};

/// A bit string that starts with anything but for the guard: for what is written whole at once.
struct UnsetBits {
    alignas(64) std::array<std::uint64_t, kBitWords + BitString::kGuard> words;
    ISO_ALWAYS_INLINE UnsetBits() { words[kBitWords] = words[kBitWords + 1] = 0; }
};

/// Word i of the string in which bit p is bit p + K.
template <int K, class Bits>
ISO_ALWAYS_INLINE std::uint64_t shiftedDown(const Bits& bits, int i) {
    constexpr int kWord = K / 64, kBit = K % 64;
    const auto at = static_cast<std::size_t>(i + kWord);
    if constexpr (kBit == 0)
        return bits.words[at];
    else
        return bits.words[at] >> kBit | bits.words[at + 1] << (64 - kBit);
}

/// Word i of the string in which bit p is bit p - K.
template <int K>
ISO_ALWAYS_INLINE std::uint64_t shiftedUp(const BitString& bits, int i) {
    constexpr int kWord = K / 64, kBit = K % 64;
    const auto word = [&](int at) { return at >= 0 ? bits.words[static_cast<std::size_t>(at)] : 0; };
    if constexpr (kBit == 0)
        return word(i - kWord);
    else
        return word(i - kWord) << kBit | word(i - kWord - 1) >> (64 - kBit);
}

/// At least 56 bits from a place on.
template <class Bits>
ISO_ALWAYS_INLINE std::uint64_t bitsFrom(const Bits& bits, ClosedPoint first) {
    std::uint64_t found;
    std::memcpy(&found, reinterpret_cast<const std::byte*>(bits.words.data()) + first.index() / 8, sizeof found);
    return found >> (first.number() % 8);
}

/// Calls visit(p) for each set bit, ascending.
template <class Bits, class Visit>
inline void forEachSetBit(const Bits& bits, const Visit& visit) {
    for (int i = 0; i < kBitWords; ++i)
        for (std::uint64_t word = bits.words[static_cast<std::size_t>(i)]; word != 0; word &= word - 1)
            visit(ClosedPoint(64 * i + std::countr_zero(word)));
}

/// Signs of the eight corners of a cell, bit c for corner c (core/cell/cell_numbering.h).
ISO_ALWAYS_INLINE std::uint8_t signsOfCell(const BitString& above, ClosedPoint cell) {
    static_assert(kPointStride[1] == 9 && kPointStride[2] == 81);
    constexpr std::uint32_t kFour = 3 | 3 << 9; // of a plane
    std::uint32_t lower, upper; // the upper from ten bytes on, so one bit earlier
    const std::byte* const from = reinterpret_cast<const std::byte*>(above.words.data()) + cell.index() / 8;
    std::memcpy(&lower, from, sizeof lower);
    std::memcpy(&upper, from + 10, sizeof upper);
    const unsigned first = cell.number() % 8;
    const std::uint32_t both = (lower >> first & kFour) | (upper >> first << 3 & kFour << 4);
    return static_cast<std::uint8_t>(both | both >> 7);
}

} // namespace isoslider::extract
