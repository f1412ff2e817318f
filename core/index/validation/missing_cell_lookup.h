#pragma once

#include <algorithm>
#include <vector>

#include "core/grid/edge_cells.h"
#include "core/index/format/index_format.h"

namespace isoslider::index {

/// Which cells have a missing corner, as the meta of an index states. `cells` must outlive it.
class MissingCellLookup {
public:
    explicit MissingCellLookup(const std::vector<MissingCells>& cells) : cells_(cells) {}

    /// O(log n) of the bricks that have such cells.
    bool isMissing(BrickIndex brick, LocalPoint cell) const {
        if (cells_.empty())
            return false;
        const auto found = std::lower_bound(cells_.begin(), cells_.end(), brick,
                                            [](const MissingCells& entry, BrickIndex b) { return entry.brick < b; });
        return found != cells_.end() && found->brick == brick &&
               (found->cells[cell.number() / 64] >> (cell.number() % 64) & 1) != 0;
    }

    /// Whether one of the cells around an edge of the grid has eight finite corners.
    bool isEdgeUsable(const BrickGrid& grid, const std::array<std::int64_t, 3>& lower, int axis) const {
        return hasValidCell(lower[0], lower[1], lower[2], axis, [&](auto x, auto y, auto z) {
            if (x < 0 || y < 0 || z < 0 || x + 1 >= grid.dims()[0] || y + 1 >= grid.dims()[1] ||
                z + 1 >= grid.dims()[2])
                return false;
            const PointId id = grid.pointId(x, y, z);
            return !isMissing(brickOf(id), localOf(id));
        });
    }

private:
    const std::vector<MissingCells>& cells_;
};

} // namespace isoslider::index
