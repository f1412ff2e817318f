#pragma once

#include <cstdint>
#include <optional>

#include "core/base/job_control.h"
#include "core/grid/value_spread.h"
#include "core/volume_io/sources/volume_source.h"

namespace isoslider::preprocess {

/// Facts of a volume's finite samples. -0 and +0 count as one value.
struct VolumeFacts {
    double min = 0.0; ///< NaN, as max, where no sample is finite
    double max = 0.0;
    std::uint64_t distinctValues = 0;
    std::uint64_t missingSamples = 0; ///< NaN and infinities
    std::optional<ValueSpread> spread; ///< none where no sample is finite
};

/// Reads all samples, slab by slab, and once more for each part of the distinct values that does not fit into
/// `memoryBytes`. Holds the slabs and that much besides. Errors: Cancelled, those of the source.
Result<VolumeFacts> findFacts(io::VolumeSource& source, std::uint64_t memoryBytes, const JobControl& job = {});

} // namespace isoslider::preprocess
