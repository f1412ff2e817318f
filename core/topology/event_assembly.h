#pragma once

#include <vector>

#include "core/grid/grid_geometry.h"
#include "core/topology/analysis/component_graph.h"
#include "core/topology/analysis/packed_cause.h"
#include "core/topology/event_pages.h"

namespace isoslider::topology {

/// All that was found to change, kind by kind.
struct EventParts {
    std::vector<EulerChange> euler;
    ComponentHistory above, below, aboveOnBoundary, belowOnBoundary;
};

/// One event for each isovalue at which the counts change, ascending. O(n log n).
EventPages assembleEvents(EventParts parts, const GridDims& dims);

} // namespace isoslider::topology
