#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "core/grid/value_spread.h"

namespace isoslider::model {

/// What is typed as an isovalue: a number as people write it (number_text.h), or so many standard deviations above the
/// mean, as in "2.5 sigma", "2,5σ" and "-1 sd". Nothing if it is neither.
std::optional<AskedIsovalue> isovalueFrom(std::string_view text);
/// "mean + 2.5 σ", with ≈ before it where the spread is estimated; empty where no two samples differ.
std::string deviationsText(double isovalue, const ValueSpread& spread);
/// "0.0123 ± 0.0456", mean and standard deviation, with ≈ before them where they are estimated.
std::string spreadText(const ValueSpread& spread);

} // namespace isoslider::model
