#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "core/grid/brick_grid.h"

namespace isoslider {

/// Bricks between two along each axis, both included; coordinates as BrickGrid::brickCoords() has them.
struct BrickBox {
    std::array<std::int64_t, 3> first{}, last{};

    bool operator==(const BrickBox&) const = default;
    bool contains(const std::array<std::int64_t, 3>& brick) const {
        for (std::size_t a = 0; a < 3; ++a)
            if (brick[a] < first[a] || brick[a] > last[a])
                return false;
        return true;
    }
};

/// The bricks of the cells between two grid points, and those beside them. REQUIRES: low < high along each axis, within
/// the grid.
inline BrickBox bricksAround(const std::array<std::int64_t, 3>& low, const std::array<std::int64_t, 3>& high,
                             const BrickGrid& grid) {
    BrickBox box;
    for (std::size_t a = 0; a < 3; ++a) {
        box.first[a] = std::max<std::int64_t>(0, low[a] / kBrickSide - 1);
        box.last[a] = std::min<std::int64_t>(grid.bricks()[static_cast<int>(a)] - 1, (high[a] - 1) / kBrickSide + 1);
    }
    return box;
}

} // namespace isoslider
