#pragma once

#include <cmath>
#include <type_traits>

namespace isoslider {

/// The sign convention of the whole program: a grid point is *above* when `scalar >= isovalue`, so
/// the surface at an isovalue is the limit from below. DEVIATION: the paper assumes strict order
/// inside a cell and closed activity intervals; with ours a sample value is an isovalue like any other.
template <class Sample>
inline bool isAbove(Sample scalar, double isovalue) {
    return static_cast<double>(scalar) >= isovalue;
}

/// Non-finite samples are missing: no cell with such a corner makes geometry.
template <class Sample>
inline bool isMissing(Sample scalar) {
    if constexpr (std::is_floating_point_v<Sample>)
        return !std::isfinite(scalar);
    else
        return false;
}

} // namespace isoslider
