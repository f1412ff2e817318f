#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "core/volume_io/resampling/resampled_source.h"

namespace isoslider::io {

/// How far a point of an axis may be from its place in even spacing to pass for it, in spacings.
inline constexpr double kEvenTolerance = 1e-4;

/// Coordinates along one axis of a grid.
struct GridAxis {
    std::vector<double> at; ///< ascending
    bool isDescending = false; ///< in the file: `at` has been turned round
    bool isEven = true; ///< within latticeTolerance

    double origin() const { return at.front(); }
    /// Of even axes, and of those made even by resampling to `count` points. 1 if there is one point.
    double spacing(std::size_t count) const;
};

/// REQUIRES: not empty. Errors: InvalidArgument (not finite; neither ascending nor descending), naming `field`.
Result<GridAxis> makeAxis(std::vector<double> coordinates, std::string_view field, const std::filesystem::path& path);

/// 0, 1, 2 ... where a file states nothing of places.
GridAxis indexAxis(std::int64_t count);

/// The uniform grid of `dims` points over the same box.
GridGeometry axesGeometry(const std::array<GridAxis, 3>& axes, const GridDims& dims);

/// Points per axis of the uniform grid that uneven axes are taken to unless a size is asked for. Even axes keep their
/// points; uneven ones get points as near as their nearest two, so that nothing between those is lost, but no more
/// than 32 times as many in all, 2^26, and half of `memoryBytes`. Never fewer than their own.
GridDims defaultDims(const std::array<GridAxis, 3>& axes, std::uint64_t memoryBytes);

/// Samples of `values` along x, y and z, which lie unevenly, at the points of `geometry`: trilinear, f32. A missing
/// value leaves missing what depends on it. REQUIRES: as many values as the axes have points.
/// O(output points). Errors: Cancelled.
Result<ScalarGrid> resampleRectilinear(const std::array<GridAxis, 3>& axes, std::span<const float> values,
                                       const GridGeometry& geometry, const JobControl& job = {});

/// The samples of `source`, whose points lie where the axes state. If all are even, that is `source` placed there; else
/// they are resampled to the size that the options ask for, or to defaultDims(). `source` is of the axes' size,
/// ascending. Errors: InvalidArgument, OutOfSpace.
Result<std::unique_ptr<VolumeSource>> placeOnAxes(std::unique_ptr<VolumeSource> source, std::array<GridAxis, 3> axes,
                                                  const ReadOptions& options, const std::filesystem::path& path);

} // namespace isoslider::io
