#pragma once

#include <cstdint>
#include <type_traits>

#include "core/grid/scalar_type.h"

namespace isoslider::extract {

/// Place of the isovalue on an edge whose ends have scalars s1 and s2: 0 at the lower grid point,
/// 1 at the upper. Always in [0, 1], also when the difference overflows or is denormal: a NaN falls
/// through the first comparison to 0. The same arithmetic in full extraction and in sliding, so that
/// equal surfaces have equal bytes.
template <class Live>
inline Live edgeFraction(Live s1, Live s2, Live isovalue) {
    Live t = (isovalue * Live(0.5) - s1 * Live(0.5)) / (s2 * Live(0.5) - s1 * Live(0.5));
    t = t > Live(0) ? t : Live(0);
    t = t < Live(1) ? t : Live(1);
    return t;
}

/// What samples live as: float where it holds every one exactly, double otherwise.
template <class Sample>
using LiveOf = std::conditional_t<std::is_same_v<Sample, std::int32_t> || std::is_same_v<Sample, double>, double, float>;

/// The same, asked of a type.
inline bool needsDoubleScalars(ScalarType type) {
    return type == ScalarType::I32 || type == ScalarType::F64;
}

} // namespace isoslider::extract
