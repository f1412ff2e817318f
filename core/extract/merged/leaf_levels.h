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
    int level(std::int64_t x, std::int64_t y, std::int64_t z) const { return levelAt(placeOf(x, y, z)); }
    /// Cells by their places in the table, which has a layer of cells outside the box around it: those have kNoLevel.
    std::int64_t placeOf(std::int64_t x, std::int64_t y, std::int64_t z) const {
        return (x + 1) + stride(1) * (y + 1) + stride(2) * (z + 1);
    }
    std::int64_t stride(std::size_t axis) const {
        return axis == 0 ? 1 : axis == 1 ? cells_[0] + 2 : (cells_[0] + 2) * (cells_[1] + 2);
    }
    int levelAt(std::int64_t place) const { return levels_[static_cast<std::size_t>(place)]; }
    const GridDims& cells() const { return cells_; }

    /// O(cells), and the active edges once for each level. One byte a cell, two until it is done. All threads. Ends
    /// early, with any levels, when `job` is to stop.
    /// REQUIRES: at least two grid points along each axis; 0 <= maxLevel <= kMaxMergeLevel.
    template <class Sample>
    static LeafLevels find(const SampleView<Sample>& view, double isovalue, const MergeBound& bound,
                           int maxLevel = kMaxMergeLevel, const JobControl& job = {});

private:
    void raise(const std::array<std::int64_t, 3>& origin, const GridDims& sides, int level);

    GridDims cells_{0, 0, 0};
    std::vector<std::int8_t> levels_;
};

} // namespace isoslider::extract
