#pragma once

#include <optional>
#include <span>

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "core/extract/surface_frame.h"
#include "ui/model/colouring/surface_colours.h"

namespace isoslider::model {

/// The value that a place is coloured by; in index units of the volume. NaN where there is none, or it is by One. As
/// the graphics card has it: a field is trilinear between its texels.
double scalarAt(const SurfaceColours& colours, const GridGeometry& volume, const glm::dvec3& place);

/// Of all places in the volume. REQUIRES: by X, Y, Z or Middle.
ColourRange rangeOfVolume(ColourBy by, const GridGeometry& volume);

/// Widened where it has no width.
ColourRange usableRange(ColourRange range);

/// The least and the greatest value at the vertices of a surface, without those outside of `cuts`, which are in index
/// units of the frame. None if there is no value. O(vertices): for a job. Errors: Cancelled.
Result<std::optional<ColourRange>> rangeOnSurface(const extract::SurfaceFrame& frame, const SurfaceColours& colours,
                                                  const GridGeometry& volume, std::span<const glm::dvec4> cuts,
                                                  const JobControl& job);

} // namespace isoslider::model
