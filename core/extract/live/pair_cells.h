#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>

#include "core/extract/live/brick_bits.h"

namespace isoslider::extract {

// The 64 cells of side 2 of a brick as bits x + 4 y + 16 z of one word.

/// Those in a cell of side 4, by its bit x + 2 y + 4 z.
constexpr std::uint64_t pairsOfFour(unsigned number) {
    return std::uint64_t{0x330033} << (2 * (number & 1) + 8 * (number >> 1 & 1) + 32 * (number >> 2));
}

/// Of a row of nine bits those at even places side by side, and those at odd ones.
struct SplitRow {
    std::uint8_t even, odd;
};
inline constexpr std::array<SplitRow, 512> kSplitRows = [] {
    std::array<SplitRow, 512> rows{};
    for (unsigned row = 0; row < rows.size(); ++row)
        for (unsigned x = 0; x < 9; ++x) {
            std::uint8_t& half = x % 2 == 0 ? rows[row].even : rows[row].odd;
            half = static_cast<std::uint8_t>(half | (row >> x & 1) << (x / 2));
        }
    return rows;
}();
inline const SplitRow& splitRow(std::uint64_t row) { return kSplitRows[row & 511]; }

/// For each of them what its eight cells combine to.
template <class Combine>
std::uint64_t combineEight(const BitString& cells, const Combine& combine) {
    UnsetBits x, xy, all;
    for (std::size_t w = 0; w < kBitWords; ++w)
        x.words[w] = combine(cells.words[w], shiftedDown<1>(cells, static_cast<int>(w)));
    for (std::size_t w = 0; w < kBitWords; ++w)
        xy.words[w] = combine(x.words[w], shiftedDown<9>(x, static_cast<int>(w)));
    for (std::size_t w = 0; w < kBitWords; ++w)
        all.words[w] = combine(xy.words[w], shiftedDown<81>(xy, static_cast<int>(w)));
    std::uint64_t found = 0; // at their first cells
    for (int k = 0; k < 16; ++k)
        found |= std::uint64_t{splitRow(bitsFrom(all, closedPoint(0, 2 * (k % 4), 2 * (k / 4)))).even & 15u} << (4 * k);
    return found;
}
inline std::uint64_t allOfEight(const BitString& cells) { return combineEight(cells, std::bit_and<>()); }
inline std::uint64_t anyOfEight(const BitString& cells) { return combineEight(cells, std::bit_or<>()); }

/// The signs of the 27 points of one of them: bit x + 3 y + 9 z. `first`: its first point.
inline std::uint32_t signsOfPair(const BitString& above, ClosedPoint first) {
    std::uint32_t signs = 0;
    for (int z = 0; z < 3; ++z) {
        const std::uint64_t plane = bitsFrom(above, first + z * kPointStride[2]);
        signs |= static_cast<std::uint32_t>((plane & 7) | (plane >> 9 & 7) << 3 | (plane >> 18 & 7) << 6) << (9 * z);
    }
    return signs;
}

/// The cells of the brick in them.
inline BitString cellsOfPairs(std::uint64_t pairs) {
    // Four bits, each twice.
    constexpr auto kTwice = [] {
        std::array<std::uint8_t, 16> twice{};
        for (std::size_t four = 0; four < twice.size(); ++four)
            for (unsigned i = 0; i < 4; ++i)
                twice[four] = static_cast<std::uint8_t>(twice[four] | (four >> i & 1) * 3 << (2 * i));
        return twice;
    }();
    BitString cells;
    for (std::size_t z = 0; z < 4; ++z) {
        if ((pairs >> (16 * z) & 0xffff) == 0)
            continue;
        std::array<std::uint64_t, 4> rows; // two rows of cells each
        for (std::size_t y = 0; y < 4; ++y) {
            const std::uint64_t row = kTwice[pairs >> (16 * z + 4 * y) & 15];
            rows[y] = row | row << kPointStride[1];
        }
        const std::uint64_t low = rows[0] | rows[1] << 18 | rows[2] << 36 | rows[3] << 54, high = rows[3] >> 10;
        for (const std::size_t plane : {2 * z, 2 * z + 1}) {
            const std::size_t first = plane * static_cast<std::size_t>(kPointStride[2]), word = first / 64,
                              shift = first % 64;
            cells.words[word] |= low << shift;
            cells.words[word + 1] |= high << shift;
            if (shift != 0) {
                cells.words[word + 1] |= low >> (64 - shift);
                cells.words[word + 2] |= high >> (64 - shift);
            }
        }
    }
    return cells;
}

} // namespace isoslider::extract
