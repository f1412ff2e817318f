#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "core/cell/cell_numbering.h"
#include "core/extract/live/brick_leaves.h"
#include "core/extract/live/closed_brick.h"

namespace isoslider::extract {

constexpr ClosedPoint cornerOfBrick(unsigned corner) {
    return closedPoint(corner & 1 ? kCellSide : 0, corner & 2 ? kCellSide : 0, corner & 4 ? kCellSide : 0);
}

/// A brick that is one leaf, where all around it that matters is as large: a cell of side 8.
struct OneLeaf {
    std::uint8_t signs = 0; ///< of its corners
    /// By leaf edge, how far along it the active edge starts; of leaf edges whose ends differ in sign.
    std::array<std::uint8_t, 12> along{};

    ClosedEdge activeEdge(std::size_t leafEdge) const {
        const cell::CellEdge& edge = cell::kCellEdges[leafEdge];
        return closedEdge(edge.axis, cornerOfBrick(edge.lowerCorner) + along[leafEdge] * kPointStride[edge.axis]);
    }
};

/// The samples on the leaf edges of a brick that is one leaf: 105 of its 729.
template <class Stored>
struct alignas(64) LeafEdgeSamples {
    static constexpr std::size_t kPlaces = 16; ///< of each edge; those behind its end repeat it
    static constexpr std::size_t kCount = 12 * kPlaces;
    std::array<Stored, kCount> samples;

    void fill(const Stored* ofBrick) {
        for (std::size_t e = 0; e < 12; ++e) {
            const cell::CellEdge& edge = cell::kCellEdges[e];
            const ClosedPoint lower = cornerOfBrick(edge.lowerCorner);
            for (int k = 0; k < static_cast<int>(kPlaces); ++k)
                samples[kPlaces * e + static_cast<std::size_t>(k)] =
                    ofBrick[(lower + std::min(k, kCellSide) * kPointStride[edge.axis]).index()];
        }
    }
};
/// Which of them are above.
using LeafEdgeSigns = std::array<std::uint64_t, 3>;

/// REQUIRES: along each leaf edge the sign changes at most once.
inline OneLeaf oneLeafOf(const LeafEdgeSigns& above) {
    const auto signsAlong = [&](std::size_t e) {
        return static_cast<unsigned>(above[e / 4] >> (16 * (e % 4)) & ((1u << kPointSide) - 1));
    };
    unsigned signs = 0;
    for (std::size_t e = 0; e < 4; ++e) // those along x have all corners
        signs |= ((signsAlong(e) & 1) | (signsAlong(e) >> (kCellSide - 1) & 2)) << (2 * e);
    OneLeaf leaf{static_cast<std::uint8_t>(signs), {}};
    for (unsigned open = cell::activeEdges(leaf.signs); open != 0; open &= open - 1) {
        const auto e = static_cast<std::size_t>(std::countr_zero(open));
        const unsigned along = signsAlong(e);
        const int first = std::popcount((along & 1) != 0 ? along : ~along & ((1u << kPointSide) - 1)); // of one sign
        leaf.along[e] = static_cast<std::uint8_t>(first - 1);
    }
    return leaf;
}

/// Whether OneLeaf states all that a brick which is one leaf looks like: wherever one of its faces or edges is crossed,
/// the bricks beside are one leaf each or outside the volume. `leavesAt` as LeavesAround::fill() takes it.
template <class LeavesAt>
bool isAloneAsOneLeaf(std::uint8_t signs, const LeavesAt& leavesAt) {
    const auto isLarge = [&](const BrickStep& step) {
        const BrickLeaves* const leaves = leavesAt(step);
        return leaves == nullptr || leaves->level3;
    };
    for (unsigned open = cell::activeEdges(signs); open != 0; open &= open - 1) {
        const cell::CellEdge& edge = cell::kCellEdges[static_cast<std::size_t>(std::countr_zero(open))];
        BrickStep across{};
        for (std::size_t a = 0; a < 3; ++a)
            if (a != static_cast<std::size_t>(edge.axis))
                across[a] = edge.lowerCorner >> a & 1 ? 1 : -1;
        for (std::size_t a = 0; a < 3; ++a) { // the two faces, both crossed
            BrickStep beside{};
            beside[a] = across[a];
            if (across[a] != 0 && !isLarge(beside))
                return false;
        }
        if (!isLarge(across))
            return false;
    }
    return true;
}

} // namespace isoslider::extract
