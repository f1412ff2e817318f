#pragma once

#include "core/base/job_control.h"
#include "core/extract/surface_mesh.h"

namespace isoslider::extract {

/// Closes a surface at the sides of its grid: adds the faces in which all that is at or above the isovalue meets the
/// grid's sides. Their boundary is that of the surface, vertex by vertex; the other vertices are grid points. Which
/// grid points are inside follows from the surface alone: signs change across its vertices and nowhere else. REQUIRES:
/// no cells are merged. O(triangles * log + grid points of the sides). Errors: Cancelled; InvalidArgument: there is no
/// surface, or it is open elsewhere, as beside missing values. After an error the mesh is as before.
Status closeAtSides(SurfaceMesh& mesh, const JobControl& job = {});

} // namespace isoslider::extract
