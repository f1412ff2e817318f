#pragma once

#include <utility>
#include <vector>

#include "core/topology/topology_summary.h"

namespace isoslider::topology {

/// The counts at every isovalue, by the isovalues at which they change, in memory. TOPOLOGY.md
class TopologyCurve final : public TopologySummary {
public:
    TopologyCurve() = default;
    /// REQUIRES: `events` ascend.
    TopologyCurve(std::vector<TopologyEvent> events, MeasureCurves curves, bool areCountsExact, bool hasEvents = true)
        : events_(std::move(events)),
          curves_(std::move(curves)),
          areCountsExact_(areCountsExact),
          hasEvents_(hasEvents) {}

    /// Ascending.
    const std::vector<TopologyEvent>& events() const { return events_; }

    std::uint64_t eventCount() const override { return events_.size(); }
    /// O(log n).
    SurfaceCounts countsAt(double isovalue) const;
    Result<SurfaceCounts> at(double isovalue) const override { return countsAt(isovalue); }
    bool areCountsExact() const override { return areCountsExact_; }
    bool hasEvents() const override { return hasEvents_; }
    Status visitEvents(const std::function<bool(const TopologyEvent&)>& visit) const override;
    Status visitEventsFrom(double isovalue, const std::function<bool(const TopologyEvent&)>& visit) const override;
    const MeasureCurves& curves() const override { return curves_; }

private:
    std::vector<TopologyEvent> events_;
    MeasureCurves curves_;
    bool areCountsExact_ = true, hasEvents_ = true;
};

} // namespace isoslider::topology
