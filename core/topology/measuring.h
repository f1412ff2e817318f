#pragma once

#include <limits>
#include <utility>
#include <vector>

#include "core/base/job_control.h"
#include "core/grid/scalar_grid.h"
#include "core/topology/measure_curves.h"

namespace isoslider::topology {

struct PlaneSource;

/// At which isovalues a volume's surfaces are measured, and what share of their cells is looked at.
struct MeasurePlan {
    std::vector<double> isovalues; ///< ascending; none: nothing is measured
    std::vector<double> shares; ///< one for each isovalue, above 0 to 1
    double least = 0.0, greatest = 0.0; ///< of all samples: beyond them there is no surface
    /// The values without extreme outliers and fill values: cells with others do not count in the mean gradient.
    std::pair<double, double> usual{-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
};

/// Isovalues evenly through the usual values, and as many with equally many samples between them; beyond, where a few
/// samples may lie orders of magnitude away, some to either end; and both sides of where the surface jumps: the least
/// sample, the greatest, and values that many samples have. Of large surfaces some hundred thousand cells are looked
/// at. By some of the samples: reads a few planes. `least` and `greatest` are those of all finite samples. Errors:
/// those of `source`, Cancelled.
Result<MeasurePlan> planMeasures(const PlaneSource& source, double least, double greatest, const JobControl& job = {});
/// Of a volume in memory; looks at each sample once.
MeasurePlan planMeasures(const ScalarGrid& grid);

} // namespace isoslider::topology
