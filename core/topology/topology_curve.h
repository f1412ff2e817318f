#pragma once

#include <cstddef>
#include <vector>

#include "core/topology/paged_topology.h"

namespace isoslider::topology {

/// The counts at every isovalue, by the isovalues at which they change, in memory, or in a scratch file what it does
/// not hold. TOPOLOGY.md
class TopologyCurve final : public PagedTopology {
public:
    TopologyCurve() = default;
    TopologyCurve(EventPages events, MeasureCurves curves, bool areCountsExact, bool hasEvents = true);
    /// REQUIRES: what EventCoder::add does.
    TopologyCurve(const std::vector<TopologyEvent>& events, MeasureCurves curves, bool areCountsExact,
                  bool hasEvents = true);

    /// Ascending. Decodes all of them: O(events). REQUIRES: all are in memory.
    std::vector<TopologyEvent> events() const;
    /// Microseconds. REQUIRES: the same.
    SurfaceCounts countsAt(double isovalue) const;

    Result<std::vector<std::byte>> bytesOf(const EventPage& page) const override;

private:
    EventPages coded_;
};

} // namespace isoslider::topology
