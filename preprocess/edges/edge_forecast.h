#pragma once

#include <cstdint>
#include <filesystem>

#include "core/base/job_control.h"
#include "core/volume_io/sources/volume_source.h"
#include "preprocess/build_index.h"
#include "preprocess/edges/slab_window.h"
#include "preprocess/forecast/disk_forecast.h"
#include "preprocess/levels/key_intervals.h"

namespace isoslider::preprocess {

/// What is known of a volume after its values have been counted.
struct EdgeCounts {
    const std::vector<KeyCount>& keys;
    std::uint64_t unequalPairs = 0; ///< of neighbours along an axis, both finite
    double min = 0.0, max = 0.0;
};

/// Pairs of unequal neighbours, both finite, of which the upper one lies in planes [z0, z1).
/// REQUIRES: those planes, and the one below them if there is one, are in the window.
template <class Sample>
std::uint64_t countUnequalPairs(const SlabWindow<Sample>& window, const GridDims& dims, std::int64_t z0,
                                std::int64_t z1);

struct EdgeForecast {
    DiskForecast disk;
    double bytesPerEntry = 0.0; ///< block_choice.h; 0 where the options state k
};

/// What an index of edges will take of the disk: tiles of bricks from up to 16 layers go through all that the build
/// does to them, and the number of edges states how many times as many there are. Reads a layer at a time, with
/// its apron. Depends on neither threads nor memory, but for temporary files. `indexPath` is not written to. Errors:
/// those of the source, Cancelled.
template <class Sample>
Result<EdgeForecast> forecastEdges(io::VolumeSource& source, const EdgeCounts& counts, const BuildOptions& options,
                                   std::uint64_t sortMemory, const std::filesystem::path& indexPath,
                                   const JobControl& job);

} // namespace isoslider::preprocess
