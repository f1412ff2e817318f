#include "core/topology/topology_queries.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>

#include "core/topology/change_sums.h"

namespace isoslider::topology {
namespace {

// Events that last a twentieth of the range are no noise.
constexpr double kPersistent = 0.05;
// A surface of a few cells may be as steep as you like: one that is worth a look has this share of the area of a side
// of the box, or of the largest surface, if that is less. (In noise the largest surface is much larger than either.)
// Up to that area a larger one is worth more, by the root of its share: its width as it is seen.
constexpr double kWorthALook = 0.05;

} // namespace

Result<std::vector<IsovalueInterval>> intervalsWith(const TopologySummary& summary,
                                                    const std::function<bool(const SurfaceCounts&)>& isWanted) {
    std::vector<IsovalueInterval> found;
    std::optional<double> last; // of the event before
    ISO_TRY(summary.visitEvents([&](const TopologyEvent& event) {
        if (last && isWanted(event.below)) {
            if (!found.empty() && found.back().above == *last)
                found.back().above = event.isovalue;
            else
                found.push_back({*last, event.isovalue});
        }
        last = event.isovalue;
        return true;
    }));
    return found;
}

std::vector<double> isovaluesWith(const MeasureCurves& curves, double SurfaceMeasures::*measure, double value) {
    std::vector<double> found;
    for (std::size_t i = 0; i < curves.isovalues.size(); ++i) {
        const double here = curves.measures[i].*measure;
        if (here == value)
            found.push_back(curves.isovalues[i]);
        if (i + 1 == curves.isovalues.size())
            break;
        if (curves.jumpsAfter(i))
            continue;
        const double next = curves.measures[i + 1].*measure;
        if ((here < value && next > value) || (here > value && next < value)) {
            const double part = (value - here) / (next - here);
            found.push_back(curves.isovalues[i] * (1.0 - part) + curves.isovalues[i + 1] * part);
        }
    }
    return found;
}

Result<SurfaceDifference> difference(const TopologySummary& summary, double from, double to) {
    const auto sums = ChangeSums::of(summary);
    if (!sums.isOk())
        return sums.error();
    return difference(summary, sums.value(), from, to);
}

const char* reasonText(SuggestionReason reason) {
    switch (reason) {
        case SuggestionReason::WidestInterval: return "middle of the widest interval without a persistent event";
        case SuggestionReason::StrongestGradient: return "greatest mean gradient on the surface, weighed by its size";
        case SuggestionReason::LargestPiece: return "just beyond the most persistent event of a piece";
        case SuggestionReason::HalfVolume: return "half of the volume is above it";
    }
    return "";
}

IsovalueInterval usualRange(const MeasureCurves& curves, double first, double last) {
    constexpr double kFew = 0.001, kStretch = 10.0;
    if (curves.isEmpty())
        return {first, last};
    // Of the isovalues that are measured: in between, where there may be nothing for orders of magnitude, curves say
    // little.
    const double whole = curves.measures.front().volume;
    double low = last, high = first;
    for (std::size_t i = 0; i < curves.isovalues.size(); ++i) {
        if (curves.measures[i].volume < (1.0 - kFew) * whole)
            low = std::min(low, curves.isovalues[i]);
        if (curves.measures[i].volume > kFew * whole)
            high = std::max(high, curves.isovalues[i]);
    }
    if (!(low < high && last / kStretch - first / kStretch > high - low))
        return {first, last};
    return {low, high};
}

Result<std::vector<Suggestion>> suggestIsovalues(const TopologySummary& summary) {
    std::vector<Suggestion> found;
    const auto ends = summary.ends();
    if (!ends.isOk())
        return ends.error();
    if (!ends.value() || !(ends.value()->first < ends.value()->second))
        return found;
    const double first = ends.value()->first, last = ends.value()->second;
    const MeasureCurves& curves = summary.curves();
    const auto [low, high] = usualRange(curves, first, last);
    const double halfRange = 0.5 * high - 0.5 * low; // a whole one may be more than a double holds
    double widest = 0.0, since = low, greatest = 0.0;
    std::optional<double> middle, ofPiece;
    const auto endInterval = [&](double isovalue) {
        if (0.5 * isovalue - 0.5 * since > widest) {
            widest = 0.5 * isovalue - 0.5 * since;
            middle = since + widest;
        }
        since = isovalue;
    };
    ISO_TRY(summary.visitEvents([&, low = low, high = high](const TopologyEvent& event) {
        if (!summary.hasEvents())
            return false;
        // One that lasts longer than the usual range is of an outlier.
        if (event.isovalue < low || event.isovalue > high || 0.5 * event.persistence > halfRange)
            return true;
        if (0.5 * event.persistence >= kPersistent * halfRange)
            endInterval(event.isovalue);
        // Not where the eldest piece comes or goes, which lasts through all values.
        const bool isOfPiece =
            event.pieces.joins + event.pieces.splits > 0 && 0.5 * event.persistence < 0.5 * last - 0.5 * first;
        if (isOfPiece && event.persistence > greatest && 0.5 * event.persistence >= kPersistent * halfRange) {
            greatest = event.persistence;
            ofPiece = nextAbove(event.isovalue);
        }
        return true;
    }));
    if (summary.hasEvents())
        endInterval(high);
    std::optional<double> steepest;
    const double sideArea = curves.isEmpty() ? 0.0 : std::pow(curves.measures.front().volume, 2.0 / 3.0);
    double largestArea = 0.0, strongest = 0.0; // of gradients, weighed
    for (const SurfaceMeasures& at : curves.measures)
        largestArea = std::max(largestArea, at.area);
    const double large = std::min(sideArea, largestArea);
    for (std::size_t i = 0; i < curves.isovalues.size(); ++i) {
        if ((i > 0 && curves.jumpsAfter(i - 1)) || (i + 1 < curves.isovalues.size() && curves.jumpsAfter(i)))
            continue; // an isovalue that is next to another one is none to go to
        const bool isUsual = curves.isovalues[i] >= low && curves.isovalues[i] <= high;
        const double area = curves.measures[i].area;
        const double weighed = curves.measures[i].gradient * std::sqrt(std::min(1.0, area / large));
        if (isUsual && area >= kWorthALook * large && weighed > strongest) {
            strongest = weighed;
            steepest = curves.isovalues[i];
        }
    }
    // Where the samples change most over space one thing ends and another begins; the other reasons are second to that.
    if (steepest)
        found.push_back({*steepest, SuggestionReason::StrongestGradient});
    if (middle)
        found.push_back({*middle, SuggestionReason::WidestInterval});
    if (ofPiece)
        found.push_back({*ofPiece, SuggestionReason::LargestPiece});
    if (!curves.isEmpty())
        for (const double isovalue :
             isovaluesWith(curves, &SurfaceMeasures::volume, 0.5 * curves.measures.front().volume))
            found.push_back({isovalue, SuggestionReason::HalfVolume});
    return found;
}

} // namespace isoslider::topology
