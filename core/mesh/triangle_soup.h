#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

#include "core/base/job_control.h"
#include "core/extract/surface_mesh.h"

namespace isoslider::mesh {

using Triangle = std::array<std::uint32_t, 3>;

/// Triangles as given, in world space, with nothing repaired: what checks and exports start from.
struct TriangleSoup {
    std::vector<glm::dvec3> positions;
    std::vector<glm::vec3> normals; ///< unit, one per position, or empty
    std::vector<Triangle> triangles;
};

/// An edge id taken apart: the grid point at its lower end, and its axis.
struct GridEdge {
    std::array<std::int64_t, 3> lower;
    int axis = 0;
};
GridEdge gridEdge(extract::EdgeId edge, const GridDims& dims);

/// Vertices on grid edges are held this far, in cells, off both grid points. At an isovalue that samples
/// have, all vertices round such a grid point would lie on it: triangles without area, and one point for
/// many vertices in formats that store corners. So held, every vertex has a separate place, still on its
/// edge; no triangle is added, lost or turned. Inner vertices of cells stay where they are.
inline constexpr double kLeastDistance = 1.0 / 2048;

/// A surface in world space: spacing, direction and origin applied in double precision, triangles
/// of a left-handed geometry wound the other way so that they face the same side in space, vertices
/// held off the grid points by kLeastDistance.
TriangleSoup worldSoup(const extract::SurfaceMesh& mesh);

/// What holding vertices off the grid points moves.
struct Nudge {
    std::uint64_t vertices = 0; ///< moved, and used by a triangle
    double largestCells = 0.0; ///< farthest move of any of them
    double largestWorld = 0.0; ///< the same in world units
};

Nudge nudgeOf(const extract::SurfaceMesh& mesh);

/// Drops the vertices that no triangle uses; the others keep their order.
void dropUnusedVertices(TriangleSoup& soup);

/// Gives vertices at exactly equal positions one index, that of the first. For formats that store
/// every corner on its own. -0 and +0 are equal. Errors: Cancelled.
Status weldEqualPositions(TriangleSoup& soup, const JobControl& job = {});

/// True when no index repeats.
inline bool hasThreeVertices(const Triangle& t) { return t[0] != t[1] && t[1] != t[2] && t[2] != t[0]; }

} // namespace isoslider::mesh
