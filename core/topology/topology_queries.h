#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "core/topology/topology_summary.h"

namespace isoslider::topology {

/// Isovalues in (below, above] that show the same.
struct IsovalueInterval {
    double below = 0.0, above = 0.0;
};

/// Of events from `first` to `last`: without those that a thousandth of the volume at either end stretches over ten
/// times the range of all others, as extreme outliers and fill values do. The same two where that is not so.
IsovalueInterval usualRange(const MeasureCurves& curves, double first, double last);

/// Where the counts satisfy a condition: as few intervals as there can be, ascending. Only between the first and the
/// last event, where there is a surface. O(events). Errors: those of reading events.
Result<std::vector<IsovalueInterval>> intervalsWith(const TopologySummary& summary,
                                                    const std::function<bool(const SurfaceCounts&)>& isWanted);

/// Isovalues at which a curve passes through `value`, ascending: between those measured it is linear. What it jumps
/// over it does not pass through.
std::vector<double> isovaluesWith(const MeasureCurves& curves, double SurfaceMeasures::*measure, double value);

/// What happens while the isovalue rises from one value to another.
struct SurfaceDifference {
    SurfaceCounts from, to;
    std::uint64_t births = 0, deaths = 0, joins = 0, splits = 0; ///< of pieces, all that happen in between
    std::uint64_t events = 0;
    double volume = 0.0; ///< between both surfaces; 0 without curves
};
/// REQUIRES: from <= to. O(events). Errors: those of reading events.
Result<SurfaceDifference> difference(const TopologySummary& summary, double from, double to);

enum class SuggestionReason : std::uint8_t { WidestInterval, StrongestGradient, LargestPiece, HalfVolume };
/// "middle of the widest interval without a persistent event" and the like.
const char* reasonText(SuggestionReason reason);

/// An isovalue worth a look.
struct Suggestion {
    double isovalue = 0.0;
    SuggestionReason reason{};
};
/// The best first; none of a volume without events. O(events). Errors: those of reading events.
Result<std::vector<Suggestion>> suggestIsovalues(const TopologySummary& summary);

} // namespace isoslider::topology
