#pragma once

#include <cstdint>

namespace isoslider::extract {

/// How far merged cells may lead the surface astray. Of an active edge in a merged cell: the greater difference, at its
/// ends, between the sample and the merged cell's trilinear interpolant.
struct MergeBound {
    enum class Measure : std::uint8_t {
        Scalar, ///< that difference itself; PAPER 2.2, where it is given as a percentage of the value range
        Distance, ///< divided by the length of the interpolant's gradient at the edge's middle: cells
    };
    Measure measure = Measure::Scalar;
    double limit = 0.0; ///< 0: nothing is merged
};

} // namespace isoslider::extract
