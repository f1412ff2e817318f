#include "ui/model/isovalue/isovalue_words.h"

#include <algorithm>
#include <cmath>

#include "ui/model/isovalue/number_text.h"

namespace isoslider::model {

std::string isovalueText(double isovalue, double min, double max, int digits) {
    constexpr double kMostFigures = 15.0; // all that decimals keep
    const double half = max / 2.0 - min / 2.0; // max - min of a full f64 range overflows
    const double size = std::max(std::abs(min), std::abs(max)) / 2.0;
    if (!(half > 0.0) || !std::isfinite(size / half))
        return valueText(isovalue, digits);
    const double further = std::max(0.0, std::floor(std::log10(size / half)) - 1.0); // one digit is to spare
    return valueText(isovalue, static_cast<int>(std::min(digits + further, kMostFigures)));
}

std::string clampedText(double asked, double min, double max) {
    if (asked > max)
        return exactText(asked) + " is above all samples; the greatest, " + exactText(max) + ", was taken";
    if (asked < min)
        return exactText(asked) + " is below all samples; the least, " + exactText(min) + ", was taken";
    return {};
}

std::string emptySurfaceText(double isovalue, double min, double max, bool hasCells) {
    if (!hasCells)
        return "The volume is one sample thick, so it has no surface at any isovalue; the Slices menu shows its samples";
    const std::string at = "No surface at " + exactText(isovalue) + ": ";
    if (min == max)
        return at + "every sample has this value";
    if (isovalue > max)
        return at + "every sample is below; choose a lower isovalue";
    if (isovalue <= min)
        return at + "no sample is below; choose a higher isovalue";
    return at + "it crosses no cell whose corners all have values; choose another isovalue";
}

} // namespace isoslider::model
