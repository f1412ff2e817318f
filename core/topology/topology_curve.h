#pragma once

#include <cstddef>
#include <vector>

#include "core/topology/paged_topology.h"

namespace isoslider::topology {

/// The counts at every isovalue, by the isovalues at which they change, in memory. TOPOLOGY.md
class TopologyCurve final : public PagedTopology {
public:
    TopologyCurve() = default;
    /// REQUIRES: finish() was called.
    TopologyCurve(EventPages events, MeasureCurves curves, bool areCountsExact, bool hasEvents = true);
    /// REQUIRES: what EventPages::add does.
    TopologyCurve(const std::vector<TopologyEvent>& events, MeasureCurves curves, bool areCountsExact,
                  bool hasEvents = true);

    /// Ascending. Decodes all of them: O(events).
    std::vector<TopologyEvent> events() const;
    /// Microseconds.
    SurfaceCounts countsAt(double isovalue) const;

    /// All pages one after the other.
    const std::vector<std::byte>& body() const { return body_; }
    Result<std::vector<std::byte>> bytesOf(const EventPage& page) const override;

private:
    std::vector<std::byte> body_;
};

} // namespace isoslider::topology
