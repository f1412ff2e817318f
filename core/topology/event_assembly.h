#pragma once

#include "core/grid/grid_geometry.h"
#include "core/topology/analysis/isovalue_sums.h"
#include "core/topology/analysis/packed_cause.h"
#include "core/topology/event_coder.h"

namespace isoslider::topology {

/// All that was found to change, kind by kind.
struct EventParts {
    SortedChanges<EulerChange> euler;
    SideChanges above, below, aboveOnBoundary, belowOnBoundary;
};

/// One event for each isovalue at which the counts change, ascending. O(n log n). Errors: those of reading changes,
/// and of `coder`.
Result<EventPages> assembleEvents(EventParts parts, const GridDims& dims, EventCoder& coder);

} // namespace isoslider::topology
