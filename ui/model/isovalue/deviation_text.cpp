#include "ui/model/isovalue/deviation_text.h"

#include <cmath>

#include "ui/model/isovalue/number_text.h"

namespace isoslider::model {
namespace {

constexpr int kSpreadTextFigures = 6;
constexpr double kSteps = 1000.0; // of a deviation

std::string aboutMark(const ValueSpread& spread) { return spread.isExact ? "" : "\xE2\x89\x88 "; } // ≈

} // namespace

std::optional<AskedIsovalue> isovalueFrom(std::string_view text) { return askedIsovalueFrom(text, numberFrom); }

std::string deviationsText(double isovalue, const ValueSpread& spread) {
    if (!(spread.deviation > 0.0))
        return {};
    const double deviations = spread.deviationsOf(isovalue);
    const std::string number = valueText(std::round(std::abs(deviations) * kSteps) / kSteps, kSpreadTextFigures);
    return aboutMark(spread) + "mean " + (deviations < 0.0 ? "\xE2\x88\x92 " : "+ ") + number + " \xCF\x83"; // − and σ
}

std::string spreadText(const ValueSpread& spread) {
    return aboutMark(spread) + valueText(spread.mean, kSpreadTextFigures) + " \xC2\xB1 " + // ±
           valueText(spread.deviation, kSpreadTextFigures);
}

} // namespace isoslider::model
