#pragma once

#include <cmath>

#include <glm/matrix.hpp>

#include "core/grid/grid_geometry.h"

namespace isoslider {

/// Whether the axes are perpendicular to each other, and unit vectors, but for rounding in files.
inline bool hasOrthogonalAxes(const GridGeometry& geometry) {
    constexpr double kRounding = 1e-5;
    const glm::dmat3 products = glm::transpose(geometry.direction) * geometry.direction;
    for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b)
            if (!(std::abs(products[a][b] - (a == b ? 1.0 : 0.0)) < kRounding))
                return false;
    return true;
}

/// Turns a unit normal of the index axes scaled by spacing, as if these were perpendicular, into world space: it stays
/// a unit vector only if they are. A normal is a gradient: of oblique axes the inverse, transposed, turns it.
inline glm::dmat3 normalToWorld(const GridGeometry& geometry) {
    return hasOrthogonalAxes(geometry) ? geometry.direction : glm::transpose(glm::inverse(geometry.direction));
}

} // namespace isoslider
