#pragma once

#include <cmath>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "core/extract/full_extraction.h"
#include "core/extract/surface_frame.h"
#include "core/grid/scalar_grid.h"

namespace isoslider::test {

inline GridGeometry cubeGeometry(std::int64_t points) {
    GridGeometry geometry;
    geometry.dims = {points, points, points};
    return geometry;
}

/// -distance from the middle of a cube: the isosurface at -r is a sphere of radius r cells.
inline ScalarGrid ballGrid(const GridGeometry& geometry) {
    std::vector<float> values;
    const auto points = static_cast<int>(geometry.dims[0]);
    const float middle = static_cast<float>(points - 1) / 2.0f;
    for (int z = 0; z < points; ++z)
        for (int y = 0; y < points; ++y)
            for (int x = 0; x < points; ++x)
                values.push_back(-std::hypot(static_cast<float>(x) - middle, static_cast<float>(y) - middle,
                                             static_cast<float>(z) - middle));
    return ScalarGrid::fromValues<float>(geometry, ScalarType::F32, values);
}

/// Of arrays. `radius` in cells.
inline std::shared_ptr<extract::SurfaceFrame> sphereFrame(const GridGeometry& geometry, double radius) {
    auto mesh = extract::extractFull(ballGrid(geometry), -radius).value();
    auto frame = std::make_shared<extract::SurfaceFrame>();
    frame->geometry = geometry;
    frame->isovalue = -radius;
    frame->positions = std::move(mesh.positions);
    frame->normals = std::move(mesh.normals);
    frame->indices = std::move(mesh.triangles);
    frame->stats.triangles = frame->indices.size() / 3;
    return frame;
}

} // namespace isoslider::test
