#pragma once

#include <cstddef>
#include <vector>

#include "core/topology/paged_topology.h"

namespace isoslider::topology {

/// The counts at every isovalue, by the isovalues at which they change, in memory. TOPOLOGY.md
class TopologyCurve final : public PagedTopology {
public:
    TopologyCurve() = default;
    TopologyCurve(EventPages events, MeasureCurves curves, bool areCountsExact, bool hasEvents = true);
    /// REQUIRES: what EventCoder::add does.
    TopologyCurve(const std::vector<TopologyEvent>& events, MeasureCurves curves, bool areCountsExact,
                  bool hasEvents = true);

    /// Ascending. Decodes all of them: O(events).
    std::vector<TopologyEvent> events() const;
    /// Microseconds.
    SurfaceCounts countsAt(double isovalue) const;

    /// The bytes of each page.
    const std::vector<std::vector<std::byte>>& bytes() const { return bytes_; }
    Result<std::vector<std::byte>> bytesOf(const EventPage& page) const override;

private:
    std::vector<std::vector<std::byte>> bytes_; ///< of each page
};

} // namespace isoslider::topology
