#include "core/topology/topology_curve.h"

#include <utility>

#include "core/base/check.h"
#include "core/topology/event_coder.h"

namespace isoslider::topology {
namespace {

EventPages pagesOf(const std::vector<TopologyEvent>& events) {
    EventCoder coder;
    for (const TopologyEvent& event : events)
        coder.add(event);
    return coder.take().value(); // without a file nothing fails
}

} // namespace

TopologyCurve::TopologyCurve(EventPages events, MeasureCurves curves, bool areCountsExact, bool hasEvents)
    : coded_(std::move(events)) {
    areCountsExact_ = areCountsExact;
    hasEvents_ = hasEvents;
    pages_ = coded_.pages;
    curves_ = std::move(curves);
}

TopologyCurve::TopologyCurve(const std::vector<TopologyEvent>& events, MeasureCurves curves, bool areCountsExact,
                             bool hasEvents)
    : TopologyCurve(pagesOf(events), std::move(curves), areCountsExact, hasEvents) {}

std::vector<TopologyEvent> TopologyCurve::events() const {
    std::vector<TopologyEvent> all;
    const Status status = visitEvents([&](const TopologyEvent& event) {
        all.push_back(event);
        return true;
    });
    ISO_CHECK(status.isOk()); // it was coded here
    return all;
}

SurfaceCounts TopologyCurve::countsAt(double isovalue) const { return at(isovalue).value(); }

Result<std::vector<std::byte>> TopologyCurve::bytesOf(const EventPage& page) const {
    return coded_.bytesOf(static_cast<std::size_t>(&page - pages_.data()));
}

} // namespace isoslider::topology
