#pragma once

#include <array>
#include <cstdint>

namespace isoslider::extract {

/// Corner i of a cell lies at (i & 1, i >> 1 & 1, i >> 2 & 1); bit i of a case index: corner is above.
/// Cell edges: 0-3 along x at (y, z) = (0,0) (1,0) (0,1) (1,1); 4-7 along y at (x, z) likewise;
/// 8-11 along z at (x, y) likewise.
struct CellEdge {
    std::uint8_t lowerCorner;
    std::uint8_t upperCorner;
    std::uint8_t axis;
};
extern const std::array<CellEdge, 12> kCellEdges;

/// Triangulation of one case: three cell edges per triangle, counter-clockwise seen from the side
/// below the isovalue.
struct CellCase {
    std::uint8_t triangleCount = 0; ///< 0..5
    std::array<std::uint8_t, 15> edges{};
    std::uint16_t edgeMask = 0;     ///< bit e: cell edge e is active
};

/// The 256 cases, derived and not typed in.
///
/// Each face contributes directed segments from its four signs alone: going round the face
/// counter-clockwise seen from outside, a segment runs from the edge where the above region is
/// entered to the edge where it is left. An ambiguous face separates its two above corners. So two
/// cells always draw the same segments on their common face and every edge's segments chain into
/// loops: the mesh is closed and oriented. A loop is triangulated without any diagonal that joins two
/// vertices of one face: otherwise both neighbours could lay the same edge there and the mesh would
/// not be manifold.
const std::array<CellCase, 256>& caseTable();

/// For each 12-bit mask of active edges: the case index in which corner 0 is below, or 0 when no
/// sign pattern has that mask. The other solution is its complement.
const std::array<std::uint8_t, 4096>& caseFromEdgeMask();

/// True for masks that belong to a sign pattern.
bool isEdgeMask(std::uint16_t mask);

} // namespace isoslider::extract
