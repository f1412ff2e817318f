#pragma once

#include <array>
#include <string>

#include "core/extract/slices/slice_plane.h"
#include "core/extract/slices/surface_cut.h"
#include "core/grid/grid_geometry.h"
#include "core/grid/value_distribution.h"
#include "ui/model/slices/slice_options.h"

namespace isoslider::model {

/// Most pixels of a slice along a side: of a larger one every n-th sample is shown.
inline constexpr int kMostSliceSide = 2048;
/// Of an oblique one, which is interpolated all over.
inline constexpr int kMostObliqueSide = 1024;

/// Which axes of the grid run to the right and downwards in a slice, and whether backwards.
struct SliceAxes {
    int right = 0, down = 1;
    bool isRightBackwards = false, isDownBackwards = false;
};

/// The axis of the grid that a slice lies across. REQUIRES: it is not oblique.
int gridAxisOf(SliceKind kind, const GridGeometry& geometry);

/// Slices lie as the world's axes do, whatever order and direction the samples are stored in: across z, x to the right
/// and y downwards; across y, x to the right and z upwards; across x, y to the right and z upwards. Where the world is
/// a patient's (left, posterior, superior), that is how slices are read.
SliceAxes sliceAxes(const GridGeometry& geometry, int axis); // `axis`: of the grid

/// The pixels of a slice, of a volume known at every `step`-th sample. An axis slice has one for each of those, or for
/// every n-th; an oblique one covers the volume at all depths alike, with pixels as wide as the smallest spacing or a
/// multiple of it.
extract::SlicePlane planeOf(SliceKind kind, const SliceOptions& options, const GridGeometry& geometry,
                            std::int64_t step = 1);

/// Width and height of a pixel in the volume's unit of length.
glm::dvec2 pixelSize(const extract::SlicePlane& plane, const GridGeometry& geometry);

/// Column and row of a place, seen along the normal.
glm::dvec2 pixelOf(const extract::SlicePlane& plane, const glm::dvec3& place, const GridGeometry& geometry);

/// The plane in the index units of a frame's grid, which is of the volume or of every n-th of its samples.
extract::CutPlane cutPlaneOf(const extract::SlicePlane& plane, const GridGeometry& volume, const GridGeometry& frame);

/// Within the volume.
glm::dvec3 clampedPlace(const glm::dvec3& place, const GridGeometry& geometry);
/// At a grid point: where axis slices show samples as they are.
glm::dvec3 snappedPlace(const glm::dvec3& place, const GridGeometry& geometry);
/// `steps` slices on: grid points, or of the oblique slice smallest spacings along its normal. Stays inside.
glm::dvec3 steppedPlace(SliceKind kind, double steps, const SliceOptions& options, const GridGeometry& geometry);

/// What stands at the ends of a slice's middle lines.
struct SliceLabels {
    std::string left, right, top, bottom;
};
/// A patient's directions (R, L, A, P, I, S) where the world is one's, otherwise the axis, as AxisNames calls it, that
/// grows that way.
SliceLabels sliceLabels(SliceKind kind, const SliceOptions& options, const GridGeometry& geometry, bool isPatient);

/// Black and white at the values below and above which lies half a percent of the samples.
ValueWindow automaticWindow(const ValueDistribution& values);

} // namespace isoslider::model
