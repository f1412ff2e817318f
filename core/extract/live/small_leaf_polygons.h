#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/extract/live/leaves_around.h"
#include "core/extract/merged/merged_polygon.h"

namespace isoslider::extract {

/// Polygons of leaves of side 2, which most leaves of rough data are, each made once: a leaf's polygon depends on the
/// signs of its 27 points and on which leaves across its faces are smaller, and the same few thousand such patterns
/// come again and again. A table with one place for each hash: what comes later replaces what is there.
class SmallLeafPolygons {
public:
    /// No face square has more than one segment, and there are 24.
    static constexpr std::size_t kMostCorners = 24;

    struct Polygon {
        /// Signs x + 3 y + 9 z, then which faces have smaller leaves beside them; bits that do not matter are 0. 0:
        /// none.
        std::uint64_t pattern = 0;
        std::uint8_t cornerCount = 0;
        std::uint8_t triangleCount = 0; ///< 0: spanned from a vertex inside
        /// As MergedPolygon names edges, from the leaf's first point on, and kIsSplit.
        std::array<std::uint16_t, kMostCorners> edges{};
        std::array<std::array<std::uint8_t, 3>, kMostCorners - 2> triangles{};
    };
    /// The edge lies inside a face beside smaller leaves, or on the border of one: it is of the grid.
    static constexpr std::uint16_t kIsSplit = 1u << 15;
    static constexpr std::uint16_t kEdgeMask = kIsSplit - 1;

    /// What MergedPolygon makes of the leaf. REQUIRES: as there; level 1. The answer lasts until the next question.
    const Polygon& find(const LeavesAround& leaves, const LeafCell& leaf);

    /// The level of a corner's edge, as smallestLevelAt() has it.
    static int levelOf(std::uint16_t edge, const LeavesAround& leaves, const LeafCell& leaf);

private:
    void make(const LeavesAround& leaves, const LeafCell& leaf, unsigned splitFaces, Polygon& polygon);

    static constexpr int kTableBits = 12;
    std::vector<Polygon> table_;
    MergedPolygon<LeavesAround> polygon_;
};

} // namespace isoslider::extract
