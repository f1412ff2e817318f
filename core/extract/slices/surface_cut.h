#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include <glm/vec3.hpp>

#include "core/base/job_control.h"
#include "core/extract/surface_frame.h"

namespace isoslider::extract {

/// All places p with dot(normal, p) == offset; grid index units.
struct CutPlane {
    glm::dvec3 normal{0.0, 0.0, 1.0};
    double offset = 0.0;

    bool operator==(const CutPlane&) const = default;
};

/// Where a plane cuts the surface of a frame: line segments, two points each, in grid index units of the frame. Edges
/// that lie in the plane are part of it, once each; triangles that do are not, so that the cut is made of lines. On a
/// plane of grid points this is the isoline of the slice's bilinear faces. O(bricks + triangles of the bricks that the
/// plane passes through); of frames with arrays O(triangles). `isShown`: which of the frame's pieces count, by their
/// place; empty for all, as in a frame without pieces. Errors: Cancelled.
Result<std::vector<glm::vec3>> cutSurface(const SurfaceFrame& frame, const CutPlane& plane, const JobControl& job = {},
                                          const std::function<bool(std::uint32_t piece)>& isShown = {});

} // namespace isoslider::extract
