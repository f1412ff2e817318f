#include "preprocess/forecast/topology_bytes.h"

#include "core/topology/topology_forecast.h"

namespace isoslider::preprocess {

Status addTopology(io::VolumeSource& source, const JobControl& job, DiskForecast& forecast) {
    const topology::PlaneSource planes{source.info().geometry, source.info().type,
                                       [&](std::int64_t zBegin, std::int64_t zEnd, std::span<std::byte> out) {
                                           return source.readSlab(zBegin, zEnd, out);
                                       }};
    const auto bytes = topology::forecastTopologyBytes(planes, job);
    if (!bytes.isOk())
        return bytes.error();
    forecast.topologyBytes = bytes.value();
    return {};
}

} // namespace isoslider::preprocess
