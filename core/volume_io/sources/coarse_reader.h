#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "core/base/job_control.h"
#include "core/volume_io/sources/volume_source.h"

namespace isoslider::io {

/// Grid points that every `step`-th sample along each axis makes, the first included.
GridDims coarseDims(const GridDims& dims, std::int64_t step);

/// Where those grid points are: of the same origin, `step` times as far apart. Up to step - 1 of the last
/// samples along an axis lie beyond the last coarse one.
GridGeometry coarseGeometry(const GridGeometry& geometry, std::int64_t step);

/// The smallest power of two, 2 or more, with which the coarse grid has at most `maxSamples` grid points.
/// None if an axis of several samples would be left with fewer than two.
std::optional<std::int64_t> coarseStep(const GridDims& dims, std::uint64_t maxSamples);

/// Every `step`-th sample along each axis, unchanged. Holds one plane of the source at a time and asks for
/// one in `step`. Errors: Cancelled, OutOfSpace, whatever the source reports.
Result<std::shared_ptr<const ScalarGrid>> readCoarse(VolumeSource& source, std::int64_t step,
                                                     const JobControl& job = {});

} // namespace isoslider::io
