#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/base/job_control.h"
#include "core/grid/scalar_grid.h"
#include "core/volume_io/sources/volume_source.h"
#include "ui/model/colouring/colouring.h"

namespace isoslider::model {

/// Values to colour by, between which the graphics card interpolates: one of the volume's grid points, or the mean of
/// a block of them. A last block may be smaller; its mean stands in the middle of a whole one.
struct ColourField {
    /// A texel where something is missing: whatever it is interpolated with stays above kMostTexel.
    static constexpr float kMissing = 1e30f, kMostTexel = 1e6f;

    GridDims dims{0, 0, 0}; ///< texels
    std::int64_t step = 1; ///< side of a block in grid points
    std::int64_t gridStep = 1; ///< between those grid points, in those of the volume; above 1: of a preview
    double min = 0.0, max = 0.0; ///< of the values
    ColourRange usual; ///< without outliers
    bool hasMissing = false;
    std::vector<float> texels; ///< x fastest; 0 at min, 1 at max
};

/// 64 MiB on the card.
inline constexpr std::int64_t kMostTexels = std::int64_t{1} << 24;
/// Along one axis: what cards that are in use have at least.
inline constexpr std::int64_t kMostTexelsASide = 2048;

/// The smallest side of blocks with which a grid has at most so many.
std::int64_t colourBlockSide(const GridDims& dims, std::int64_t mostTexels = kMostTexels);

/// Fills `plane` with the samples at one z, x fastest. Asked for in ascending order, once each.
using ReadPlane = std::function<Status(std::int64_t z, std::span<float> plane)>;
ReadPlane planesOf(std::shared_ptr<const ScalarGrid> grid);
ReadPlane planesOf(std::shared_ptr<io::VolumeSource> source);

/// The values themselves, or the lengths of their gradients per unit of length: the derivatives that normals are made
/// of. Reads three planes at a time. Errors: those of reading; Cancelled; InvalidArgument if all is missing.
Result<ColourField> makeColourField(const GridGeometry& geometry, const ReadPlane& read, bool isGradient,
                                    const JobControl& job, std::int64_t mostTexels = kMostTexels);

/// How another grid differs from that of the volume, in one line: "20 × 20 × 20 points instead of 24 × 24 × 24".
/// Empty if its points lie on the volume's. Where nothing states where the grid lies, only its size counts.
std::string latticeDifference(const GridGeometry& field, const GridGeometry& volume, bool isPlaceKnown);

} // namespace isoslider::model
