#pragma once

#include <optional>
#include <span>

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "core/base/job_control.h"
#include "core/extract/surface_frame.h"
#include "ui/model/pieces/piece_tints.h"

namespace isoslider::model {

/// A ball around what is shown of a surface.
struct SurfaceExtent {
    glm::dvec3 middle{0.0}; ///< of its bounding box along the grid's axes, in the frame's index units
    double radius = 0.0; ///< to the farthest vertex, in the volume's unit of length as it is drawn
};

/// Of the triangles of a picture, without the pieces that are hidden, whose places are known to one grid step, and
/// without vertices outside of `cuts`, those of cutsOf() in the frame's index units; none if nothing is shown.
/// `stretch` is that of the stage. O(vertices + triangles + pieces): for a job. Errors: Cancelled.
Result<std::optional<SurfaceExtent>> extentOf(const extract::SurfaceFrame& frame, const PieceOptions& pieces = {},
                                              std::span<const glm::dvec4> cuts = {}, const JobControl& job = {},
                                              const glm::dvec3& stretch = glm::dvec3(1.0));

} // namespace isoslider::model
