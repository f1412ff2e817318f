#pragma once

#include <vector>

#include <glm/vec2.hpp>

#include "core/extract/slices/slice_plane.h"
#include "core/grid/grid_geometry.h"
#include "ui/model/surface/clipping.h"

namespace isoslider::model {

/// The samples on a clip plane, from which its cap is drawn: where they reach the isovalue.
struct CapSamples {
    ClipPlane of;
    extract::SlicePlane plane; ///< grid index units of the volume
    /// In rows. x: the value, 0 where it is not known; y: 1 where it is known, else 0.
    std::vector<glm::vec2> pixels;
};

/// The pixels to sample for a clip plane of a volume known at every `step`-th point: over the volume at all depths
/// alike, several to a cell where that is not too many.
extract::SlicePlane capPlaneOf(const ClipPlane& plane, const GridGeometry& volume, std::int64_t step);

/// `samples` are those of `plane`, in index units of any grid. Values are continued one pixel beyond the volume's
/// sides, so that what is interpolated between pixels reaches them. O(pixels).
CapSamples capSamplesOf(const ClipPlane& of, const extract::SlicePlane& plane, const extract::SliceSamples& samples,
                        const GridDims& dims);

} // namespace isoslider::model
