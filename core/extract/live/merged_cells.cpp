#include "core/extract/live/merged_cells.h"

#include <algorithm>

namespace isoslider::extract {
namespace {

// Edges of the given cells.
void edgesOfCells(const BitString& cells, std::array<BitString, 3>& edges) {
    BitString acrossX, acrossY, acrossZ; // the cells and their neighbours' places a step up
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

bool hasBothSigns(const LeafCell& leaf, const BitString& above) {
    int count = 0;
    for (int c = 0; c < 8; ++c)
        count +=
            above.test(closedPoint(leaf.origin[0] + leaf.side() * (c & 1), leaf.origin[1] + leaf.side() * (c >> 1 & 1),
                                   leaf.origin[2] + leaf.side() * (c >> 2)));
    return count != 0 && count != 8;
}

} // namespace

void MergedCells::clear() {
    leaves_.clear();
    corners_.clear();
    triangles_.clear();
    centres_ = 0;
}

void MergedCells::find(const BrickLeaves& leaves, const LeavesAround& around, const BitString& above,
                       ActiveBits& active) {
    clear();
    MergedPolygon polygon(around);
    BitString merged;
    for (int z = 0; z < kCellSide; z += 2)
        for (int y = 0; y < kCellSide; y += 2)
            for (int x = 0; x < kCellSide; x += 2) {
                const LeafCell leaf{{x, y, z}, leaves.levelOf(x, y, z)};
                if (leaf.level == 0)
                    continue;
                for (int k = 0; k < 8; ++k)
                    merged.set(closedPoint(x + (k & 1), y + (k >> 1 & 1), z + (k >> 2)));
                const int inside = leaf.side() - 1;
                if (((x | y | z) & inside) != 0 || !hasBothSigns(leaf, above))
                    continue;
                polygon.make(leaf);
                add(leaf, around, polygon);
            }
    for (std::size_t w = 0; w < kBitWords; ++w)
        active.cells.words[w] &= ~merged.words[w];
    std::array<BitString, 3> vertices;
    edgesOfCells(active.cells, vertices);
    for (std::size_t a = 0; a < 3; ++a)
        for (std::size_t w = 0; w < kBitWords; ++w)
            active.edges[a].words[w] &= vertices[a].words[w];
    for (const Corner& corner : corners_)
        active.edges[static_cast<std::size_t>(axisOf(corner.edge))].set(startOf(corner.edge));
}

void MergedCells::add(const LeafCell& leaf, const LeavesAround& around, const MergedPolygon<LeavesAround>& polygon) {
    const auto first = static_cast<std::uint32_t>(corners_.size());
    for (const GridEdge& edge : polygon.corners())
        corners_.push_back({closedEdge(edge.axis, closedPoint(edge.start[0], edge.start[1], edge.start[2])),
                            static_cast<std::uint16_t>(smallestLevelAt(around, edge))});
    const std::size_t before = triangles_.size();
    for (const auto& triangle : polygon.triangles())
        for (const std::uint32_t corner : triangle)
            triangles_.push_back(first + corner);
    const bool hasCentre = polygon.triangles().empty();
    if (hasCentre) {
        const auto count = static_cast<std::uint32_t>(polygon.corners().size());
        for (std::uint32_t i = 0; i < count; ++i)
            triangles_.insert(triangles_.end(), {first + i, first + (i + 1) % count, kCentre + centres_});
        ++centres_;
    }
    leaves_.push_back({closedPoint(leaf.origin[0], leaf.origin[1], leaf.origin[2]),
                       static_cast<std::uint8_t>(leaf.level), hasCentre,
                       static_cast<std::uint16_t>(triangles_.size() - before)});
}

} // namespace isoslider::extract
