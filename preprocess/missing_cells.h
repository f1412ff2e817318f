#pragma once

#include "core/grid/brick_grid.h"
#include "core/index/format/index_format.h"

namespace isoslider::preprocess {

/// Bit per cell of the brick that lies in the grid and has a missing corner, as `isCellValid(x, y, z)` states at
/// coordinates of the grid. False when there is none.
template <class IsCellWhole>
bool findMissingCells(const BrickGrid& grid, BrickIndex brick, const IsCellWhole& isCellValid,
                      index::MissingCells& out) {
    out = {brick, {}};
    const auto b = grid.brickCoords(brick);
    bool any = false;
    for (int local = 0; local < kBrickPoints; ++local) {
        const std::int64_t x = b[0] * kBrickSide + (local & 7), y = b[1] * kBrickSide + (local >> 3 & 7),
                           z = b[2] * kBrickSide + (local >> 6);
        const bool exists = x + 1 < grid.dims()[0] && y + 1 < grid.dims()[1] && z + 1 < grid.dims()[2];
        if (exists && !isCellValid(x, y, z)) {
            out.cells[local >> 6] |= std::uint64_t{1} << (local & 63);
            any = true;
        }
    }
    return any;
}

} // namespace isoslider::preprocess
