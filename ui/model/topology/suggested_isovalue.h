#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/grid/scalar_type.h"
#include "core/topology/topology_queries.h"

namespace isoslider::model {

/// An isovalue worth a look, and why: "half of the volume is above it".
struct SuggestedIsovalue {
    double isovalue = 0.0;
    std::string reason; ///< empty: it was asked for
    friend bool operator==(const SuggestedIsovalue&, const SuggestedIsovalue&) = default;
};

/// Why model::suggestIsovalue() gives what it gives.
inline constexpr const char* kHistogramReason = "separates the samples best into two groups";

/// The values of a volume that isovalues are suggested for.
struct SuggestedRange {
    double min = 0.0, max = 0.0; ///< without extreme outliers and fill values
    ScalarType type = ScalarType::F32;
};

/// An isovalue as the program suggests it. Of whole numbers the next whole number: the same samples are above it, so
/// pieces and tunnels are the same. Of fewer than kFewWholeValues, as labels are, the middle below that: a surface
/// half-way between two samples instead of through one. [min, max] is not left; others are as they were.
double suggestedAs(double isovalue, const SuggestedRange& range);
inline constexpr double kFewWholeValues = 16.0;

/// The best first: those of the topology, one for each reason, and then that of the histogram, if there is one.
/// Those outside the range are left out: around the one sample that is 1e38 the widest interval is without interest.
std::vector<SuggestedIsovalue> suggestedIsovalues(const std::vector<topology::Suggestion>& ofTopology,
                                                  std::optional<double> ofHistogram, const SuggestedRange& range);

/// "1200: half of the volume is above it"
std::string suggestionText(const SuggestedIsovalue& suggested);

} // namespace isoslider::model
