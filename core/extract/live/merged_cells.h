#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/extract/live/active_bits.h"
#include "core/extract/live/leaves_around.h"
#include "core/extract/live/one_leaf.h"
#include "core/extract/live/small_leaf_polygons.h"
#include "core/extract/merged/merge_bound.h"
#include "core/extract/merged/merged_polygon.h"

namespace isoslider::extract {

/// A merged cell that the surface passes through, as a live brick lists it.
struct MergedLeaf {
    ClosedPoint cell{}; ///< its first
    std::uint8_t level = 0;
    bool hasCentre = false; ///< its polygon is spanned from a vertex inside
    std::uint16_t indexCount = 0;
};

/// Those of the leaves that have one of the cells in them. Each is there by itself, without its halves.
BrickLeaves crossedLeaves(const BrickLeaves& leaves, const BitString& cells);

/// The merged cells of one brick and the vertices of their polygons. PAPER 2.2.
class MergedCells {
public:
    /// A corner of a polygon.
    struct Corner {
        ClosedEdge edge{};
        std::uint16_t level = 0; ///< of the smallest leaf edge that contains it
    };

    /// The brick has none.
    void clear();
    /// Finds the polygons of the merged cells in `active`. Leaves there what else there is: the active cells that are
    /// not merged, and the edges that have a vertex.
    void find(const BrickLeaves& leaves, const LeavesAround& around, ActiveBits& active);
    /// Of a brick that is one leaf and isAloneAsOneLeaf().
    void set(const OneLeaf& leaf);

    /// In the order of their cells.
    std::span<const MergedLeaf> leaves() const { return leaves_; }
    /// Of the polygons. Each edge may be there several times.
    std::span<const Corner> corners() const { return corners_; }
    /// Three numbers of corners for each triangle, leaf by leaf; kCentre + k is the centre of the k-th leaf that has
    /// one.
    static constexpr std::uint32_t kCentre = std::uint32_t{1} << 31;
    std::span<const std::uint32_t> triangles() const { return triangles_; }
    bool hasCentres() const { return centres_ > 0; }

private:
    void addSmall(const LeafCell& leaf, const LeavesAround& around);
    void addLarger(const LeafCell& leaf, const LeavesAround& around);
    void finishLeaf(const LeafCell& leaf, std::size_t firstCorner, std::size_t firstTriangle);

    SmallLeafPolygons smallPolygons_;
    MergedPolygon<LeavesAround> polygon_;
    std::vector<MergedLeaf> leaves_;
    std::vector<Corner> corners_;
    std::vector<std::uint32_t> triangles_;
    std::uint32_t centres_ = 0;
};

} // namespace isoslider::extract
