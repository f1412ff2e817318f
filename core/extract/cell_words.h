#pragma once

#include <array>
#include <cstdint>

#include "core/extract/brick.h"

namespace isoslider::extract {

/// The edge bits of a brick and of the seven bricks above it (bit 0: +x, bit 1: +y, bit 2: +z); null
/// where there is none. `edges[k]` are three BrickBits by axis.
using EdgeBitsAround = std::array<const std::array<BrickBits, 3>*, 8>;

/// Cells of the brick that have at least one of the given edges, 64 at a time.
BrickBits cellsWithEdges(const EdgeBitsAround& edges);

/// Signs of the eight corners of all cells of a brick: corner c of the cells of plane z is word
/// corners[z][c], bit x + 8 y.
using CornerWords = std::array<std::array<std::uint64_t, 8>, 8>;

/// Corner signs from the active edges, relative to the brick's first grid point: a sign changes
/// exactly along an active edge, so it is the parity of the active edges on the way. Prefix sums
/// modulo 2 along y, then x, whole planes in a word. REQUIRES: no missing values in the brick (an
/// edge beside one is never active).
CornerWords cornersFromEdges(const EdgeBitsAround& active);

/// Cells with a face that has an odd number of active edges: no signs give that. Only a damaged index does.
BrickBits impossibleCells(const EdgeBitsAround& active);

/// Cells whose corners differ.
BrickBits mixedCells(const CornerWords& corners);

/// Signs of one cell's corners. `inverted`: the brick's first grid point is above.
inline std::uint8_t signsOfCell(const CornerWords& corners, LocalPoint cell, bool inverted) {
    const auto& words = corners[cell >> 6];
    const int s = cell & 63;
    unsigned signs = 0;
    for (unsigned c = 0; c < 8; ++c)
        signs |= static_cast<unsigned>(words[c] >> s & 1) << c;
    return static_cast<std::uint8_t>(inverted ? ~signs : signs);
}

} // namespace isoslider::extract
