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
#include "core/extract/merged/polygon_triangles.h"

namespace isoslider::extract {

// Points, cells and edges are numbered by whoever has the leaves, so that a step along an axis is an addition:
//
//  std::int64_t pointStride(axis), cellStride(axis)
//  std::array<std::int32_t, 3> coordsOf(point)   multiples of a leaf's side where leaves of that size may begin
//  std::int64_t cellAt(point)                    the cell that starts there
//  bool isAboveAt(point)
//  int levelAt(cell)                             of the leaf that holds it; kNoLevel one step outside the box
//
// Points ascend along z, y, x. An edge of the grid is 4 * its lower point + its axis: the name of the vertex on the
// leaf edges that contain it, while it is active.

/// The level that stands for "no cell is there".
inline constexpr int kNoLevel = -1;

/// By face, lower and upper along x, y, z: which of a cell's corners are on it.
inline constexpr std::array<std::uint8_t, 6> kCornersOfFaces{0x55, 0xaa, 0x33, 0xcc, 0x0f, 0xf0};
/// Whether the corners of a face differ.
constexpr bool isFaceCrossed(unsigned signs, std::size_t face) {
    const unsigned above = signs & kCornersOfFaces[face];
    return above != 0 && above != kCornersOfFaces[face];
}

/// A cell of side 2^level, aligned at multiples of its side.
struct LeafCell {
    std::int64_t point = 0, cell = 0; ///< its first
    int level = 0;
    std::int64_t side() const { return std::int64_t{1} << level; }
};

/// Of the leaf edges that contain an active edge, the smallest's level: that one carries the vertex.
/// PAPER 2.2: the smallest edge carries the vertex, so that all cells around agree on it.
template <class Leaves>
int smallestLevelAt(const Leaves& leaves, std::int64_t edge) {
    const auto axis = static_cast<std::size_t>(edge & 3), u = (axis + 1) % 3, v = (axis + 2) % 3;
    const auto start = leaves.coordsOf(edge >> 2);
    // A leaf beside has the edge on one of its own, not within a face, if both coordinates are multiples of its side.
    int smallest = std::countr_zero(static_cast<std::uint32_t>(start[u] | start[v]));
    const std::int64_t cell = leaves.cellAt(edge >> 2);
    for (const std::int64_t beside : {cell, cell - leaves.cellStride(u), cell - leaves.cellStride(v),
                                      cell - leaves.cellStride(u) - leaves.cellStride(v)})
        if (const int level = leaves.levelAt(beside); level != kNoLevel && level < smallest)
            smallest = level;
    return smallest;
}

/// The lower end of the leaf edge of a level that contains an edge.
template <class Leaves>
std::int64_t leafEdgeStart(const Leaves& leaves, std::int64_t edge, int level) {
    const auto axis = static_cast<std::size_t>(edge & 3);
    const std::int64_t inside = leaves.coordsOf(edge >> 2)[axis] & ((std::int64_t{1} << level) - 1);
    return (edge >> 2) - inside * leaves.pointStride(axis);
}

/// The polygon of the surface in a merged cell, and its triangles. It depends on signs and levels only, so it lasts
/// until the isovalue crosses a sample of the cell or of a cell beside it.
///
/// The polygon follows, on each face, the segments of the finest leaves on either side. Where all cells beside are at
/// least as large it is the polygon of a cell of the grid, with the same triangles; else the triangulation of least
/// area, its corners taken at the middles of their active edges. PAPER 2.2, Figs. 6 and 7.
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
            followFinestSegments(signs);
        else
            takeCellState(signs);
    }
    /// The active edges of the polygon's corners.
    std::span<const std::int64_t> corners() const { return edges_; }
    /// Three corner numbers each. Empty: the polygon, whose corners are in order then, is to be spanned from a vertex
    /// inside.
    std::span<const std::array<std::uint32_t, 3>> triangles() const { return triangles_; }

private:
    std::int64_t cornerOf(int corner) const {
        std::int64_t point = leaf_.point;
        for (std::size_t a = 0; a < 3; ++a)
            point += corner >> a & 1 ? leaf_.side() * leaves_->pointStride(a) : 0;
        return point;
    }
    std::int64_t cellAcross(std::size_t axis, bool isUpper) const {
        return leaf_.cell + (isUpper ? leaf_.side() : -1) * leaves_->cellStride(axis);
    }

    // A leaf beside a face either covers it or is smaller, as all others beside this face are then. A face whose
    // corners have one sign is not crossed (keepsTopology()).
    bool hasFinerNeighbour(std::uint8_t signs) const {
        for (std::size_t face = 0; face < 6; ++face) {
            if (!isFaceCrossed(signs, face))
                continue;
            if (const int level = leaves_->levelAt(cellAcross(face / 2, face % 2 == 1));
                level != kNoLevel && level < leaf_.level)
                return true;
        }
        return false;
    }

    void takeCellState(std::uint8_t signs) {
        const CellPolygon& polygon = cellPolygons()[signs];
        for (std::size_t i = 0; i < polygon.edgeCount; ++i) {
            const cell::CellEdge& edge = cell::kCellEdges[polygon.edges[i]];
            edges_.push_back(activeEdgeFrom(cornerOf(edge.lowerCorner), edge.axis, leaf_.side()));
        }
        triangles_.assign(polygon.triangles.begin(), polygon.triangles.begin() + polygon.triangleCount);
    }

    void followFinestSegments(std::uint8_t signs) {
        segments_.clear();
        for (std::size_t face = 0; face < 6; ++face) {
            if (!isFaceCrossed(signs, face))
                continue;
            const std::size_t axis = face / 2;
            const bool isUpper = face % 2 == 1;
            const Face along(*leaves_, axis, isUpper);
            const unsigned first = isUpper ? 1u << axis : 0, u = 1u << along.axes[0], v = 1u << along.axes[1];
            const auto isAbove = [signs](unsigned corner) { return (signs >> corner & 1) != 0; };
            addSegments(along, cornerOf(static_cast<int>(first)), cellAcross(axis, isUpper), leaf_.level,
                        {isAbove(first), isAbove(first | u), isAbove(first | u | v), isAbove(first | v)});
        }
        // One loop, see keepsTopology(): brought into its order from the least edge on. There are few.
        std::swap(segments_.front(), *std::min_element(segments_.begin(), segments_.end()));
        corners_.clear();
        const auto origin = leaves_->coordsOf(leaf_.point);
        for (std::size_t i = 0; i < segments_.size(); ++i) {
            edges_.push_back(segments_[i].first);
            corners_.push_back(polygonCorner(segments_[i].first, origin));
            for (std::size_t k = i + 1; k < segments_.size(); ++k)
                if (segments_[k].first == segments_[i].second) {
                    std::swap(segments_[i + 1], segments_[k]);
                    break;
                }
        }
        triangulation_.make(corners_, triangles_);
    }

    /// The two axes of a face, so that the first turns to the second counter-clockwise, seen from outside.
    struct Face {
        Face(const Leaves& leaves, std::size_t axis, bool isUpper) {
            const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
            axes = isUpper ? std::array{u, v} : std::array{v, u};
            for (std::size_t k = 0; k < 2; ++k) {
                pointStride[k] = leaves.pointStride(axes[k]);
                cellStride[k] = leaves.cellStride(axes[k]);
            }
        }
        std::array<std::size_t, 2> axes;
        std::array<std::int64_t, 2> pointStride, cellStride;
    };

    /// Signs of a square's corners: the first, along the first axis, along both, along the second.
    using SquareSigns = std::array<bool, 4>;

    // The segments of the finest leaves in a square of a face: its first point, the cell on the other side there, and
    // its side, 2^level. Their order does not matter. An uncrossed square has no crossed parts: keepsTopology().
    void addSegments(const Face& face, std::int64_t corner, std::int64_t across, int level,
                     const SquareSigns& isAbove) {
        const auto [first, second, third, fourth] = isAbove;
        if (first == second && first == third && first == fourth)
            return;
        const std::int64_t alongFirst = face.pointStride[0] << level, alongSecond = face.pointStride[1] << level;
        if (const int beside = level > 0 ? leaves_->levelAt(across) : kNoLevel; beside != kNoLevel && beside < level) {
            const std::int64_t halfFirst = alongFirst / 2, halfSecond = alongSecond / 2,
                               cellsFirst = face.cellStride[0] << (level - 1),
                               cellsSecond = face.cellStride[1] << (level - 1);
            const bool front = leaves_->isAboveAt(corner + halfFirst),
                       right = leaves_->isAboveAt(corner + alongFirst + halfSecond),
                       back = leaves_->isAboveAt(corner + halfFirst + alongSecond),
                       left = leaves_->isAboveAt(corner + halfSecond),
                       middle = leaves_->isAboveAt(corner + halfFirst + halfSecond);
            addSegments(face, corner, across, level - 1, {first, front, middle, left});
            addSegments(face, corner + halfFirst, across + cellsFirst, level - 1, {front, second, right, middle});
            addSegments(face, corner + halfSecond, across + cellsSecond, level - 1, {left, middle, back, fourth});
            addSegments(face, corner + halfFirst + halfSecond, across + cellsFirst + cellsSecond, level - 1,
                        {middle, right, third, back});
            return;
        }
        // Out of what is above, and back in.
        const std::array<std::int64_t, 4> lower{corner, corner + alongFirst, corner + alongSecond, corner};
        std::int64_t leaving = 0, entering = 0;
        for (std::size_t i = 0; i < 4; ++i)
            if (isAbove[i] != isAbove[(i + 1) % 4])
                (isAbove[i] ? leaving : entering) =
                    activeEdgeFrom(lower[i], face.axes[i % 2], std::int64_t{1} << level);
        segments_.emplace_back(entering, leaving);
    }

    // The one active edge on a leaf edge whose ends differ in sign.
    std::int64_t activeEdgeFrom(std::int64_t lower, std::size_t axis, std::int64_t side) const {
        const std::int64_t stride = leaves_->pointStride(axis);
        const bool isLowerAbove = side > 1 && leaves_->isAboveAt(lower);
        for (std::int64_t half = side / 2; half > 0; half /= 2)
            if (leaves_->isAboveAt(lower + half * stride) == isLowerAbove)
                lower += half * stride;
        return 4 * lower + static_cast<std::int64_t>(axis);
    }

    PolygonCorner polygonCorner(std::int64_t edge, const std::array<std::int32_t, 3>& origin) const {
        const auto axis = static_cast<std::size_t>(edge & 3);
        const auto start = leaves_->coordsOf(edge >> 2);
        PolygonCorner corner;
        for (std::size_t a = 0; a < 3; ++a) {
            const std::int32_t place = start[a] - origin[a];
            corner.position[static_cast<int>(a)] = static_cast<float>(place) + (a == axis ? 0.5f : 0.0f);
            if (a != axis && (place == 0 || place == leaf_.side()))
                corner.faces |= static_cast<std::uint8_t>(1u << (2 * a + (place == 0 ? 0 : 1)));
        }
        return corner;
    }

    const Leaves* leaves_ = nullptr; ///< in make()
    LeafCell leaf_;
    /// From the edge where the inside of the surface is entered to that where it is left.
    std::vector<std::pair<std::int64_t, std::int64_t>> segments_;
    std::vector<PolygonCorner> corners_;
    PolygonTriangulation triangulation_;
    std::vector<std::int64_t> edges_;
    std::vector<std::array<std::uint32_t, 3>> triangles_;
};

} // namespace isoslider::extract
