#pragma once

#include <cstdint>
#include <optional>

#include "core/topology/change_sums.h"

namespace isoslider::model {

/// What lies between the surfaces of two isovalues, on the way from one kept for comparison to another.
struct Comparison {
    double reference = 0.0, isovalue = 0.0;
    topology::SurfaceCounts before, after; ///< of the reference, and of the isovalue
    std::optional<topology::SurfaceMeasures> measuresBefore, measuresAfter; ///< none without curves
    /// Of pieces, on the way there: where it leads downwards, a piece that appears as the isovalue rises disappears.
    std::uint64_t appear = 0, disappear = 0, join = 0, split = 0;
    std::uint64_t events = 0;
    std::optional<double> volumeBetween; ///< never negative; none without curves
    bool areCountsExact = true;
    bool hasEvents = true; ///< else nothing is known of what happens to pieces on the way
};

/// O(log n) and at most topology::ChangeSums::kStep events twice: may follow the handle. Errors: those of reading
/// events.
Result<Comparison> compare(const topology::TopologySummary& summary, const topology::ChangeSums& sums, double reference,
                           double isovalue);

} // namespace isoslider::model
