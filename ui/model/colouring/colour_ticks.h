#pragma once

#include <string>
#include <vector>

namespace isoslider::model {

/// A round number on a colour bar.
struct ColourTick {
    double value = 0.0;
    std::string text;
};

/// Multiples of 1, 2 or 5 times a power of ten within a range, ascending, as many as there may be at most. None where
/// numbers have no such distance: the range is empty, not finite or too narrow for doubles. REQUIRES: most >= 2.
std::vector<ColourTick> colourTicks(double low, double high, int most);

} // namespace isoslider::model
