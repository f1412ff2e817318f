#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "core/base/result.h"
#include "core/topology/measure_curves.h"
#include "core/topology/topology_event.h"

namespace isoslider::topology {

/// An event, and how much it is worth a look, in scalars: the persistence of its piece; where tunnels, voids or
/// boundary loops change, how far away the nearest other change of that number is, if that is more. A tunnel has no
/// separate persistence here, but where many open and close in a short interval each of them is noise.
struct WeightedEvent {
    TopologyEvent event;
    double weight = 0.0;
};

/// All that is known in advance of a volume's surfaces: events, counts at every isovalue, curves. Immutable; any
/// number of threads at once.
class TopologySummary {
public:
    virtual ~TopologySummary() = default;

    virtual std::uint64_t eventCount() const = 0;
    /// Microseconds. Errors: IoError, Corruption.
    virtual Result<SurfaceCounts> at(double isovalue) const = 0;
    /// False where samples are missing such that the rest is no ball, or none with hollows: then pieces and boundary
    /// loops are at least as many as stated, and tunnels are not known. Euler numbers and voids hold.
    virtual bool areCountsExact() const = 0;
    /// False where memory sufficed for counts only. What is then visited are isovalues, each with the counts at it and
    /// at the next of them; counts between are those at the next, and nothing is known of persistence and places.
    virtual bool hasEvents() const { return true; }
    /// Calls `visit` for all events, ascending, until it returns false. Errors: IoError, Corruption.
    virtual Status visitEvents(const std::function<bool(const TopologyEvent&)>& visit) const = 0;
    /// The same without the events below `isovalue`. O(log n) and what is visited where the kind of summary can;
    /// otherwise all are passed over. Errors: IoError, Corruption.
    virtual Status visitEventsFrom(double isovalue, const std::function<bool(const TopologyEvent&)>& visit) const;
    /// Isovalues of the first and of the last event; none where there are no events. O(1) where the kind of summary
    /// can; otherwise all are passed over. Errors: IoError, Corruption.
    virtual Result<std::optional<std::pair<double, double>>> ends() const;
    /// Empty where they were not made.
    virtual const MeasureCurves& curves() const = 0;

    /// The `count` events of the greatest weight, ascending by isovalue; all if there are fewer, none if !hasEvents().
    /// O(events log count); memory for `count` of them.
    Result<std::vector<WeightedEvent>> mostNotable(std::size_t count) const;
};

} // namespace isoslider::topology
