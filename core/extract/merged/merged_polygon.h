#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/cell/cell_numbering.h"
#include "core/cell/cell_states.h"
#include "core/extract/merged/polygon_triangles.h"

namespace isoslider::extract {

/// A grid point or the cell that starts there. x, y, z.
using GridPlace = std::array<std::int32_t, 3>;

/// A cell of side 2^level, aligned at multiples of its side.
struct LeafCell {
    GridPlace origin{};
    int level = 0;
    std::int32_t side() const { return std::int32_t{1} << level; }
};

/// An active edge of the grid: the name of the one vertex on the leaf edges that contain it.
struct GridEdge {
    GridPlace start{};
    int axis = 0;
};

/// The level that stands for "no cell is there".
inline constexpr int kNoLevel = -1;

/// The lower end of the leaf edge of a level that contains an edge.
inline GridPlace leafEdgeStart(const GridEdge& edge, int level) {
    GridPlace lower = edge.start;
    std::int32_t& along = lower[static_cast<std::size_t>(edge.axis)];
    along &= ~((std::int32_t{1} << level) - 1);
    return lower;
}

/// Of the leaf edges that contain an active edge, the smallest's level: that one carries the vertex. `leaves` has
/// levelAt(place), the level of the leaf that holds a cell of the grid, kNoLevel outside the box.
/// PAPER 2.2: the smallest edge carries the vertex, so that all cells around agree on it.
template <class Leaves>
int smallestLevelAt(const Leaves& leaves, const GridEdge& edge) {
    const auto u = static_cast<std::size_t>((edge.axis + 1) % 3), v = static_cast<std::size_t>((edge.axis + 2) % 3);
    // A leaf beside has the edge on one of its own, not within a face, if both coordinates are multiples of its side.
    const int largest = std::countr_zero(static_cast<std::uint32_t>(edge.start[u] | edge.start[v]));
    int smallest = largest;
    for (int k = 0; k < 4; ++k) {
        GridPlace cell = edge.start;
        cell[u] -= k & 1;
        cell[v] -= k >> 1;
        if (const int level = leaves.levelAt(cell); level != kNoLevel && level < smallest)
            smallest = level;
    }
    return smallest;
}

/// The polygon of the surface in a merged cell, and its triangles. It depends on signs and levels only, so it lasts
/// until the isovalue crosses a sample of the cell or of a cell beside it.
///
/// The polygon follows, on each face, the segments of the finest leaves on either side. Where all cells beside are at
/// least as large it is the polygon of a cell of the grid, with the same triangles; else the triangulation of least
/// area, its corners taken at the middles of their active edges. PAPER 2.2, Figs. 6 and 7.
///
/// `Leaves` has levelAt(place), see smallestLevelAt(), and isAboveAt(place).
template <class Leaves>
class MergedPolygon {
public:
    /// REQUIRES: a leaf of level 1 to 5 whose corners differ in sign. O(k^3) for k corners.
    void make(const Leaves& leaves, const LeafCell& leaf) {
        leaves_ = &leaves;
        leaf_ = leaf;
        edges_.clear();
        triangles_.clear();
        std::uint8_t signs = 0;
        for (int c = 0; c < 8; ++c)
            signs |= static_cast<std::uint8_t>(leaves_->isAboveAt(cornerOf(c)) << c);
        if (hasFinerNeighbour(signs))
            followFinestSegments();
        else
            takeCellState(signs);
    }
    /// The active edges of the polygon's corners.
    std::span<const GridEdge> corners() const { return edges_; }
    /// Three corner numbers each. Empty: the polygon, whose corners are in order then, is to be spanned from a vertex
    /// inside.
    std::span<const std::array<std::uint32_t, 3>> triangles() const { return triangles_; }

private:
    // An edge by its place in the leaf, ascending along z, y, x, axis.
    using EdgeKey = std::uint32_t;
    static constexpr unsigned kPlaceBits = 6;

    EdgeKey keyOf(const GridPlace& start, std::size_t axis) const {
        EdgeKey key = 0;
        for (std::size_t a = 3; a-- > 0;)
            key = key << kPlaceBits | static_cast<EdgeKey>(start[a] - leaf_.origin[a]);
        return key << 2 | static_cast<EdgeKey>(axis);
    }
    std::int32_t inLeaf(EdgeKey key, std::size_t axis) const {
        return static_cast<std::int32_t>(key >> (2 + kPlaceBits * axis) & ((1u << kPlaceBits) - 1));
    }
    GridPlace cornerOf(int corner) const {
        return {leaf_.origin[0] + leaf_.side() * (corner & 1), leaf_.origin[1] + leaf_.side() * (corner >> 1 & 1),
                leaf_.origin[2] + leaf_.side() * (corner >> 2)};
    }

    // A leaf beside a face either covers it or is smaller, as all others beside this face are then. A face whose
    // corners have one sign is not crossed (keepsTopology()).
    bool hasFinerNeighbour(std::uint8_t signs) const {
        for (std::size_t face = 0; face < 6; ++face) {
            const auto& c = cell::kFaceCorners[face];
            const unsigned above =
                (signs >> c[0] & 1u) + (signs >> c[1] & 1u) + (signs >> c[2] & 1u) + (signs >> c[3] & 1u);
            if (above == 0 || above == 4)
                continue;
            GridPlace across = leaf_.origin;
            across[face / 2] += face % 2 == 0 ? -1 : leaf_.side();
            if (const int level = leaves_->levelAt(across); level != kNoLevel && level < leaf_.level)
                return true;
        }
        return false;
    }

    void takeCellState(std::uint8_t signs) {
        const CellPolygon& loop = cellPolygons()[signs];
        for (std::size_t i = 0; i < loop.edgeCount; ++i) {
            const cell::CellEdge& edge = cell::kCellEdges[loop.edges[i]];
            edges_.push_back(
                edgeOf(activeEdgeBetween(cornerOf(edge.lowerCorner), cornerOf(edge.upperCorner), edge.axis)));
        }
        triangles_.assign(loop.triangles.begin(), loop.triangles.begin() + loop.triangleCount);
    }

    void followFinestSegments() {
        segments_.clear();
        for (std::size_t axis = 0; axis < 3; ++axis)
            for (const bool isUpper : {false, true}) {
                GridPlace corner = leaf_.origin;
                corner[axis] += isUpper ? leaf_.side() : 0;
                addSegments(corner, leaf_.level, axis, isUpper);
            }
        std::sort(segments_.begin(), segments_.end());
        // One loop: see keepsTopology().
        corners_.clear();
        EdgeKey at = segments_.front().first;
        do {
            corners_.push_back(polygonCorner(at));
            edges_.push_back(edgeOf(at));
            const auto next = std::lower_bound(segments_.begin(), segments_.end(), std::pair(at, EdgeKey{0}));
            if (next == segments_.end() || next->first != at)
                break;
            at = next->second;
        } while (at != segments_.front().first && corners_.size() <= segments_.size());
        triangulatePolygon(corners_, triangles_);
    }

    // The segments of the finest leaves in a square of a face, whose first corner is `corner` and whose side is
    // 2^level.
    void addSegments(const GridPlace& corner, int level, std::size_t axis, bool isUpper) {
        const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
        // Round the square, counter-clockwise seen from outside.
        const std::int32_t side = std::int32_t{1} << level;
        const std::size_t first = isUpper ? u : v, second = isUpper ? v : u;
        std::array<GridPlace, 4> round{corner, corner, corner, corner};
        round[1][first] += side;
        round[2][u] += side;
        round[2][v] += side;
        round[3][second] += side;
        std::array<bool, 4> isAbove{};
        std::transform(round.begin(), round.end(), isAbove.begin(),
                       [&](const GridPlace& p) { return leaves_->isAboveAt(p); });
        if (isAbove[0] == isAbove[1] && isAbove[0] == isAbove[2] && isAbove[0] == isAbove[3])
            return; // nor are its parts crossed: keepsTopology()
        GridPlace across = corner;
        across[axis] -= isUpper ? 0 : 1;
        if (const int beside = leaves_->levelAt(across); beside != kNoLevel && beside < level) {
            const std::int32_t half = side / 2;
            for (int quarter = 0; quarter < 4; ++quarter) {
                GridPlace part = corner;
                part[u] += quarter & 1 ? half : 0;
                part[v] += quarter & 2 ? half : 0;
                addSegments(part, level - 1, axis, isUpper);
            }
            return;
        }
        // Out of what is above, and back in.
        EdgeKey leaving = 0, entering = 0;
        for (std::size_t i = 0; i < 4; ++i)
            if (const std::size_t to = (i + 1) % 4; isAbove[i] != isAbove[to])
                (isAbove[i] ? leaving : entering) = activeEdgeBetween(round[i], round[to], i % 2 == 0 ? first : second);
        segments_.emplace_back(entering, leaving);
    }

    // The one active edge on a leaf edge, between points that differ in sign.
    EdgeKey activeEdgeBetween(GridPlace a, GridPlace b, std::size_t axis) const {
        if (a[axis] > b[axis])
            std::swap(a, b);
        const bool isLowerAbove = leaves_->isAboveAt(a);
        while (b[axis] - a[axis] > 1) {
            GridPlace middle = a;
            middle[axis] = (a[axis] + b[axis]) / 2;
            (leaves_->isAboveAt(middle) == isLowerAbove ? a : b) = middle;
        }
        return keyOf(a, axis);
    }

    GridEdge edgeOf(EdgeKey key) const {
        return {{leaf_.origin[0] + inLeaf(key, 0), leaf_.origin[1] + inLeaf(key, 1), leaf_.origin[2] + inLeaf(key, 2)},
                static_cast<int>(key & 3)};
    }
    PolygonCorner polygonCorner(EdgeKey key) const {
        const std::size_t axis = key & 3;
        PolygonCorner corner;
        for (std::size_t a = 0; a < 3; ++a) {
            const std::int32_t place = inLeaf(key, a);
            corner.position[static_cast<int>(a)] = static_cast<float>(place) + (a == axis ? 0.5f : 0.0f);
            if (a != axis && (place == 0 || place == leaf_.side()))
                corner.faces |= static_cast<std::uint8_t>(1u << (2 * a + (place == 0 ? 0 : 1)));
        }
        return corner;
    }

    const Leaves* leaves_ = nullptr; ///< in make()
    LeafCell leaf_;
    std::vector<std::pair<EdgeKey, EdgeKey>>
        segments_; ///< from where the surface's inside is entered to where it is left
    std::vector<PolygonCorner> corners_;
    std::vector<GridEdge> edges_;
    std::vector<std::array<std::uint32_t, 3>> triangles_;
};

} // namespace isoslider::extract
