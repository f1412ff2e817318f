#include "ui/model/isovalue/histogram_model.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "ui/model/isovalue/value_steps.h"

namespace isoslider::model {
namespace {

/// Counts as weights: the square root keeps the order of peaks, yet a background of 95 % of all
/// samples no longer outweighs the object.
std::vector<double> dampedWeights(const Histogram& histogram) {
    std::vector<double> weights(histogram.counts.size());
    std::transform(histogram.counts.begin(), histogram.counts.end(), weights.begin(),
                   [](std::uint64_t count) { return std::sqrt(static_cast<double>(count)); });
    return weights;
}

/// The bin boundary with the largest variance between the classes below and above it.
/// Ties (a gap without samples) give the middle of the tied stretch.
double otsuBoundary(const std::vector<double>& weights) {
    const double total = std::accumulate(weights.begin(), weights.end(), 0.0);
    double moment = 0.0;
    for (std::size_t bin = 0; bin < weights.size(); ++bin)
        moment += static_cast<double>(bin) * weights[bin];
    double best = -1.0, first = 0.0, last = 0.0, below = 0.0, belowMoment = 0.0;
    for (std::size_t bin = 0; bin + 1 < weights.size(); ++bin) {
        below += weights[bin];
        belowMoment += static_cast<double>(bin) * weights[bin];
        const double above = total - below;
        if (below <= 0.0 || above <= 0.0)
            continue;
        const double gap = belowMoment / below - (moment - belowMoment) / above;
        const double variance = below * above * gap * gap;
        const double boundary = static_cast<double>(bin + 1);
        if (variance > best * (1.0 + 1e-12)) {
            best = variance;
            first = boundary;
        }
        if (variance >= best * (1.0 - 1e-12))
            last = boundary;
    }
    return best < 0.0 ? static_cast<double>(weights.size()) / 2.0 : (first + last) / 2.0;
}

constexpr std::size_t kMostBinsToPart = 512;
constexpr double kFirstDigits = 1.0 / 200.0; // of the range: finer, nobody can tell why

} // namespace

double firstIsovalue(const ValueDistribution& values) {
    if (values.isEmpty())
        return std::midpoint(values.min, values.max);
    const auto& fine = values.body;
    const std::size_t merged = std::max<std::size_t>(1, (fine.counts.size() + kMostBinsToPart - 1) / kMostBinsToPart);
    Histogram body{fine.min, fine.max, {}};
    for (std::size_t bin = 0; bin < fine.counts.size(); ++bin) {
        if (bin % merged == 0)
            body.counts.push_back(0);
        body.counts.back() += fine.counts[bin];
    }
    if (!fine.counts.empty() && merged > 1) // the last bin may be a part of one
        body.max = std::min(fine.min + (fine.max - fine.min) * (static_cast<double>(body.counts.size() * merged) /
                                                                static_cast<double>(fine.counts.size())),
                            std::numeric_limits<double>::max());
    const double best = suggestIsovalue(body);
    const double step = roundStep((fine.max - fine.min) * kFirstDigits);
    const double round = nearestMultiple(best, step);
    return std::clamp(round, values.min, values.max);
}

double binLowerEnd(const Histogram& histogram, std::size_t bin) {
    const double share = static_cast<double>(bin) / static_cast<double>(histogram.counts.size());
    return std::lerp(histogram.min, histogram.max, share);
}

double suggestIsovalue(const Histogram& histogram) {
    if (histogram.counts.empty())
        return std::midpoint(histogram.min, histogram.max);
    const double share = otsuBoundary(dampedWeights(histogram)) / static_cast<double>(histogram.counts.size());
    return std::lerp(histogram.min, histogram.max, share);
}

std::size_t drawableBins(const Histogram& histogram, ScalarType type) {
    const std::size_t bins = histogram.counts.size();
    if (isFloatType(type))
        return bins;
    const double wholeNumbers = histogram.max - histogram.min + 1.0;
    return std::max<std::size_t>(1, static_cast<std::size_t>(std::min(wholeNumbers, static_cast<double>(bins))));
}

HistogramOutline outlineOf(const Histogram& histogram, std::size_t maxBins) {
    HistogramOutline outline;
    const std::size_t bins = histogram.counts.size();
    if (bins == 0 || maxBins == 0)
        return outline;
    const std::size_t merged = (bins + maxBins - 1) / maxBins;
    for (std::size_t bin = 0; bin < bins; bin += merged) {
        double count = 0.0;
        for (std::size_t part = bin; part < std::min(bin + merged, bins); ++part)
            count += static_cast<double>(histogram.counts[part]);
        outline.values.push_back(binLowerEnd(histogram, bin));
        outline.counts.push_back(count);
    }
    return outline;
}

} // namespace isoslider::model
