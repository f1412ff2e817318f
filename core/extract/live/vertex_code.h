#pragma once

#include <cstddef>
#include <cstdint>

#include "core/extract/live/closed_brick.h"

namespace isoslider::extract {

/// What a live brick keeps of one of its vertices, and what is sent to the graphics card: where it is. All else follows
/// from the brick's points and the isovalue (edge_record.h).
///
/// On an active edge: bits 0-1 the axis, 2-11 the point where it starts, 12-13 the level of the leaf edge that contains
/// it, 0 without merged cells. Inside a cell: bits 0-1 are 3, 2-15 its number among the brick's vertices inside cells.
using VertexCode = std::uint16_t;

inline constexpr unsigned kInsideAxis = 3;
inline constexpr int kCodeLevelShift = 12;
inline constexpr unsigned kCodePlaceMask = (1u << kCodeLevelShift) - 1;

constexpr VertexCode vertexCode(ClosedEdge edge, int level = 0) {
    return static_cast<VertexCode>(level << kCodeLevelShift | startOf(edge).number() << 2 | axisOf(edge));
}
constexpr VertexCode insideCode(std::size_t number) { return static_cast<VertexCode>(number << 2 | kInsideAxis); }

constexpr bool isInside(VertexCode code) { return (code & kInsideAxis) == kInsideAxis; }

/// REQUIRES for this and what follows: not inside.
constexpr ClosedEdge edgeOf(VertexCode code) {
    return closedEdge(static_cast<int>(code & 3u), ClosedPoint((code & kCodePlaceMask) >> 2));
}
constexpr int levelOf(VertexCode code) { return code >> kCodeLevelShift; }

/// The points at the ends of the edge of a code, or of the leaf edge that contains it.
struct EdgeEnds {
    std::size_t lower, upper;
};
/// Leaf edges are aligned at multiples of their length.
constexpr EdgeEnds endsOf(VertexCode code) {
    const ClosedEdge edge = edgeOf(code);
    const auto axis = static_cast<std::size_t>(axisOf(edge));
    const int inside = (1 << levelOf(code)) - 1, along = coordsOf(startOf(edge))[axis];
    const std::size_t lower = startOf(edge).index() - static_cast<std::size_t>((along & inside) * kPointStride[axis]);
    return {lower, lower + static_cast<std::size_t>((inside + 1) * kPointStride[axis])};
}

/// Most active edges of a closed brick: 3 directions of 8 x 9 x 9.
inline constexpr std::size_t kMaxBrickEdges = 3 * kCellSide * kPointSide * kPointSide;
/// Room for their codes, and for what is written behind them in whole vectors.
inline constexpr std::size_t kMaxEdgeCodes = kMaxBrickEdges + 64;

} // namespace isoslider::extract
