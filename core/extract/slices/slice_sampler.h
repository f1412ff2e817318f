#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>

#include "core/base/job_control.h"
#include "core/extract/slices/slice_plane.h"
#include "core/grid/scalar_grid.h"

namespace isoslider::extract {

/// Reads planes of a volume. One thread at a time (it uses TBB inside).
class SliceSampler {
public:
    virtual ~SliceSampler() = default;

    virtual const GridGeometry& geometry() const = 0;
    /// Between samples the value is that of the trilinear interpolant; at a grid point it is that of its sample alone,
    /// whatever is missing around it. O(pixels), and the samples beside them. Errors: Cancelled, IoError, Corruption.
    virtual Result<SliceSamples> sample(const SlicePlane& plane, const JobControl& job) = 0;
};

/// Of a volume in memory.
std::unique_ptr<SliceSampler> makeSliceSampler(std::shared_ptr<const ScalarGrid> grid);

/// Decoded samples that are kept of an index, so that the slices beside one are there at once.
inline constexpr std::uint64_t kSliceCacheBytes = std::uint64_t{128} << 20;

/// Of an index: of its samples, those chunks are decoded that the plane passes through, and at most `cacheBytes` are
/// kept, but never below the 2048 chunks that some few pixels may need. Errors: those of opening an index.
Result<std::unique_ptr<SliceSampler>> openSliceSampler(const std::filesystem::path& indexPath,
                                                       std::uint64_t cacheBytes = kSliceCacheBytes);

} // namespace isoslider::extract
