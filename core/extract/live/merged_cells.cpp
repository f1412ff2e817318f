#include "core/extract/live/merged_cells.h"

#include <bit>
#include <cstddef>

#include "core/extract/live/pair_cells.h"

namespace isoslider::extract {
namespace {

// First cells of side 2 of the cells of side 4.
std::uint64_t firstOfHalves(std::uint8_t halves) {
    std::uint64_t first = 0;
    for (unsigned i = 0; i < 8; ++i)
        first |= std::uint64_t{halves >> i & 1u} << (2 * (i & 1) + 8 * (i >> 1 & 1) + 32 * (i >> 2));
    return first;
}

} // namespace

BrickLeaves crossedLeaves(const BrickLeaves& leaves, const BitString& cells) {
    BrickLeaves crossed;
    crossed.level1 = leaves.level1 & anyOfEight(cells);
    if (leaves.level3)
        return {0, 0, crossed.level1 != 0};
    for (unsigned i = 0; i < 8; ++i) {
        const std::uint64_t halves = leafBits(2, i).level1;
        if (!(leaves.level2 >> i & 1) || (crossed.level1 & halves) == 0)
            continue;
        crossed.level1 &= ~halves;
        crossed.level2 = static_cast<std::uint8_t>(crossed.level2 | 1u << i);
    }
    return crossed;
}

void MergedCells::clear() {
    leafCount_ = cornerCount_ = triangleCorners_ = 0;
    centres_ = 0;
}

void MergedCells::find(const BrickLeaves& leaves, const LeavesAround& around, ActiveBits& active) {
    clear();
    // Of each leaf its first cell of side 2: their order is that of the leaves.
    std::uint64_t small = leaves.level1, firsts = 1;
    if (leaves.level3) {
        small = 0;
    } else {
        for (unsigned open = leaves.level2; open != 0; open &= open - 1)
            small &= ~pairsOfFour(static_cast<unsigned>(std::countr_zero(open)));
        firsts = small | firstOfHalves(leaves.level2);
    }
    const BitString merged = cellsOfPairs(leaves.level1);
    for (std::size_t w = 0; w < kBitWords; ++w)
        active.cells.words[w] &= ~merged.words[w];
    // Small ones in two rounds: where the table of polygons is too large for the cache, their places come meanwhile.
    std::array<SmallLeafPolygons::Leaf, kMostLeaves> smallLeaves;
    std::size_t count = 0;
    for (std::uint64_t rest = small; rest != 0; rest &= rest - 1) {
        const int i = std::countr_zero(rest);
        smallLeaves[count++] = SmallLeafPolygons::leafAt(around, i % 4, i / 4 % 4, i / 16);
    }
    count = 0;
    for (; firsts != 0; firsts &= firsts - 1) {
        const int i = std::countr_zero(firsts);
        if (small >> i & 1) {
            addSmall(smallLeaves[count++], around);
        } else {
            const std::int64_t first = closedPoint(2 * (i % 4), 2 * (i / 4 % 4), 2 * (i / 16)).number();
            addLarger({first, LeavesAround::cellAt(first), leaves.level3 ? 3 : 2}, around);
        }
    }
    std::array<BitString, 3> vertices;
    edgesOfCells(active.cells, vertices);
    for (std::size_t a = 0; a < 3; ++a)
        for (std::size_t w = 0; w < kBitWords; ++w)
            active.edges[a].words[w] &= vertices[a].words[w];
    for (const Corner& corner : corners())
        active.edges[static_cast<std::size_t>(axisOf(corner.edge))].set(startOf(corner.edge));
}

void MergedCells::set(const OneLeaf& leaf) {
    clear();
    const CellPolygon& polygon = cellPolygons()[leaf.signs];
    for (std::size_t i = 0; i < polygon.edgeCount; ++i)
        corners_[cornerCount_++] = {leaf.activeEdge(polygon.edges[i]), kMaxBrickMergeLevel};
    for (std::size_t i = 0; i < polygon.triangleCount; ++i)
        for (const std::uint32_t corner : polygon.triangles[i])
            triangles_[triangleCorners_++] = static_cast<std::uint16_t>(corner);
    finishLeaf(ClosedPoint(0), kMaxBrickMergeLevel, 0, 0);
}

void MergedCells::addSmall(const SmallLeafPolygons::Leaf& leaf, const LeavesAround& around) {
    const SmallLeafPolygons::Polygon polygon = smallPolygons_.find(around, leaf);
    const std::size_t firstCorner = cornerCount_, firstTriangle = triangleCorners_;
    for (const std::uint8_t edge : polygon.edges)
        corners_[cornerCount_++] = {SmallLeafPolygons::edgeOf(edge, leaf),
                                    static_cast<std::uint16_t>(SmallLeafPolygons::levelOf(edge, leaf))};
    for (const std::uint8_t corner : polygon.triangles)
        triangles_[triangleCorners_++] = static_cast<std::uint16_t>(firstCorner + corner);
    finishLeaf(leaf.point, 1, firstCorner, firstTriangle);
}

void MergedCells::addLarger(const LeafCell& leaf, const LeavesAround& around) {
    polygon_.make(around, leaf);
    const std::size_t firstCorner = cornerCount_, firstTriangle = triangleCorners_;
    for (const std::int64_t edge : polygon_.corners())
        corners_[cornerCount_++] = {closedEdge(static_cast<int>(edge & 3), ClosedPoint(static_cast<int>(edge >> 2))),
                                    static_cast<std::uint16_t>(smallestLevelAt(around, edge))};
    for (const auto& triangle : polygon_.triangles())
        for (const std::uint32_t corner : triangle)
            triangles_[triangleCorners_++] = static_cast<std::uint16_t>(firstCorner + corner);
    finishLeaf(ClosedPoint(static_cast<int>(leaf.point)), leaf.level, firstCorner, firstTriangle);
}

// A polygon without triangles gets those to its centre.
void MergedCells::finishLeaf(ClosedPoint cell, int level, std::size_t firstCorner, std::size_t firstTriangle) {
    const bool hasCentre = triangleCorners_ == firstTriangle;
    if (hasCentre) {
        const std::size_t count = cornerCount_ - firstCorner;
        for (std::size_t i = 0; i < count; ++i) {
            triangles_[triangleCorners_++] = static_cast<std::uint16_t>(firstCorner + i);
            triangles_[triangleCorners_++] = static_cast<std::uint16_t>(firstCorner + (i + 1) % count);
            triangles_[triangleCorners_++] = static_cast<std::uint16_t>(kCentre + centres_);
        }
        ++centres_;
    }
    leaves_[leafCount_++] = {cell, static_cast<std::uint8_t>(level), hasCentre,
                             static_cast<std::uint16_t>(triangleCorners_ - firstTriangle)};
}

} // namespace isoslider::extract
