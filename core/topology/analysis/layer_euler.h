#pragma once

#include <vector>

#include "core/topology/analysis/layer_window.h"
#include "core/topology/cell_saddles.h"

namespace isoslider::topology {

/// Two corners of one cell that are joined without an edge of the grid between them.
struct CornerJoin {
    double isovalue;
    std::int64_t a, b; ///< from the layer's first grid point on
    Cause cause;
    bool isOnBoundary; ///< across a face of the boundary
};

/// What is local in a layer of cells: changes of the Euler number, and joins.
struct LayerChanges {
    std::vector<EulerChange> euler; ///< those of one isovalue add up
    std::vector<CornerJoin> above, below;
};

/// O(points), and some hundred nanoseconds for each cell that is ambiguous at some isovalue.
template <class Sample>
LayerChanges findLayerChanges(const LayerWindow<Sample>& window);

} // namespace isoslider::topology
