#include "core/topology/topology_queries.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>

namespace isoslider::topology {
namespace {

// Events that last a twentieth of the range are no noise.
constexpr double kPersistent = 0.05;

double nextAbove(double value) { return std::nextafter(value, std::numeric_limits<double>::infinity()); }

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
        const double next = curves.measures[i + 1].*measure;
        if ((here < value && next > value) || (here > value && next < value)) {
            const double part = (value - here) / (next - here);
            found.push_back(curves.isovalues[i] * (1.0 - part) + curves.isovalues[i + 1] * part);
        }
    }
    return found;
}

Result<SurfaceDifference> difference(const TopologySummary& summary, double from, double to) {
    SurfaceDifference found;
    const auto first = summary.at(from), last = summary.at(to);
    for (const auto* counts : {&first, &last})
        if (!counts->isOk())
            return counts->error();
    found.from = first.value();
    found.to = last.value();
    ISO_TRY(summary.visitEvents([&](const TopologyEvent& event) {
        if (event.isovalue >= from && event.isovalue < to) { // it has happened beyond its isovalue
            ++found.events;
            found.births += event.pieces.births;
            found.deaths += event.pieces.deaths;
            found.joins += event.pieces.joins;
            found.splits += event.pieces.splits;
        }
        return event.isovalue < to;
    }));
    found.volume = summary.curves().at(from).volume - summary.curves().at(to).volume;
    return found;
}

const char* reasonText(SuggestionReason reason) {
    switch (reason) {
        case SuggestionReason::WidestInterval: return "middle of the widest interval without a persistent event";
        case SuggestionReason::StrongestGradient: return "greatest mean gradient on the surface";
        case SuggestionReason::LargestPiece: return "just beyond the most persistent event of a piece";
        case SuggestionReason::HalfVolume: return "encloses half of the volume";
    }
    return "";
}

Result<std::vector<Suggestion>> suggestIsovalues(const TopologySummary& summary) {
    std::vector<Suggestion> found;
    std::optional<double> first;
    double last = 0.0;
    ISO_TRY(summary.visitEvents([&](const TopologyEvent& event) {
        first = first.value_or(event.isovalue);
        last = event.isovalue;
        return true;
    }));
    if (!first || !(*first < last))
        return found;
    const double halfRange = 0.5 * last - 0.5 * *first; // a whole one may be more than a double holds
    double widest = 0.0, since = *first, greatest = 0.0;
    std::optional<double> middle, ofPiece;
    ISO_TRY(summary.visitEvents([&](const TopologyEvent& event) {
        if (0.5 * event.persistence >= kPersistent * halfRange || event.isovalue == last) {
            if (0.5 * event.isovalue - 0.5 * since > widest) {
                widest = 0.5 * event.isovalue - 0.5 * since;
                middle = since + widest;
            }
            since = event.isovalue;
        }
        const bool isOfPiece = event.pieces.joins + event.pieces.splits > 0; // not where the first one comes or goes
        if (isOfPiece && event.persistence > greatest && 0.5 * event.persistence >= kPersistent * halfRange) {
            greatest = event.persistence;
            ofPiece = nextAbove(event.isovalue);
        }
        return true;
    }));
    const MeasureCurves& curves = summary.curves();
    std::optional<double> steepest;
    double largestArea = 0.0, strongest = 0.0;
    for (const SurfaceMeasures& at : curves.measures)
        largestArea = std::max(largestArea, at.area);
    for (std::size_t i = 0; i < curves.isovalues.size(); ++i) {
        constexpr double kWorthALook = 0.05; // a few cells may be as steep as you like
        if (curves.measures[i].area >= kWorthALook * largestArea && curves.measures[i].gradient > strongest) {
            strongest = curves.measures[i].gradient;
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
