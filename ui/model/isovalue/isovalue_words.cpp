#include "ui/model/isovalue/isovalue_words.h"

#include "ui/model/isovalue/number_text.h"

namespace isoslider::model {

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
