#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/topology/topology_queries.h"

namespace isoslider::topology {

/// What happens to pieces at all events together, as the isovalue rises.
struct ChangeTotals {
    std::uint64_t births = 0, deaths = 0, joins = 0, splits = 0;
    std::uint64_t events = 0;
    friend bool operator==(const ChangeTotals&, const ChangeTotals&) = default;
};

/// Running totals at every kStep-th event, so that comparing two isovalues takes no pass over all events between them.
/// Immutable; any number of threads at once.
class ChangeSums {
public:
    static constexpr std::uint64_t kStep = 1024;

    /// O(events). Errors: those of reading events.
    static Result<ChangeSums> of(const TopologySummary& summary);
    /// Of all events below `isovalue`. `summary`: the one these are of. O(log n + kStep). Errors: those of reading
    /// events.
    Result<ChangeTotals> below(const TopologySummary& summary, double isovalue) const;

private:
    std::vector<double> isovalues_; ///< of every kStep-th event, from the first
    std::vector<ChangeTotals> totals_; ///< of all events before each of them
};

/// As above; the same answer without a pass over the events. REQUIRES: from <= to; `sums` are of `summary`.
Result<SurfaceDifference> difference(const TopologySummary& summary, const ChangeSums& sums, double from, double to);

} // namespace isoslider::topology
