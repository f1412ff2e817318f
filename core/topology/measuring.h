#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/grid/histogram.h"
#include "core/grid/scalar_grid.h"
#include "core/topology/measure_curves.h"

namespace isoslider::topology {

/// At which isovalues a volume's surfaces are measured, and what share of their cells is looked at.
struct MeasurePlan {
    std::vector<double> isovalues; ///< ascending; none: nothing is measured
    std::vector<double> shares; ///< one for each isovalue, above 0 to 1
};
/// Isovalues evenly through the range, and as many with equally many samples between them. `activeCells`: of the lower
/// end of each bin, about; of large surfaces some ten thousand cells are looked at.
MeasurePlan planMeasures(const Histogram& histogram, std::span<const std::uint64_t> activeCells);
/// By some of its samples.
MeasurePlan planMeasures(const ScalarGrid& grid);

} // namespace isoslider::topology
