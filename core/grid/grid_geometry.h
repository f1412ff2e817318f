#pragma once

#include <array>
#include <cstdint>

#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

namespace isoslider {

/// Number of grid points along x, y, z. Samples lie x fastest: index = x + nx * (y + ny * z).
using GridDims = std::array<std::int64_t, 3>;

inline std::int64_t pointCount(const GridDims& dims) { return dims[0] * dims[1] * dims[2]; }

/// Largest number of grid points along one axis, and in all, that any part of the program accepts.
inline constexpr std::int64_t kMaxDim = std::int64_t{1} << 20;
inline constexpr std::int64_t kMaxPoints = std::int64_t{1} << 40;

/// A uniform grid in space. World position of grid point i = origin + direction * (spacing * i).
/// `direction` has the unit axis vectors as columns; its determinant may be negative (left-handed).
struct GridGeometry {
    GridDims dims{0, 0, 0};
    glm::dvec3 spacing{1.0};
    glm::dvec3 origin{0.0};
    glm::dmat3 direction{1.0};

    /// True when the map from index to world mirrors: triangles must then be wound the other way.
    bool isLeftHanded() const;
    /// Affine map from grid index space (units of cells) to world space (units of the file).
    glm::dmat4 indexToWorld() const;

    bool operator==(const GridGeometry&) const = default;
};

/// Puts axes perpendicular to the first `known` columns (1 to 3, unit vectors) in place of the others, right-handed.
void completeAxes(glm::dmat3& direction, int known);

} // namespace isoslider
