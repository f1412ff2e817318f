#pragma once

#include "core/base/job_control.h"
#include "core/volume_io/sources/volume_source.h"
#include "preprocess/forecast/disk_forecast.h"

namespace isoslider::preprocess {

/// Sets what the volume's topology will take of the disk, see topology::forecastTopologyBytes(). Nothing for one that
/// is not analysed. Errors: those of the source; Cancelled.
Status addTopology(io::VolumeSource& source, const JobControl& job, DiskForecast& forecast);

} // namespace isoslider::preprocess
