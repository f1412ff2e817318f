#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/base/job_control.h"
#include "core/extract/merged/merge_bound.h"
#include "core/grid/gradient.h"

namespace isoslider::extract {

/// The leaves at an isovalue: the largest usable ones of the cells of side 2^n, aligned at multiples of 2^n and wholly
/// in the grid, n = 0 to kMaxMergeLevel. A cell of level n > 0 is usable if its eight halves are, if its
/// signs keep the topology (core/cell/merged_cell.h), if no sample in it is missing, and if no active edge of the grid
/// in it exceeds the bound. What is usable depends on samples inside the cell only.
/// PAPER 2.2.
class LeafLevels {
public:
    /// The level of the leaf that holds the grid's cell (x, y, z).
    int level(std::int64_t x, std::int64_t y, std::int64_t z) const {
        return levels_[static_cast<std::size_t>(x + cells_[0] * (y + cells_[1] * z))];
    }
    const GridDims& cells() const { return cells_; }

    /// O(cells), and the active edges once for each level. One byte a cell, two until it is done. All threads. Ends
    /// early, with any levels, when `job` is to stop.
    /// REQUIRES: at least two grid points along each axis; 0 <= maxLevel <= kMaxMergeLevel.
    template <class Sample>
    static LeafLevels find(const SampleView<Sample>& view, double isovalue, const MergeBound& bound,
                           int maxLevel = kMaxMergeLevel, const JobControl& job = {});

private:
    void raise(const std::array<std::int64_t, 3>& origin, int level);

    GridDims cells_{0, 0, 0};
    std::vector<std::uint8_t> levels_;
};

} // namespace isoslider::extract
