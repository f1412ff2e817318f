#include "core/topology/change_sums.h"

#include <algorithm>

namespace isoslider::topology {
namespace {

void add(ChangeTotals& totals, const TopologyEvent& event) {
    ++totals.events;
    totals.births += event.pieces.births;
    totals.deaths += event.pieces.deaths;
    totals.joins += event.pieces.joins;
    totals.splits += event.pieces.splits;
}

} // namespace

Result<ChangeSums> ChangeSums::of(const TopologySummary& summary) {
    ChangeSums sums;
    ChangeTotals totals;
    ISO_TRY(summary.visitEvents([&](const TopologyEvent& event) {
        if (totals.events % kStep == 0) {
            sums.isovalues_.push_back(event.isovalue);
            sums.totals_.push_back(totals);
        }
        add(totals, event);
        return true;
    }));
    return sums;
}

Result<ChangeTotals> ChangeSums::below(const TopologySummary& summary, double isovalue) const {
    const auto next = std::lower_bound(isovalues_.begin(), isovalues_.end(), isovalue);
    if (next == isovalues_.begin())
        return ChangeTotals();
    const auto last = static_cast<std::size_t>(next - isovalues_.begin()) - 1;
    ChangeTotals totals = totals_[last];
    ISO_TRY(summary.visitEventsFrom(isovalues_[last], [&](const TopologyEvent& event) {
        if (event.isovalue >= isovalue)
            return false;
        add(totals, event);
        return true;
    }));
    return totals;
}

Result<SurfaceDifference> difference(const TopologySummary& summary, const ChangeSums& sums, double from, double to) {
    SurfaceDifference found;
    const auto first = summary.at(from), last = summary.at(to);
    for (const auto* counts : {&first, &last})
        if (!counts->isOk())
            return counts->error();
    const auto before = sums.below(summary, from), after = sums.below(summary, to);
    for (const auto* totals : {&before, &after})
        if (!totals->isOk())
            return totals->error();
    found.from = first.value();
    found.to = last.value();
    found.births = after.value().births - before.value().births;
    found.deaths = after.value().deaths - before.value().deaths;
    found.joins = after.value().joins - before.value().joins;
    found.splits = after.value().splits - before.value().splits;
    found.events = after.value().events - before.value().events;
    found.volume = summary.curves().at(from).volume - summary.curves().at(to).volume;
    return found;
}

} // namespace isoslider::topology
