#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/extract/slices/slice_plane.h"
#include "core/grid/grid_geometry.h"
#include "ui/model/slices/slice_options.h"

namespace isoslider::model {

/// A slice in shades of grey: as both the panes and the 3-D view draw it.
struct SliceShades {
    extract::SlicePlane plane; ///< grid index units of the volume
    /// 0xAARRGGBB, in rows; transparent outside the volume.
    std::vector<std::uint32_t> pixels;
};

/// Missing samples inside the volume: no grey, so that they cannot be taken for a value.
inline constexpr std::uint32_t kMissingColour = 0xff5c3470;
/// Of contours: the surface's own hue, strong enough to stand out from greys.
inline constexpr std::uint32_t kContourColour = 0xffffb040;

/// `samples` of the plane, in index units of a grid; `dims`: of the volume, for what is outside. O(pixels).
SliceShades shadesOf(const extract::SliceSamples& samples, const extract::SlicePlane& plane, const ValueWindow& window,
                     const GridDims& dims);

} // namespace isoslider::model
