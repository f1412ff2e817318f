#include "ui/model/surface/scale_bar.h"

#include <cmath>

namespace isoslider::model {
namespace {

constexpr double kShortest = 1e-200, kLongest = 1e200;

/// Of a decimal number the nearest double: tenths are not added up of inexact ones.
double decimal(int digit, int exponent) {
    const double power = std::pow(10.0, std::abs(exponent));
    return exponent < 0 ? digit / power : digit * power;
}

} // namespace

std::optional<ScaleBar> scaleBarOf(double lengthPerPixel, double mostPixels) {
    const double longest = lengthPerPixel * mostPixels;
    if (!(lengthPerPixel > 0.0 && mostPixels > 0.0 && longest >= kShortest && longest <= kLongest))
        return std::nullopt;
    // What the logarithm loses may be a whole power.
    int exponent = static_cast<int>(std::floor(std::log10(longest))) + 1;
    while (decimal(1, exponent) > longest)
        --exponent;
    int digit = 1;
    for (const int larger : {2, 5})
        if (decimal(larger, exponent) <= longest)
            digit = larger;
    const double length = decimal(digit, exponent);
    return ScaleBar{length, length / lengthPerPixel};
}

} // namespace isoslider::model
