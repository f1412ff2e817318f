#pragma once

#include <array>
#include <vector>

#include "core/topology/analysis/layer_window.h"
#include "core/topology/analysis/strip_components.h"

namespace isoslider::topology {

/// Two corners of a face of the boundary that are joined without an edge of the grid between them.
struct BoundaryJoin {
    double isovalue; ///< above side: the last at which they are joined; below side: beyond it they are
    Cause cause;
    std::array<Point, 2> points;
};

/// What is local in a strip of cells.
struct StripChanges {
    std::vector<EulerChange> euler; ///< those of one isovalue add up
    std::vector<BoundaryJoin> boundaryAbove, boundaryBelow;
};

/// Finds what changes the Euler number, and joins `above` and `below` across faces and through the inside of cells.
/// O(points), and some ten nanoseconds for each cell that is ambiguous at some isovalue. REQUIRES: both are flooded.
template <class Sample>
StripChanges findStripChanges(const LayerWindow<Sample>& window, const Strip& strip, StripSide& above,
                              StripSide& below);

} // namespace isoslider::topology
