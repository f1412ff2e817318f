#pragma once

#include "core/base/job_control.h"
#include "core/extract/merged/leaf_levels.h"
#include "core/extract/surface_mesh.h"
#include "core/grid/scalar_grid.h"

namespace isoslider::extract {

/// Extracts the isosurface of a volume in memory with merged cells: the leaves of leaf_levels.h instead of the grid's
/// cells, with the same topology and without cracks. The oracle of sliding with merged cells.
///
/// A vertex is named by the one active edge of the grid where its leaf edge changes sign, and lies where the smallest
/// leaf edge that contains this edge crosses the isovalue. A merged cell's polygon follows, on each face, the segments
/// of the finest leaves on either side; it is triangulated inside the cell, without a diagonal in a face.
/// PAPER 2.2, Figs. 6 and 7.
///
/// `leaves`, if not null, receives the number of active leaves of each level. O(cells), all threads.
/// Errors: Cancelled; OutOfSpace if vertices exceed 2^32.
Result<SurfaceMesh> extractMerged(const ScalarGrid& grid, double isovalue, const MergeBound& bound,
                                  int maxLevel = kMaxMergeLevel, const JobControl& job = {},
                                  LeafCounts* leaves = nullptr);

} // namespace isoslider::extract
