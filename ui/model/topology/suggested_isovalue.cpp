#include "ui/model/topology/suggested_isovalue.h"

#include <algorithm>

#include "ui/model/isovalue/number_text.h"

namespace isoslider::model {

std::vector<SuggestedIsovalue> suggestedIsovalues(const std::vector<topology::Suggestion>& ofTopology,
                                                  std::optional<double> ofHistogram, double min, double max) {
    std::vector<SuggestedIsovalue> suggested;
    const auto add = [&](double isovalue, const char* reason) {
        const auto hasReason = [reason](const SuggestedIsovalue& other) { return other.reason == reason; };
        if (isovalue >= min && isovalue <= max && std::none_of(suggested.begin(), suggested.end(), hasReason))
            suggested.push_back({isovalue, reason});
    };
    // Where the enclosed volume stays the same for a while, many isovalues have one reason.
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
