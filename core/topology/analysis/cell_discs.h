#pragma once

#include <array>
#include <cstdint>

namespace isoslider::topology {

/// Discs of the surface in a cell by its signs, where every ambiguous face parts its above corners and there is no
/// tunnel. What a cell has beyond that is for CellHistory.
const std::array<std::int8_t, 256>& discsBySigns();

/// What the surface's Euler number changes by where the isovalue rises beyond a grid point whose eight cells are there,
/// by which of its 26 neighbours are higher, if their discs are as above.
class NeighbourTable {
public:
    static const NeighbourTable& get();

    /// `low`: bit x + 3 y: that neighbour in the plane below; `high`: above; `level`: in the plane itself, without the
    /// point: bits 0 to 3 before it, 4 to 7 after it.
    int change(std::uint32_t low, std::uint32_t level, std::uint32_t high) const {
        return (low_[low << 8 | level] + high_[high << 8 | level]) / 4;
    }

private:
    NeighbourTable();
    // In quarters: the four cells around an edge share its vertex.
    std::array<std::int8_t, std::size_t{1} << 17> low_, high_;
};

} // namespace isoslider::topology
