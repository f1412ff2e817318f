#include "core/grid/grid_geometry.h"

#include <glm/matrix.hpp>

namespace isoslider {

bool GridGeometry::isLeftHanded() const {
    return glm::determinant(direction) * spacing.x * spacing.y * spacing.z < 0.0;
}

glm::dmat4 GridGeometry::indexToWorld() const {
    glm::dmat4 map(1.0);
    for (int axis = 0; axis < 3; ++axis)
        map[axis] = glm::dvec4(direction[axis] * spacing[axis], 0.0);
    map[3] = glm::dvec4(origin, 1.0);
    return map;
}

} // namespace isoslider
