#pragma once

#include <filesystem>

#include "core/base/result.h"
#include "core/index/format/index_info.h"
#include "tests/bench/workloads.h"

namespace isoslider::bench {

/// The index of a bench volume on disk, and what it cost.
struct PreparedIndex {
    std::filesystem::path path;
    index::IndexInfo info;
    bool wasBuilt = false; ///< false: one from an earlier run; the times are 0 then
    double buildSeconds = 0.0;
    double sortSeconds = 0.0; ///< one std::sort of the finite (value, id) pairs, mean of before and after

    double bytesPerVoxel() const {
        return static_cast<double>(info.indexBytes) / static_cast<double>(pointCount(info.geometry.dims));
    }
};

struct PrepareOptions {
    std::filesystem::path folder; ///< where the index is kept
    index::IndexKind kind = index::IndexKind::Edges;
    bool reuses = false; ///< takes the one that is there
    int threads = 0;
};

/// Builds the index of a volume, with the builder's defaults but for the options. Errors: those of buildIndex
/// and of opening an index.
Result<PreparedIndex> prepareIndex(const BenchVolume& volume, const PrepareOptions& options);

/// Seconds for one std::sort, on one thread, of the pairs (value, id) of all finite samples.
double sortSeconds(const ScalarGrid& grid);

/// Seconds from a headerless file of the volume to its first surface by full extraction: the file is
/// written to `folder` first and removed afterwards. Errors: IoError.
Result<double> firstPictureSeconds(const BenchVolume& volume, const std::filesystem::path& folder);

} // namespace isoslider::bench
