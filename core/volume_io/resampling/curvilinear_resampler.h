#pragma once

#include <vector>

#include "core/base/job_control.h"
#include "core/grid/scalar_grid.h"

namespace isoslider::io {

/// A grid of hexahedral cells whose points lie anywhere, i fastest, as flow solvers make them.
struct CurvilinearGrid {
    GridDims dims{0, 0, 0};
    std::vector<glm::dvec3> points; ///< one per grid point
    std::vector<float> values; ///< one per grid point
};

/// The uniform grid of `dims` points that spans the bounding box of `points`, spaced axis by axis.
GridGeometry boundingGeometry(const std::vector<glm::dvec3>& points, const GridDims& dims);

/// Samples a curvilinear grid at the points of a uniform one: in each cell the trilinear map from
/// its unit cube is inverted, and the values are interpolated there. Points in no cell become NaN;
/// where cells overlap the first one counts. Type f32. The same result for any number of threads.
/// REQUIRES: at least two points along each axis of `grid`. O(output points + cells).
/// Errors: Cancelled.
Result<ScalarGrid> resampleCurvilinear(const CurvilinearGrid& grid, const GridGeometry& geometry,
                                       const JobControl& job = {});

} // namespace isoslider::io
