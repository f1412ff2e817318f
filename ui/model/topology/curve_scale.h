#pragma once

#include <span>
#include <vector>

namespace isoslider::model {

/// Values of one curve as heights from 0 to 1, where 1 is the greatest value.
struct ScaledCurve {
    std::vector<double> heights; ///< one for each value; 0 for what is negative or not a number
    bool isLogarithmic = false; ///< the greatest is more than 1000 times the least above 0
};
ScaledCurve scaled(std::span<const double> values);

} // namespace isoslider::model
