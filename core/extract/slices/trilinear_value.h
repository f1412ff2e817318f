#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include <glm/vec3.hpp>

#include "core/grid/grid_geometry.h"

namespace isoslider::extract {

/// The cell in which a place lies, and where in it.
struct PlaceInCell {
    std::array<std::int64_t, 3> low{}; ///< the cell's first grid point
    std::array<double, 3> part{}; ///< 0: at the first grid point, and only it counts along this axis
    bool isInside = false;
};

/// A place within rounding of a plane of grid points is on it, and one within rounding of the grid is inside.
inline PlaceInCell cellOf(const glm::dvec3& place, const GridDims& dims) {
    constexpr double kRounding = 1e-7; // cells; far below a pixel, far above the rounding of an oblique plane
    PlaceInCell cell;
    for (int axis = 0; axis < 3; ++axis) {
        const auto a = static_cast<std::size_t>(axis);
        const double last = static_cast<double>(dims[a] - 1);
        double at = place[axis];
        if (!(at >= -kRounding && at <= last + kRounding))
            return cell;
        const double nearest = std::round(at);
        if (std::abs(at - nearest) <= kRounding)
            at = nearest;
        cell.low[a] = static_cast<std::int64_t>(at);
        cell.part[a] = at - static_cast<double>(cell.low[a]);
    }
    cell.isInside = true;
    return cell;
}

/// `sampleAt(x, y, z)` is asked for those corners only that count. NaN where one of them is missing.
template <class SampleAt>
float trilinearValue(const PlaceInCell& cell, const SampleAt& sampleAt) {
    double sum = 0.0;
    for (std::int64_t corner = 0; corner < 8; ++corner) {
        double weight = 1.0;
        std::array<std::int64_t, 3> at = cell.low;
        for (std::size_t a = 0; a < 3; ++a) {
            const bool isUpper = (corner >> a & 1) != 0;
            at[a] += isUpper ? 1 : 0;
            weight *= isUpper ? cell.part[a] : 1.0 - cell.part[a];
        }
        if (weight == 0.0)
            continue;
        const auto sample = static_cast<double>(sampleAt(at[0], at[1], at[2]));
        if (!std::isfinite(sample))
            return std::numeric_limits<float>::quiet_NaN();
        sum += weight * sample;
    }
    return static_cast<float>(sum);
}

} // namespace isoslider::extract
