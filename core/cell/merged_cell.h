#pragma once

#include <array>
#include <cstdint>

namespace isoslider::cell {

/// Signs of a cell's 27 samples at half its side: bit x + 3 y + 9 z is set when the sample is above, x, y, z = 0 to 2.
using MergedSigns = std::uint32_t;
inline constexpr MergedSigns kAllAbove = (MergedSigns{1} << 27) - 1;

/// Whether one cell may stand for its eight halves without a change of topology: no edge changes sign twice; neither
/// the cell nor a half has an ambiguous face or more than one loop; no face's middle differs from all middles of its
/// edges; and the halves' surface is one disk, as the cell's is, or there is none. Depends on signs only, so an answer
/// changes only where the isovalue crosses a sample.
/// PAPER 2.2: the restrictions on mergers. DEVIATION: monotone edges alone would allow handles and pieces to vanish.
bool keepsTopology(MergedSigns signs);

/// The same for 64 cells at once: bit i of word x + 3 y + 9 z is that sign of cell i, bit i of the answer is its
/// answer. As many operations as for one cell.
std::uint64_t keepsTopologyOf64(const std::array<std::uint64_t, 27>& signs);

/// The same for twice as many, at little more than the cost of one.
using TwoWords [[gnu::vector_size(16)]] = std::uint64_t;
TwoWords keepsTopologyOf128(const std::array<TwoWords, 27>& signs);

} // namespace isoslider::cell
