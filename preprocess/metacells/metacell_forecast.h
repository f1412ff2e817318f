#pragma once

#include <filesystem>

#include "core/base/job_control.h"
#include "core/volume_io/sources/volume_source.h"
#include "preprocess/forecast/disk_forecast.h"
#include "preprocess/metacells/brick_list.h"

namespace isoslider::preprocess {

/// What an index of metacells will take of the disk, from some hundred of its chunks, encoded. Reads 18 planes at a
/// time, of up to 16 slabs. `spans` has room for all bricks; what it holds afterwards means nothing. `indexPath` is not
/// written to. Errors: those of the source, Cancelled.
template <class Sample>
Result<DiskForecast> forecastMetacells(io::VolumeSource& source, BrickSpans<KeyOf<Sample>>& spans,
                                       const BrickListOptions& list, const std::filesystem::path& indexPath,
                                       const JobControl& job);

} // namespace isoslider::preprocess
