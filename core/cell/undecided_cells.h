#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/cell/trilinear_cell.h"

namespace isoslider::cell {

/// Ambiguous cells that are decided together, a cell to a lane: their corner scalars, each beside those of other cells.
struct UndecidedCells {
    static constexpr std::size_t kMost = 64;

    std::size_t count = 0;
    alignas(64) std::array<std::array<double, kMost>, 8> scalars;
    alignas(64) std::array<std::uint64_t, kMost> signs; ///< as for resolveCell()

    CornerScalars scalarsOf(std::size_t cell) const {
        CornerScalars its;
        for (std::size_t corner = 0; corner < 8; ++corner)
            its[corner] = scalars[corner][cell];
        return its;
    }
};

/// resolveCell() of each: the same states, and intervals to the bit, under every instruction set. Some 20 ns a cell
/// with eight lanes; what plain arithmetic does not settle goes to resolveCell(). A cell one of whose scalars is not
/// finite gets its signs as state, and an empty interval.
void resolveCells(const UndecidedCells& cells, double isovalue, ResolvedCell* resolved);

} // namespace isoslider::cell
