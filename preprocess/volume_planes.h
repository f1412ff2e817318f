#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/topology/topology_analysis.h"
#include "core/volume_io/sources/volume_source.h"

namespace isoslider::preprocess {

/// A volume as the analysis of topology reads it; `source` must outlive it.
inline topology::PlaneSource planesOf(io::VolumeSource& source) {
    return {source.info().geometry, source.info().type,
            [&source](std::int64_t zBegin, std::int64_t zEnd, std::span<std::byte> out) {
                return source.readSlab(zBegin, zEnd, out);
            }};
}

} // namespace isoslider::preprocess
