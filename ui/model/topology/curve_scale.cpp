#include "ui/model/topology/curve_scale.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace isoslider::model {
namespace {

constexpr double kLargestLinearSpan = 1e3;
constexpr double kLargestSpan = 1e9; // what is still less lies on the axis

} // namespace

ScaledCurve scaled(std::span<const double> values) {
    double greatest = 0.0, least = std::numeric_limits<double>::max();
    const auto isDrawn = [](double value) { return value > 0.0 && std::isfinite(value); };
    for (const double value : values)
        if (isDrawn(value)) {
            greatest = std::max(greatest, value);
            least = std::min(least, value);
        }
    ScaledCurve curve;
    curve.isLogarithmic = greatest > 0.0 && greatest / kLargestLinearSpan > least;
    // A value of `least` is to be seen, so the scale begins below it.
    const double decades = std::min(std::log10(greatest) - std::log10(least) + 0.5, std::log10(kLargestSpan));
    for (const double value : values) {
        double height = 0.0;
        if (isDrawn(value))
            height =
                curve.isLogarithmic ? 1.0 + (std::log10(value) - std::log10(greatest)) / decades : value / greatest;
        curve.heights.push_back(std::clamp(height, 0.0, 1.0));
    }
    return curve;
}

} // namespace isoslider::model
