#include "core/topology/topology_curve.h"

#include <utility>

#include "core/base/check.h"

namespace isoslider::topology {
namespace {

EventPages pagesOf(const std::vector<TopologyEvent>& events) {
    EventPages pages;
    for (const TopologyEvent& event : events)
        pages.add(event);
    pages.finish();
    return pages;
}

} // namespace

TopologyCurve::TopologyCurve(EventPages events, MeasureCurves curves, bool areCountsExact, bool hasEvents)
    : body_(std::move(events).takeBody()) {
    areCountsExact_ = areCountsExact;
    hasEvents_ = hasEvents;
    pages_ = events.pages();
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
    const auto begin = body_.begin() + static_cast<std::ptrdiff_t>(page.offset);
    return std::vector<std::byte>(begin, begin + static_cast<std::ptrdiff_t>(page.bytes));
}

} // namespace isoslider::topology
