#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/extract/live/brick_bits.h"

namespace isoslider::extract {

/// What follows from the signs of a brick's points.
struct ActiveBits {
    std::array<BitString, 3> edges; ///< by axis, bit of the point where they start
    BitString cells;
};

/// Which cells, edges and points of a closed brick exist, and which of its edges it counts as its own.
struct BrickMasks {
    BitString cells; ///< in the box, all corners finite
    std::array<BitString, 3> edges; ///< of such a cell of this brick
    std::array<BitString, 3> owned; ///< of `edges`: each edge is owned by one of the bricks that hold it
};

// The functions below are inlined into kernels that are compiled for several instruction sets.

/// Active edges: exclusive or of the signs at both ends. Active cells: neither all corners above nor none. O(1).
ISO_ALWAYS_INLINE void findActive(const BitString& above, const BrickMasks& masks, ActiveBits& active) {
    UnsetBits anyX, allX, anyXy, allXy;
    for (int i = 0; i < kBitWords; ++i) {
        const auto w = static_cast<std::size_t>(i);
        const std::uint64_t here = above.words[w], right = shiftedDown<1>(above, i);
        active.edges[0].words[w] = (here ^ right) & masks.edges[0].words[w];
        active.edges[1].words[w] = (here ^ shiftedDown<9>(above, i)) & masks.edges[1].words[w];
        active.edges[2].words[w] = (here ^ shiftedDown<81>(above, i)) & masks.edges[2].words[w];
        anyX.words[w] = here | right;
        allX.words[w] = here & right;
    }
    for (int i = 0; i < kBitWords; ++i) {
        const auto w = static_cast<std::size_t>(i);
        anyXy.words[w] = anyX.words[w] | shiftedDown<9>(anyX, i);
        allXy.words[w] = allX.words[w] & shiftedDown<9>(allX, i);
    }
    for (int i = 0; i < kBitWords; ++i) {
        const auto w = static_cast<std::size_t>(i);
        const std::uint64_t any = anyXy.words[w] | shiftedDown<81>(anyXy, i);
        const std::uint64_t all = allXy.words[w] & shiftedDown<81>(allXy, i);
        active.cells.words[w] = any & ~all & masks.cells.words[w];
    }
}

/// Cells with a corner among the given points.
template <class Bits>
ISO_ALWAYS_INLINE void cellsAtPoints(const Bits& points, BitString& cells) {
    UnsetBits x, xy;
    for (int i = 0; i < kBitWords; ++i)
        x.words[static_cast<std::size_t>(i)] = points.words[static_cast<std::size_t>(i)] | shiftedDown<1>(points, i);
    for (int i = 0; i < kBitWords; ++i)
        xy.words[static_cast<std::size_t>(i)] = x.words[static_cast<std::size_t>(i)] | shiftedDown<9>(x, i);
    for (int i = 0; i < kBitWords; ++i)
        cells.words[static_cast<std::size_t>(i)] = xy.words[static_cast<std::size_t>(i)] | shiftedDown<81>(xy, i);
}

/// Edges of the given cells.
inline void edgesOfCells(const BitString& cells, std::array<BitString, 3>& edges) {
    BitString acrossX, acrossY; // the cells and their neighbours' places a step up
    for (int i = 0; i < kBitWords; ++i) {
        const auto w = static_cast<std::size_t>(i);
        acrossX.words[w] = cells.words[w] | shiftedUp<1>(cells, i);
        acrossY.words[w] = cells.words[w] | shiftedUp<9>(cells, i);
    }
    for (int i = 0; i < kBitWords; ++i) {
        const auto w = static_cast<std::size_t>(i);
        edges[0].words[w] = acrossY.words[w] | shiftedUp<81>(acrossY, i);
        edges[1].words[w] = acrossX.words[w] | shiftedUp<81>(acrossX, i);
        edges[2].words[w] = acrossX.words[w] | shiftedUp<9>(acrossX, i);
    }
}

} // namespace isoslider::extract
