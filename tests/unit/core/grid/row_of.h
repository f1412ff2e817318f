#pragma once

#include <cstdint>
#include <vector>

#include "core/grid/scalar_grid.h"

namespace isoslider::test {

/// A grid of one row with these values.
template <class T>
ScalarGrid rowOf(ScalarType type, const std::vector<T>& values) {
    GridGeometry geometry;
    geometry.dims = {static_cast<std::int64_t>(values.size()), 1, 1};
    return ScalarGrid::fromValues<T>(geometry, type, values);
}

} // namespace isoslider::test
