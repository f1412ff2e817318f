#pragma once

#include <optional>
#include <span>

#include "core/grid/grid_geometry.h"

namespace isoslider::io {

/// The uniform grid that points of a structured grid already are: equal steps along i, j and k, which are
/// perpendicular to each other. None if they are not, within kEvenTolerance of the smallest step, or what single
/// precision leaves of coordinates. `points` are i fastest, as many as `dims` states. O(points).
std::optional<GridGeometry> latticeOf(std::span<const glm::dvec3> points, const GridDims& dims);

/// How far a coordinate may be from its place in a lattice of that step: `farthest` is the largest coordinate of all.
double latticeTolerance(double step, double farthest);

} // namespace isoslider::io
