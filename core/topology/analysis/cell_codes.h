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

} // namespace isoslider::topology
