#pragma once

#include <utility>
#include <vector>

#include "core/base/job_control.h"
#include "core/grid/scalar_grid.h"
#include "core/topology/topology_summary.h"

namespace isoslider::topology {

/// The counts at every isovalue, by the isovalues at which they change, in memory. TOPOLOGY.md
class TopologyCurve final : public TopologySummary {
public:
    TopologyCurve() = default;
    /// REQUIRES: `events` ascend.
    TopologyCurve(std::vector<TopologyEvent> events, MeasureCurves curves)
        : events_(std::move(events)), curves_(std::move(curves)) {}
    /// Analyses a whole volume. Errors: InvalidArgument (missing values, 2^32 samples or more), Cancelled.
    static Result<TopologyCurve> analyse(const ScalarGrid& grid, const JobControl& job = {});

    /// Ascending.
    const std::vector<TopologyEvent>& events() const { return events_; }

    std::uint64_t eventCount() const override { return events_.size(); }
    /// O(log n).
    SurfaceCounts countsAt(double isovalue) const;
    Result<SurfaceCounts> at(double isovalue) const override { return countsAt(isovalue); }
    Status visitEvents(const std::function<bool(const TopologyEvent&)>& visit) const override;
    const MeasureCurves& curves() const override { return curves_; }

private:
    std::vector<TopologyEvent> events_;
    MeasureCurves curves_;
};

} // namespace isoslider::topology
