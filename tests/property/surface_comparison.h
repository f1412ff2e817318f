#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "core/extract/edge_interpolation.h"
#include "core/extract/surface_frame.h"
#include "core/extract/surface_mesh.h"
#include "core/grid/gradient.h"
#include "core/grid/normal_codec.h"
#include "core/grid/scalar_grid.h"

namespace isoslider::test {

/// Same vertices at the same places with the same normals, and the same triangles, in the same order, bit for bit.
inline testing::AssertionResult isSameSurface(const extract::SurfaceMesh& slid, const extract::SurfaceMesh& fresh) {
    if (slid.edgeIds != fresh.edgeIds)
        return testing::AssertionFailure()
               << "active edges differ: " << slid.edgeIds.size() << " slid, " << fresh.edgeIds.size() << " fresh";
    if (slid.triangles != fresh.triangles)
        return testing::AssertionFailure()
               << "triangles differ: " << slid.triangleCount() << " slid, " << fresh.triangleCount() << " fresh";
    if (slid.positions.size() != fresh.positions.size() || slid.normals.size() != slid.positions.size())
        return testing::AssertionFailure() << "array lengths differ";
    for (std::size_t i = 0; i < slid.positions.size(); ++i)
        if (slid.positions[i] != fresh.positions[i])
            return testing::AssertionFailure()
                   << "position " << i << " differs by " << glm::length(slid.positions[i] - fresh.positions[i])
                   << (i < slid.edgeIds.size() ? ", on an edge" : ", inside a cell");
    for (std::size_t i = 0; i < slid.normals.size(); ++i)
        if (slid.normals[i] != fresh.normals[i])
            return testing::AssertionFailure()
                   << "normal " << i << " differs by " << glm::length(slid.normals[i] - fresh.normals[i])
                   << (i < slid.edgeIds.size() ? ", on an edge" : ", inside a cell");
    return testing::AssertionSuccess();
}

/// Each active edge once, in order.
inline std::vector<extract::EdgeId> distinctEdges(const extract::SurfaceMesh& mesh) {
    std::vector<extract::EdgeId> edges = mesh.edgeIds;
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
    return edges;
}

/// The normal that 16-bit normals at both ends of an edge give; zero where it is badly conditioned.
inline glm::vec3 expectedNormal(const ScalarGrid& grid, extract::EdgeId edge, const glm::vec3& position) {
    const auto axis = static_cast<int>(edge % 4);
    const auto point = static_cast<std::int64_t>(edge / 4);
    const GridDims& dims = grid.dims();
    std::int64_t p[3] = {point % dims[0], point / dims[0] % dims[1], point / (dims[0] * dims[1])};
    const float t = position[axis] - static_cast<float>(p[axis]);
    glm::vec3 inverseSpacing;
    for (int a = 0; a < 3; ++a)
        inverseSpacing[a] = static_cast<float>(1.0 / std::abs(grid.geometry().spacing[a]));
    return grid.visit([&](auto values) {
        const SampleView<std::remove_cv_t<typename decltype(values)::element_type>> view{values.data(), dims};
        const auto direction = [&] {
            return decodeDirection(normalOfGradient(gradientAt(view, p[0], p[1], p[2], inverseSpacing)));
        };
        const glm::vec3 first = direction();
        ++p[axis];
        const glm::vec3 second = direction();
        const glm::vec3 sum = first + t * (second - first);
        return glm::dot(sum, sum) < 0.01f ? glm::vec3(0.0f) : sum / std::sqrt(glm::dot(sum, sum));
    });
}

/// Unit normals everywhere; as expectedNormal() where that is defined.
inline testing::AssertionResult hasExpectedNormals(const extract::SurfaceMesh& mesh, const ScalarGrid& grid) {
    for (std::size_t i = 0; i < mesh.normals.size(); ++i) {
        const glm::vec3& normal = mesh.normals[i];
        if (!(std::abs(glm::dot(normal, normal) - 1.0f) < 1e-4f))
            return testing::AssertionFailure() << "normal " << i << " has length " << glm::length(normal);
        if (i >= mesh.edgeIds.size())
            continue; // inside a cell
        const glm::vec3 expected = expectedNormal(grid, mesh.edgeIds[i], mesh.positions[i]);
        if (expected != glm::vec3(0.0f) && !(glm::length(normal - expected) < 2e-3f))
            return testing::AssertionFailure()
                   << "normal of edge " << mesh.edgeIds[i] << " is off by " << glm::length(normal - expected);
    }
    return testing::AssertionSuccess();
}

/// A triangle as three places, smallest first, turned and not mirrored.
using PlacedTriangle = std::array<std::array<float, 3>, 3>;

inline PlacedTriangle placed(const std::vector<glm::vec3>& positions, const std::uint32_t* indices) {
    PlacedTriangle triangle;
    for (std::size_t k = 0; k < 3; ++k)
        triangle[k] = {positions[indices[k]].x, positions[indices[k]].y, positions[indices[k]].z};
    std::rotate(triangle.begin(), std::min_element(triangle.begin(), triangle.end()), triangle.end());
    return triangle;
}

/// Sorted; triples that repeat an index are room between the runs and left out.
inline std::vector<PlacedTriangle> placedTriangles(const std::vector<glm::vec3>& positions,
                                                   const std::vector<std::uint32_t>& indices) {
    std::vector<PlacedTriangle> triangles;
    for (std::size_t i = 0; i + 3 <= indices.size(); i += 3) {
        const std::uint32_t* t = indices.data() + i;
        if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0])
            triangles.push_back(placed(positions, t));
    }
    std::sort(triangles.begin(), triangles.end());
    return triangles;
}

} // namespace isoslider::test
