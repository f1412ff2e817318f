#include "core/extract/live/merged_cells.h"

#include <bit>
#include <cstddef>
#include <utility>

namespace isoslider::extract {
namespace {

// Takes the cells of side 2 given by bits x + 4 y + 16 z out of a string of cells; returns which had some in it.
std::uint64_t takeOut(std::uint64_t squares, BitString& cells) {
    std::array<std::uint64_t, 16> any{};
    changeRows(squares, cells, [&](std::uint64_t& word, std::uint64_t mask, int shift, int row) {
        const std::uint64_t taken = word & mask << shift;
        any[static_cast<std::size_t>(row)] |= taken >> shift;
        word ^= taken;
    });
    std::uint64_t found = 0;
    for (int row = 0; row < 16; ++row) {
        std::uint64_t eight = any[static_cast<std::size_t>(row)];
        eight |= eight >> 1;
        found |= ((eight & 1) | (eight >> 1 & 2) | (eight >> 2 & 4) | (eight >> 3 & 8)) << (4 * row);
    }
    return found;
}

std::uint64_t takeOutAll(BitString& cells) {
    std::uint64_t any = 0;
    for (std::uint64_t& word : cells.words)
        any |= std::exchange(word, 0);
    return any != 0 ? 1 : 0;
}

// First cells of side 2 of the cells of side 4.
std::uint64_t firstOfHalves(std::uint8_t halves) {
    std::uint64_t first = 0;
    for (unsigned i = 0; i < 8; ++i)
        first |= std::uint64_t{halves >> i & 1u} << (2 * (i & 1) + 8 * (i >> 1 & 1) + 32 * (i >> 2));
    return first;
}

} // namespace

BrickLeaves crossedLeaves(const BrickLeaves& leaves, const BitString& cells) {
    BitString rest = cells;
    BrickLeaves crossed;
    crossed.level1 = takeOut(leaves.level1, rest);
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
    leaves_.clear();
    corners_.clear();
    triangles_.clear();
    centres_ = 0;
}

void MergedCells::find(const BrickLeaves& leaves, const LeavesAround& around, ActiveBits& active) {
    clear();
    std::uint64_t crossed = leaves.level3 ? takeOutAll(active.cells) : takeOut(leaves.level1, active.cells);
    // Of each leaf its first cell of side 2: their order is that of the leaves.
    constexpr std::uint64_t kParts = 0x330033;
    for (std::uint64_t first = firstOfHalves(leaves.level2); first != 0; first &= first - 1) {
        const int i = std::countr_zero(first);
        if ((crossed & kParts << i) != 0)
            crossed = (crossed & ~(kParts << i)) | std::uint64_t{1} << i;
    }
    for (; crossed != 0; crossed &= crossed - 1) {
        const int i = std::countr_zero(crossed), x = 2 * (i % 4), y = 2 * (i / 4 % 4), z = 2 * (i / 16);
        const std::int64_t first = closedPoint(x, y, z).number();
        const LeafCell leaf{first, LeavesAround::cellAt(first), leaves.levelOf(x, y, z)};
        if (leaf.level == 1)
            addSmall(leaf, around);
        else
            addLarger(leaf, around);
    }
    std::array<BitString, 3> vertices;
    edgesOfCells(active.cells, vertices);
    for (std::size_t a = 0; a < 3; ++a)
        for (std::size_t w = 0; w < kBitWords; ++w)
            active.edges[a].words[w] &= vertices[a].words[w];
    for (const Corner& corner : corners_)
        active.edges[static_cast<std::size_t>(axisOf(corner.edge))].set(startOf(corner.edge));
}

void MergedCells::set(const OneLeaf& leaf) {
    clear();
    const CellPolygon& polygon = cellPolygons()[leaf.signs];
    for (std::size_t i = 0; i < polygon.edgeCount; ++i)
        corners_.push_back({leaf.activeEdge(polygon.edges[i]), kMaxBrickMergeLevel});
    for (std::size_t i = 0; i < polygon.triangleCount; ++i)
        triangles_.insert(triangles_.end(), polygon.triangles[i].begin(), polygon.triangles[i].end());
    finishLeaf({0, 0, kMaxBrickMergeLevel}, 0, 0);
}

void MergedCells::addSmall(const LeafCell& leaf, const LeavesAround& around) {
    const SmallLeafPolygons::Polygon& polygon = smallPolygons_.find(around, leaf);
    const std::size_t firstCorner = corners_.size(), firstTriangle = triangles_.size();
    corners_.resize(firstCorner + polygon.cornerCount);
    for (std::size_t i = 0; i < polygon.cornerCount; ++i) {
        const std::uint16_t edge = polygon.edges[i];
        const int place = edge & SmallLeafPolygons::kEdgeMask;
        corners_[firstCorner + i] = {closedEdge(place & 3, ClosedPoint(static_cast<int>(leaf.point) + (place >> 2))),
                                     static_cast<std::uint16_t>(SmallLeafPolygons::levelOf(edge, around, leaf))};
    }
    triangles_.resize(firstTriangle + 3 * std::size_t{polygon.triangleCount});
    for (std::size_t i = 0; i < polygon.triangleCount; ++i)
        for (std::size_t k = 0; k < 3; ++k)
            triangles_[firstTriangle + 3 * i + k] = static_cast<std::uint32_t>(firstCorner) + polygon.triangles[i][k];
    finishLeaf(leaf, firstCorner, firstTriangle);
}

void MergedCells::addLarger(const LeafCell& leaf, const LeavesAround& around) {
    polygon_.make(around, leaf);
    const std::size_t firstCorner = corners_.size(), firstTriangle = triangles_.size();
    for (const std::int64_t edge : polygon_.corners())
        corners_.push_back({closedEdge(static_cast<int>(edge & 3), ClosedPoint(static_cast<int>(edge >> 2))),
                            static_cast<std::uint16_t>(smallestLevelAt(around, edge))});
    for (const auto& triangle : polygon_.triangles())
        for (const std::uint32_t corner : triangle)
            triangles_.push_back(static_cast<std::uint32_t>(firstCorner) + corner);
    finishLeaf(leaf, firstCorner, firstTriangle);
}

// A polygon without triangles gets those to its centre.
void MergedCells::finishLeaf(const LeafCell& leaf, std::size_t firstCorner, std::size_t firstTriangle) {
    const bool hasCentre = triangles_.size() == firstTriangle;
    if (hasCentre) {
        const auto first = static_cast<std::uint32_t>(firstCorner),
                   count = static_cast<std::uint32_t>(corners_.size() - firstCorner);
        for (std::uint32_t i = 0; i < count; ++i)
            triangles_.insert(triangles_.end(), {first + i, first + (i + 1) % count, kCentre + centres_});
        ++centres_;
    }
    leaves_.push_back({ClosedPoint(static_cast<int>(leaf.point)), static_cast<std::uint8_t>(leaf.level), hasCentre,
                       static_cast<std::uint16_t>(triangles_.size() - firstTriangle)});
}

} // namespace isoslider::extract
