#pragma once

#include <vector>

#include <glm/vec3.hpp>

#include "core/extract/slices/slice_plane.h"

namespace isoslider::render {

// Points of slices and caps as they lie in a buffer: a place in index units, a place in the texture.
inline constexpr int kFloatsPerPoint = 5;
inline constexpr int kQuadPoints = 4;

inline void addPoint(std::vector<float>& data, const glm::dvec3& place, double s = 0.0, double t = 0.0) {
    for (const double part : {place.x, place.y, place.z, s, t})
        data.push_back(static_cast<float>(part));
}

/// As a strip of triangles, from pixel middle to pixel middle: a slice ends where the volume does.
inline void addQuad(std::vector<float>& data, const extract::SlicePlane& plane) {
    for (const int row : {0, plane.height - 1})
        for (const int column : {0, plane.width - 1})
            addPoint(data, plane.at(column, row), (column + 0.5) / plane.width, (row + 0.5) / plane.height);
}

} // namespace isoslider::render
