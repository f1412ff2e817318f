#pragma once

#include <cstdint>

#include "core/base/job_control.h"
#include "core/grid/histogram.h"
#include "core/grid/scalar_grid.h"

namespace isoslider {

/// Facts of a volume's finite samples. -0 and +0 count as one value.
struct VolumeStatistics {
    double min = 0.0;
    double max = 0.0;
    std::uint64_t distinctValues = 0;
    std::uint64_t nanCount = 0; ///< NaN and Inf samples
    Histogram histogram;
};

/// O(n). Counting the distinct values of wider samples than 16 bits takes as much memory as the samples, and more
/// passes where that does not suffice; `countsDistinct` false leaves distinctValues 0.
Result<VolumeStatistics> computeStatistics(const ScalarGrid& grid, bool countsDistinct = true, int histogramBins = 512,
                                           const JobControl& job = {});

} // namespace isoslider
