#pragma once

#include "core/base/job_control.h"
#include "core/extract/surface_mesh.h"

namespace isoslider::extract {

/// Splits the vertices that only touch at one point: where the two valid cells at an active edge lie opposite each
/// other and the other two have missing corners, both cells' triangles meet in the edge's vertex and in nothing
/// else, and the surface would not be a manifold there. Each fan of triangles gets its own vertex: same
/// place, same normal, same edge id, the fan of the first triangle first. Vertices stay in edge id order.
/// Without missing values nothing is split. O(vertices + triangles), several threads. Errors: Cancelled;
/// the mesh is then unfinished.
Status splitVerticesOfSeveralFans(SurfaceMesh& mesh, const JobControl& job);

} // namespace isoslider::extract
