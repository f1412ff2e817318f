#include "core/grid/grid_geometry.h"

#include <cmath>

#include <glm/geometric.hpp>
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

void completeAxes(glm::dmat3& direction, int known) {
    if (known == 1) {
        const glm::dvec3& first = direction[0];
        glm::dvec3 other(0.0); // the least parallel of y, z and x
        for (const int axis : {0, 2, 1})
            if (other == glm::dvec3(0.0) || std::abs(first[axis]) <= std::abs(glm::dot(first, other))) {
                other = glm::dvec3(0.0);
                other[axis] = 1.0;
            }
        direction[1] = glm::normalize(other - glm::dot(first, other) * first);
    }
    if (known < 3)
        direction[2] = glm::normalize(glm::cross(direction[0], direction[1]));
}

} // namespace isoslider
