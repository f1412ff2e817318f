#pragma once

#include <array>
#include <cstdint>
#include <span>

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
    /// Finds the polygons of the leaves, all of which the surface passes through. Leaves in `active` what else there
    /// is: the active cells that are not merged, and the edges that have a vertex.
    void find(const BrickLeaves& leaves, const LeavesAround& around, ActiveBits& active);
    /// Of a brick that is one leaf and isAloneAsOneLeaf().
    void set(const OneLeaf& leaf);

    /// In the order of their cells.
    std::span<const MergedLeaf> leaves() const { return {leaves_.data(), leafCount_}; }
    /// Of the polygons. Each edge may be there several times.
    std::span<const Corner> corners() const { return {corners_.data(), cornerCount_}; }
    /// Three numbers of corners for each triangle, leaf by leaf; kCentre + k is the centre of the k-th leaf that has
    /// one.
    static constexpr std::uint16_t kCentre = 1u << 15;
    std::span<const std::uint16_t> triangles() const { return {triangles_.data(), triangleCorners_}; }
    bool hasCentres() const { return centres_ > 0; }

    /// A face square has one segment at most, and leaves of side 2 have the most squares; a segment is a corner.
    static constexpr std::size_t kMostLeaves = 64, kMostCorners = kMostLeaves * 24;

private:
    void addSmall(const SmallLeafPolygons::Leaf& leaf, const LeavesAround& around);
    void addLarger(const LeafCell& leaf, const LeavesAround& around);
    void finishLeaf(ClosedPoint cell, int level, std::size_t firstCorner, std::size_t firstTriangle);

    SmallLeafPolygons smallPolygons_;
    MergedPolygon<LeavesAround> polygon_;
    std::array<MergedLeaf, kMostLeaves> leaves_;
    std::array<Corner, kMostCorners> corners_;
    std::array<std::uint16_t, 3 * kMostCorners> triangles_;
    std::size_t leafCount_ = 0, cornerCount_ = 0, triangleCorners_ = 0;
    std::uint16_t centres_ = 0;
};

} // namespace isoslider::extract
