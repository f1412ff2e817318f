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
    return coder.take();
}

} // namespace

TopologyCurve::TopologyCurve(EventPages events, MeasureCurves curves, bool areCountsExact, bool hasEvents)
    : bytes_(std::move(events.bytes)) {
    areCountsExact_ = areCountsExact;
    hasEvents_ = hasEvents;
    pages_ = std::move(events.pages);
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
    return bytes_[static_cast<std::size_t>(&page - pages_.data())];
}

} // namespace isoslider::topology
