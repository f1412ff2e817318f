#pragma once

#include <cstdint>

namespace isoslider::topology {

/// Where a cell is ambiguous at some isovalue. Bit f: two opposite corners of face f come after both others, in the
/// order of kFaceCorners; kMayHaveInner: a critical point may lie inside.
using CellCode = std::uint8_t;
inline constexpr unsigned kSaddleFaces = 63, kMayHaveInner = 64;

/// Codes of `count` cells of a row. `samples`, and `edges` of HigherNeighbours, begin at the first one's lowest corner;
/// `row` and `plane`: steps to the next ones in both. Along no axis do all four edges of a cell that may have an inner
/// critical point ascend, or all descend, and plain arithmetic with bounds on its error cannot exclude one: with
/// another code CellSaddles finds none. NaN excludes nothing. O(count).
template <class Sample>
void findCellCodes(const Sample* samples, const std::uint8_t* edges, std::int64_t row, std::int64_t plane,
                   std::int64_t count, CellCode* codes);

/// How the interpolants of a row of cells go on from the saddles of their faces, in plain arithmetic with bounds on its
/// error. Bit f of `grows`: scalars grow into the cell at that of face f; bit f of `isKnown`: this is certain. Of faces
/// without a saddle they mean nothing. O(count).
template <class Sample>
void findFaceSides(const Sample* samples, const CellCode* codes, std::int64_t row, std::int64_t plane,
                   std::int64_t count, std::uint8_t* grows, std::uint8_t* isKnown);

/// Bits 0, 2 and 4: at the saddle of the face at the low end of an axis neither of its pairs of opposite corners comes
/// together, as what grid points lead to is the same already. `above`, `below`: what they lead to on each side, from
/// the first cell's lowest corner on; `edges` as above. Of faces without a saddle they mean nothing. O(count).
void findNeedlessJoins(const std::uint32_t* above, const std::uint32_t* below, const std::uint8_t* edges,
                       std::int64_t row, std::int64_t plane, std::int64_t count, std::uint8_t* needless);

} // namespace isoslider::topology
