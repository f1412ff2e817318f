#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/extract/live/leaves_around.h"
#include "core/extract/merged/merged_polygon.h"

namespace isoslider::extract {

/// Polygons of leaves of side 2, which most leaves of rough data are: a leaf's polygon depends on the signs of its 27
/// points and on which leaves across its faces are smaller, and the same some ten thousand such patterns come again and
/// again, in any volume. So each is made once for all threads and surfaces of the program; a table keeps it. When its
/// places are taken, further patterns are made each time. One object per thread.
class SmallLeafPolygons {
public:
    /// A leaf and all that its polygon depends on.
    struct Leaf {
        ClosedPoint point{}; ///< its first
        std::uint32_t pattern = 0; ///< signs x + 3 y + 9 z and which faces have smaller leaves beside them
        std::uint64_t unmergedAround = 0; ///< as LeavesAround has it
    };
    /// The leaf that starts at the cell of side 2 at x, y, z = 0 to 3; asks for the memory that find() will read.
    static Leaf leafAt(const LeavesAround& leaves, int x, int y, int z);

    struct Polygon {
        /// As places in the leaf; those that lie inside a face beside smaller leaves, or on the border of one, with
        /// kIsSplit.
        std::span<const std::uint8_t> edges;
        /// Three numbers of edges each. None: spanned from a vertex inside.
        std::span<const std::uint8_t> triangles;
    };
    /// What MergedPolygon makes of the leaf. REQUIRES: as there. The answer lasts until the next question.
    Polygon find(const LeavesAround& leaves, const Leaf& leaf);

    /// Of a polygon's edge: where it is in the brick, and its level as smallestLevelAt() has it.
    static ClosedEdge edgeOf(std::uint8_t edge, const Leaf& leaf);
    static int levelOf(std::uint8_t edge, const Leaf& leaf);

private:
    static constexpr std::uint8_t kIsSplit = 0x80;
    struct Kept;

    static Kept* keptAt(std::uint32_t pattern);
    void make(const LeavesAround& leaves, const Leaf& leaf);
    void keep(std::uint32_t pattern) const;

    MergedPolygon<LeavesAround> polygon_;
    std::vector<std::uint8_t> edges_, triangles_; ///< of the polygon that was made last
};

} // namespace isoslider::extract
