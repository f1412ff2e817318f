#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "core/extract/live/active_bits.h"
#include "core/extract/live/brick_bits.h"
#include "core/grid/brick_grid.h"
#include "core/index/format/index_format.h"

namespace isoslider::extract {

/// The masks of every brick of a grid. Those of bricks without missing values follow from where the brick lies: at
/// the beginning or the end of the box along each axis.
///
/// An edge is owned by the brick of the first valid cell around it, the cells taken in the order of their places
/// (lower coordinates first). All bricks that hold the edge see the same four cells, so one owns it.
class BrickShapes {
public:
    /// `missing` must outlive this; sorted by brick.
    BrickShapes(const GridDims& dims, const std::vector<index::MissingCells>& missing);

    /// Whether the brick has cells at all: the last bricks along an axis may hold points only.
    bool hasCells(BrickIndex brick) const;
    /// Whether a cell of the brick, or one that touches it, has a missing corner.
    bool isNearMissing(BrickIndex brick) const { return !isNearMissing_.empty() && isNearMissing_[brick.index()]; }
    /// Of a brick that is not near missing values.
    const BrickMasks& masks(BrickIndex brick) const { return byPlace_[placeOf(brick)]; }
    /// Of any brick; O(cells).
    BrickMasks masksNearMissing(BrickIndex brick) const;

    const BrickGrid& grid() const { return grid_; }
    std::array<std::int32_t, 3> origin(BrickIndex brick) const {
        const auto c = grid_.brickCoords(brick);
        return {static_cast<std::int32_t>(c[0] * kCellSide), static_cast<std::int32_t>(c[1] * kCellSide),
                static_cast<std::int32_t>(c[2] * kCellSide)};
    }

private:
    unsigned placeOf(BrickIndex brick) const;
    template <class Visit>
    void forEachAround(BrickIndex brick, const Visit& visit) const;
    const index::MissingCells* missingOf(BrickIndex brick) const;

    GridDims dims_;
    BrickGrid grid_;
    const std::vector<index::MissingCells>& missing_;
    std::vector<bool> isNearMissing_; ///< by brick; empty where nothing is missing
    std::vector<BrickMasks> byPlace_; ///< bit a: first along axis a, bit a + 3: last
};

} // namespace isoslider::extract
