#pragma once

#include <vector>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace isoslider::extract {

/// A rectangle of pixels across a grid: the middle of a pixel lies at origin + column * right + row * down, in grid
/// index units.
struct SlicePlane {
    glm::dvec3 origin{0.0};
    glm::dvec3 right{1.0, 0.0, 0.0};
    glm::dvec3 down{0.0, 1.0, 0.0};
    int width = 0;
    int height = 0;

    glm::dvec3 at(double column, double row) const { return origin + column * right + row * down; }
    /// Perpendicular to it in index space; not of unit length.
    glm::dvec3 normal() const { return glm::cross(right, down); }
    /// In units of a grid with every `step`-th point.
    SlicePlane onEvery(double step) const { return {origin / step, right / step, down / step, width, height}; }

    bool operator==(const SlicePlane&) const = default;
};

/// What a volume has on a plane.
struct SliceSamples {
    SlicePlane plane;
    std::vector<float> values; ///< in rows; NaN outside the grid and where a sample is missing
};

} // namespace isoslider::extract
