#pragma once

#include <cmath>
#include <numbers>

#include "core/extract/surface_mesh.h"

namespace isoslider::test {

inline extract::SurfaceMesh makeMesh(std::vector<glm::vec3> positions, std::vector<std::uint32_t> triangles) {
    extract::SurfaceMesh mesh;
    mesh.geometry.dims = {64, 64, 64};
    mesh.positions = std::move(positions);
    mesh.triangles = std::move(triangles);
    mesh.normals.assign(mesh.positions.size(), glm::vec3(0, 0, 1));
    return mesh;
}

// Outward: counter-clockwise seen from outside. Volume 1/6.
inline extract::SurfaceMesh tetrahedron() {
    return makeMesh({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3});
}

// Six vertices on the edges round grid point (3, 3, 3), whose scalar is the isovalue: all at that point.
inline extract::SurfaceMesh octahedronAtATie() {
    auto mesh = makeMesh(std::vector<glm::vec3>(6, {3, 3, 3}),
                         {0, 1, 2, 1, 3, 2, 3, 4, 2, 4, 0, 2, 1, 0, 5, 3, 1, 5, 4, 3, 5, 0, 4, 5});
    const auto edge = [&](int x, int y, int z, int axis) {
        const auto point = static_cast<std::uint64_t>(x + mesh.geometry.dims[0] * (y + mesh.geometry.dims[1] * z));
        return 4 * point + static_cast<std::uint64_t>(axis);
    };
    // Towards +x, +y, +z, -x, -y, -z of the point.
    mesh.edgeIds = {edge(3, 3, 3, 0), edge(3, 3, 3, 1), edge(3, 3, 3, 2),
                    edge(2, 3, 3, 0), edge(3, 2, 3, 1), edge(3, 3, 2, 2)};
    return mesh;
}

inline extract::SurfaceMesh twoTetrahedra() {
    auto mesh = tetrahedron();
    for (int i = 0; i < 4; ++i)
        mesh.positions.push_back(mesh.positions[static_cast<std::size_t>(i)] + glm::vec3(5, 0, 0));
    for (int i = 0; i < 12; ++i)
        mesh.triangles.push_back(mesh.triangles[static_cast<std::size_t>(i)] + 4);
    mesh.normals.resize(8, glm::vec3(0, 0, 1));
    return mesh;
}

inline extract::SurfaceMesh torus(std::uint32_t around, std::uint32_t across) {
    extract::SurfaceMesh mesh;
    mesh.geometry.dims = {64, 64, 64};
    for (std::uint32_t i = 0; i < around; ++i)
        for (std::uint32_t j = 0; j < across; ++j) {
            const double u = 2 * std::numbers::pi * i / around, v = 2 * std::numbers::pi * j / across;
            const glm::dvec3 outward{std::cos(u) * std::cos(v), std::sin(u) * std::cos(v), std::sin(v)};
            mesh.positions.emplace_back(glm::dvec3(20 + 10 * std::cos(u), 20 + 10 * std::sin(u), 20) + 3.0 * outward);
            mesh.normals.emplace_back(outward);
            const std::uint32_t i1 = (i + 1) % around, j1 = (j + 1) % across;
            const std::uint32_t a = i * across + j, b = i1 * across + j, c = i1 * across + j1, d = i * across + j1;
            mesh.triangles.insert(mesh.triangles.end(), {a, b, c, a, c, d});
        }
    return mesh;
}

// Six triangles around a middle vertex.
inline extract::SurfaceMesh openDisk() {
    auto mesh = makeMesh({{2, 2, 0}}, {});
    for (std::uint32_t i = 0; i < 6; ++i) {
        const double angle = std::numbers::pi * i / 3;
        mesh.positions.emplace_back(2 + std::cos(angle), 2 + std::sin(angle), 0);
        mesh.triangles.insert(mesh.triangles.end(), {0u, 1 + i, 1 + (i + 1) % 6});
    }
    mesh.normals.assign(7, glm::vec3(0, 0, 1));
    return mesh;
}

// Two triangles that share one vertex only.
inline extract::SurfaceMesh bowTie() {
    return makeMesh({{1, 1, 0}, {0, 0, 0}, {0, 2, 0}, {2, 0, 0}, {2, 2, 0}}, {0, 2, 1, 0, 3, 4});
}

// Three triangles on the edge 0-1, like the pages of a book.
inline extract::SurfaceMesh bookOfThree() {
    return makeMesh({{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {-1, 1, 0}, {-1, -1, 0}}, {0, 1, 2, 1, 0, 3, 0, 1, 4});
}

} // namespace isoslider::test
