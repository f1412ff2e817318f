#pragma once

#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

#include "core/extract/merged/merge_bound.h"
#include "core/grid/grid_geometry.h"

namespace isoslider::extract {

/// Names a grid edge: 4 * (index of its lower grid point, x fastest) + axis (0 x, 1 y, 2 z).
using EdgeId = std::uint64_t;

/// A whole indexed isosurface, for export, checks and comparison. First one vertex per active edge (two where
/// cells only touch beside missing values, see vertex_fans.h), in edge id order, then the inner vertices of cells that
/// need some (core/cell/cell_states.h), in cell order. Triangles are counter-clockwise seen from the side below the
/// isovalue, in grid index space (right-handed); writers that map to world space with a left-handed geometry flip them.
struct SurfaceMesh {
    GridGeometry geometry;
    double isovalue = 0.0;
    MergeBound mergeBound; ///< within which its cells are merged
    std::vector<glm::vec3> positions; ///< grid index units: (x, y, z) in cells from grid point 0
    std::vector<glm::vec3> normals; ///< unit, along the grid's axes, towards lower scalars
    std::vector<std::uint32_t> triangles; ///< three vertex indices each
    std::vector<EdgeId> edgeIds; ///< of the first edgeIds.size() vertices; the others are inner ones

    std::size_t triangleCount() const { return triangles.size() / 3; }
    /// Distinct edge ids. O(n).
    std::size_t activeEdgeCount() const;
};

} // namespace isoslider::extract
