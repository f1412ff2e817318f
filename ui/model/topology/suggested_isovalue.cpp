#include "ui/model/topology/suggested_isovalue.h"

#include <algorithm>
#include <cmath>

#include "ui/model/isovalue/number_text.h"

namespace isoslider::model {

double suggestedAs(double isovalue, const SuggestedRange& range) {
    if (isFloatType(range.type))
        return isovalue;
    const double next = std::ceil(isovalue);
    const bool areFew = range.max - range.min + 1.0 < kFewWholeValues;
    return std::clamp(areFew ? next - 0.5 : next, range.min, range.max);
}

std::vector<SuggestedIsovalue> suggestedIsovalues(const std::vector<topology::Suggestion>& ofTopology,
                                                  std::optional<double> ofHistogram, const SuggestedRange& range) {
    std::vector<SuggestedIsovalue> suggested;
    const auto add = [&](double isovalue, const char* reason) {
        const auto hasReason = [reason](const SuggestedIsovalue& other) { return other.reason == reason; };
        if (isovalue >= range.min && isovalue <= range.max &&
            std::none_of(suggested.begin(), suggested.end(), hasReason))
            suggested.push_back({suggestedAs(isovalue, range), reason});
    };
    // Where the volume above stays the same for a while, many isovalues have one reason.
    for (const topology::Suggestion& one : ofTopology)
        add(one.isovalue, topology::reasonText(one.reason));
    if (ofHistogram)
        add(*ofHistogram, kHistogramReason);
    return suggested;
}

std::string suggestionText(const SuggestedIsovalue& suggested) {
    return valueText(suggested.isovalue, 7) + ": " + suggested.reason;
}

} // namespace isoslider::model
