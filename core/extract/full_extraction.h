#pragma once

#include "core/base/job_control.h"
#include "core/extract/surface_mesh.h"
#include "core/grid/scalar_grid.h"

namespace isoslider::extract {

/// Extracts the isosurface of a whole volume in memory, every cell looked at. Shares with the slide
/// engine only the case table: it is the oracle that sliding is compared with, and gives the first
/// picture before an index exists. Cells with a missing corner make no geometry.
/// O(grid points), both cores. Vertices and triangles come in grid order, the same for any thread
/// count. Errors: Cancelled; OutOfSpace if vertices exceed 2^32.
Result<SurfaceMesh> extractFull(const ScalarGrid& grid, double isovalue, const JobControl& job = {});

} // namespace isoslider::extract
