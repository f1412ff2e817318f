#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/strong_id.h"

namespace isoslider::extract {

// A closed brick: 8^3 cells and the 9^3 grid points of their corners, x fastest. It holds everything that its cells'
// triangles need, the edges on its faces included, which the bricks beside it hold too.

inline constexpr int kCellSide = 8;
inline constexpr int kPointSide = 9;
inline constexpr int kClosedPoints = kPointSide * kPointSide * kPointSide;
inline constexpr std::array<int, 3> kPointStride{1, kPointSide, kPointSide* kPointSide};

/// Bricks that a thread takes at once from a move's list: few enough to share out evenly, enough to fetch ahead.
inline constexpr std::size_t kBricksTogether = 16;

struct ClosedPointTag;
struct ClosedEdgeTag;
/// A grid point of a closed brick, x + 9 y + 81 z, or the cell that starts there.
using ClosedPoint = StrongId<ClosedPointTag, std::uint16_t>;
/// An edge of a closed brick: 1024 * axis + the point where it starts. The active edges' order in the brick.
using ClosedEdge = StrongId<ClosedEdgeTag, std::uint16_t>;

inline constexpr int kEdgeAxisShift = 10;
inline constexpr std::uint16_t kEdgePointMask = (1u << kEdgeAxisShift) - 1;

constexpr ClosedPoint closedPoint(int x, int y, int z) { return ClosedPoint(x + kPointSide * (y + kPointSide * z)); }
constexpr std::array<int, 3> coordsOf(ClosedPoint point) {
    const int p = point.number();
    return {p % kPointSide, p / kPointSide % kPointSide, p / (kPointSide * kPointSide)};
}

constexpr ClosedEdge closedEdge(int axis, ClosedPoint start) {
    return ClosedEdge(axis << kEdgeAxisShift | start.number());
}
constexpr int axisOf(ClosedEdge edge) { return edge.number() >> kEdgeAxisShift; }
constexpr ClosedPoint startOf(ClosedEdge edge) { return ClosedPoint(edge.number() & kEdgePointMask); }

} // namespace isoslider::extract
