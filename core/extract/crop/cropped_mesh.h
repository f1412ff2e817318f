#pragma once

#include <array>
#include <cstdint>
#include <span>

#include <glm/vec4.hpp>

#include "core/base/job_control.h"
#include "core/extract/surface_mesh.h"

namespace isoslider::extract {

/// Whole cells of a grid: those between two grid points along each axis.
struct CellBox {
    std::array<std::int64_t, 3> low{}, high{};
};

/// Where a surface leaves the box: left open, or closed by faces in the box's sides, so that the mesh bounds all that
/// is at or above the isovalue in the box.
enum class BoxSides { Open, Closed };

/// The surface of the volume cropped to a box: of a grid of the box's points alone, with their places in the world. A
/// closed one is manifold where the mesh is; vertices of its faces at grid points come last, as inner ones.
/// REQUIRES: low < high along each axis, within the grid. O(triangles of the box * log + grid points of its sides).
/// Errors: Cancelled; InvalidArgument: cells are merged, or, to be closed, there is no surface in the box, or it is
/// open elsewhere than at its sides, as beside missing values.
Result<SurfaceMesh> cropMesh(const SurfaceMesh& mesh, const CellBox& box, BoxSides sides, const JobControl& job = {});

/// What of the mesh lies in all half-spaces: dot(xyz, place) + w >= 0 in grid index units. Triangles are cut where a
/// half-space ends, and left open there; triangles that share an edge share the vertex that cuts it. Edge ids are lost:
/// all vertices count as inner ones. Errors: Cancelled.
Result<SurfaceMesh> cutMesh(const SurfaceMesh& mesh, std::span<const glm::dvec4> halfSpaces,
                            const JobControl& job = {});

} // namespace isoslider::extract
