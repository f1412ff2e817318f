#pragma once

#include <array>
#include <optional>
#include <vector>

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "core/grid/grid_geometry.h"

namespace isoslider::model {

/// Places along an edge of a volume's box, as they are read off it.
struct TickedEdge {
    /// Of the world, where the edge runs along one of its axes; else of the grid, and values are lengths from the
    /// first grid point.
    int axis = 0;
    bool isOfWorld = true;
    glm::dvec3 from{0.0}, to{0.0}; ///< its ends; index units of the volume
    struct Tick {
        double value = 0.0; ///< a multiple of 1, 2 or 5 times a power of ten
        glm::dvec3 place{0.0}; ///< index units
    };
    std::vector<Tick> ticks;
};

/// One edge along each axis of the grid, from the outline of the box as it is seen: the lowest one, of upright ones the
/// one farthest left. None along an axis that has no extent on the screen, and none at all where a corner lies beside
/// or behind the viewer. `toScreen`: from index units to [-1, 1] before the division by w, y upwards; `pixels`: of that
/// screen, from which follows how many ticks there is room for.
std::vector<TickedEdge> tickedEdges(const GridGeometry& volume, const glm::dmat4& toScreen, const glm::dvec2& pixels);

} // namespace isoslider::model
