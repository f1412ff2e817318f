#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include <glm/vec3.hpp>

#include "core/extract/surface_frame.h"

namespace isoslider::extract {

/// Where a line meets the surface.
struct SurfaceHit {
    glm::dvec3 place{0.0}; ///< grid index units
    std::uint32_t piece = 0; ///< place among the frame's pieces; 0 where it has none
};

/// The first point at which the segment meets a piece for which `isShown` holds, from either side. `from`, `to`: grid
/// index units. A frame without pieces is all one, number 0. O(bricks + triangles of the bricks that the segment passes
/// through); of frames with arrays O(triangles).
std::optional<SurfaceHit> firstHit(const SurfaceFrame& frame, const glm::dvec3& from, const glm::dvec3& to,
                                   const std::function<bool(std::uint32_t)>& isShown);

} // namespace isoslider::extract
