#include "core/topology/topology_curve.h"

#include <algorithm>

namespace isoslider::topology {

SurfaceCounts TopologyCurve::countsAt(double isovalue) const {
    const auto next = std::lower_bound(events_.begin(), events_.end(), isovalue,
                                       [](const TopologyEvent& event, double at) { return event.isovalue < at; });
    if (next != events_.end())
        return next->below;
    return events_.empty() ? SurfaceCounts() : events_.back().above;
}

Status TopologyCurve::visitEvents(const std::function<bool(const TopologyEvent&)>& visit) const {
    for (const TopologyEvent& event : events_)
        if (!visit(event))
            break;
    return {};
}

Status TopologyCurve::visitEventsFrom(double isovalue, const std::function<bool(const TopologyEvent&)>& visit) const {
    auto event = std::lower_bound(events_.begin(), events_.end(), isovalue,
                                  [](const TopologyEvent& one, double at) { return one.isovalue < at; });
    while (event != events_.end() && visit(*event))
        ++event;
    return {};
}

} // namespace isoslider::topology
