#pragma once

#include <cstdint>

#include "core/base/job_control.h"
#include "core/grid/scalar_grid.h"
#include "core/index/format/index_info.h"

namespace isoslider {

/// Facts of a volume's finite samples. -0 and +0 count as one value.
struct VolumeStatistics {
    double min = 0.0;
    double max = 0.0;
    std::uint64_t distinctValues = 0;
    std::uint64_t nanCount = 0; ///< NaN and Inf samples
    index::Histogram histogram;
};

/// O(n) for 8- and 16-bit samples, a parallel sort otherwise.
/// `countsDistinct` false leaves distinctValues 0 and costs one pass.
Result<VolumeStatistics> computeStatistics(const ScalarGrid& grid, bool countsDistinct = true, int histogramBins = 512,
                                           const JobControl& job = {});

} // namespace isoslider
