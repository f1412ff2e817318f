#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/topology/topology_queries.h"

namespace isoslider::model {

/// An isovalue worth a look, and why: "greatest mean gradient on the surface".
struct SuggestedIsovalue {
    double isovalue = 0.0;
    std::string reason; ///< empty: it was asked for
    friend bool operator==(const SuggestedIsovalue&, const SuggestedIsovalue&) = default;
};

/// Why model::suggestIsovalue() gives what it gives.
inline constexpr const char* kHistogramReason = "separates the samples best into two groups";

/// The best first: those of the topology, one for each reason, and then that of the histogram, if there is one.
/// Those outside [min, max] are left out: around the one sample that is 1e38 the widest interval is without interest.
std::vector<SuggestedIsovalue> suggestedIsovalues(const std::vector<topology::Suggestion>& ofTopology,
                                                  std::optional<double> ofHistogram, double min, double max);

/// "1200: greatest mean gradient on the surface"
std::string suggestionText(const SuggestedIsovalue& suggested);

} // namespace isoslider::model
