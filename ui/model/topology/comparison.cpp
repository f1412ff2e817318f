#include "ui/model/topology/comparison.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace isoslider::model {

Result<Comparison> compare(const topology::TopologySummary& summary, const topology::ChangeSums& sums, double reference,
                           double isovalue) {
    const bool isUpwards = isovalue >= reference;
    const auto found =
        topology::difference(summary, sums, std::min(reference, isovalue), std::max(reference, isovalue));
    if (!found.isOk())
        return found.error();
    const topology::SurfaceDifference& rising = found.value();
    Comparison comparison;
    comparison.reference = reference;
    comparison.isovalue = isovalue;
    comparison.before = isUpwards ? rising.from : rising.to;
    comparison.after = isUpwards ? rising.to : rising.from;
    comparison.appear = isUpwards ? rising.births : rising.deaths;
    comparison.disappear = isUpwards ? rising.deaths : rising.births;
    comparison.join = isUpwards ? rising.joins : rising.splits;
    comparison.split = isUpwards ? rising.splits : rising.joins;
    comparison.events = rising.events;
    comparison.areCountsExact = summary.areCountsExact();
    comparison.hasEvents = summary.hasEvents();
    if (!summary.curves().isEmpty()) {
        comparison.measuresBefore = summary.curves().at(reference);
        comparison.measuresAfter = summary.curves().at(isovalue);
        comparison.volumeBetween = std::abs(rising.volume);
    }
    return comparison;
}

} // namespace isoslider::model
