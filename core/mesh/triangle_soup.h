#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

#include "core/extract/surface_mesh.h"

namespace isoslider::mesh {

using Triangle = std::array<std::uint32_t, 3>;

/// Triangles as given, in world space, with nothing repaired: what checks and exports start from.
struct TriangleSoup {
    std::vector<glm::dvec3> positions;
    std::vector<glm::vec3> normals; ///< unit, one per position, or empty
    std::vector<Triangle> triangles;
};

/// A surface in world space: spacing, direction and origin applied in double precision, triangles
/// of a left-handed geometry wound the other way so that they face the same side in space. Vertices of
/// a mesh with edge ids are held 1/2048 of a cell off the grid points, so that no triangle is without
/// area where the isovalue is a sample's.
TriangleSoup worldSoup(const extract::SurfaceMesh& mesh);

/// Drops the vertices that no triangle uses; the others keep their order.
void dropUnusedVertices(TriangleSoup& soup);

/// Gives vertices at exactly equal positions one index, that of the first. For formats that store
/// every corner on its own. -0 and +0 are equal.
void weldEqualPositions(TriangleSoup& soup);

/// True when no index repeats.
inline bool hasThreeVertices(const Triangle& t) { return t[0] != t[1] && t[1] != t[2] && t[2] != t[0]; }

} // namespace isoslider::mesh
