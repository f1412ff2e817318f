#pragma once

#include <array>
#include <cstdint>

namespace isoslider::cell {

/// Corner i of a cell lies at (i & 1, i >> 1 & 1, i >> 2 & 1). The signs of a cell: bit i is set when
/// corner i is above.
///
/// Edges: 0-3 along x at (y, z) = (0,0) (1,0) (0,1) (1,1); 4-7 along y at (x, z) likewise; 8-11 along z
/// at (x, y) likewise.
struct CellEdge {
    std::uint8_t lowerCorner;
    std::uint8_t upperCorner;
    std::uint8_t axis;
};
extern const std::array<CellEdge, 12> kCellEdges;

/// Faces: x0 x1 y0 y1 z0 z1. Their corners counter-clockwise seen from outside the cell.
inline constexpr std::array<std::array<std::uint8_t, 4>, 6> kFaceCorners{
    {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};

/// The edge between two neighbouring corners.
int edgeBetween(int cornerA, int cornerB);

/// Bit f: the edge lies in face f (two faces an edge).
const std::array<std::uint8_t, 12>& facesOfEdges();

/// Bit e: the edge's ends differ in sign.
std::uint16_t activeEdges(std::uint8_t signs);

/// Bit f: the face is ambiguous, two above corners opposite each other.
std::uint8_t ambiguousFaces(std::uint8_t signs);

} // namespace isoslider::cell
