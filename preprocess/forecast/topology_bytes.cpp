#include "preprocess/forecast/topology_bytes.h"

#include "core/topology/topology_forecast.h"
#include "preprocess/volume_planes.h"

namespace isoslider::preprocess {

Status addTopology(io::VolumeSource& source, const JobControl& job, DiskForecast& forecast) {
    const auto bytes = topology::forecastTopologyBytes(planesOf(source), job);
    if (!bytes.isOk())
        return bytes.error();
    forecast.topologyBytes = bytes.value();
    return {};
}

} // namespace isoslider::preprocess
