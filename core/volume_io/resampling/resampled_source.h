#pragma once

#include <memory>
#include <span>

#include "core/volume_io/formats/format_readers.h"
#include "core/volume_io/resampling/curvilinear_resampler.h"

namespace isoslider::io {

/// Samples at points that form no uniform grid, and a way to take them to one.
class SourceMesh {
public:
    virtual ~SourceMesh() = default;
    /// A grid of type f32; points in no cell are NaN. Errors: Cancelled, whatever reading the samples reports.
    virtual Result<ScalarGrid> resample(const GridGeometry& geometry, const JobControl& job) = 0;
    /// One value per point, known once resample() has run.
    virtual std::span<const float> values() const = 0;
    virtual glm::dvec3 point(std::size_t index) const = 0;
};

/// The mesh sampled at the points of `info.geometry`, on the first slab. Then info() has its ResampleReport and the
/// mesh is gone.
std::unique_ptr<VolumeSource> makeResampledSource(VolumeInfo info, std::unique_ptr<SourceMesh> mesh);

/// The cells between the points of a curvilinear grid. REQUIRES: as resampleCurvilinear.
std::unique_ptr<SourceMesh> makeCurvilinearMesh(CurvilinearGrid grid);

/// How far `grid`, interpolated at the points of `mesh`, is from the values there. O(points).
ResampleReport compareWithSource(const ScalarGrid& grid, const SourceMesh& mesh);

/// A box of `low` to `high` filled by about `count` points, as nearly equally spaced along all axes as whole
/// numbers allow; two points at least along each.
GridDims evenDims(const glm::dvec3& low, const glm::dvec3& high, std::int64_t count);

/// The size that is asked for, else `otherwise`, when memory holds such a grid. Errors: InvalidArgument, OutOfSpace.
Result<GridDims> resampledDims(const ReadOptions& options, const GridDims& otherwise,
                               const std::filesystem::path& path);

} // namespace isoslider::io
