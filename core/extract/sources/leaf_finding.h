#pragma once

#include "core/extract/live/active_bits.h"
#include "core/extract/live/brick_leaves.h"
#include "core/extract/merged/merge_bound.h"
#include "core/extract/sources/sample_kernels.h"

namespace isoslider::extract {

/// The merged cells of a brick in which no edge can exceed the bound, whichever are active: most of those of smooth
/// data. It errs on the side of fewer. Some two thousand operations, for as long as the samples and the bound stay.
template <class Sample>
BrickLeaves findSurelyWithin(const StoredSample<Sample>* samples, const MergeBound& bound);

/// The leaves of a brick, from its own samples: those of LeafLevels::find() with cells of side 8 at most. They change
/// only where the isovalue crosses a sample of the brick. `validCells`: in the box, all corners finite; `surelyWithin`:
/// as findSurelyWithin() has it, or nothing.
template <class Sample>
BrickLeaves findBrickLeaves(const StoredSample<Sample>* samples, const BitString& above, const ActiveBits& active,
                            const BitString& validCells, const MergeBound& bound, const BrickLeaves& surelyWithin);

/// The same where they were `before`, and only cells in `changed` have other signs since.
template <class Sample>
BrickLeaves updateBrickLeaves(const BrickLeaves& before, const BitString& changed, const StoredSample<Sample>* samples,
                              const BitString& above, const ActiveBits& active, const BitString& validCells,
                              const MergeBound& bound, const BrickLeaves& surelyWithin);

/// Those through which the surface passes, with all their halves; others stand as cells of the grid. Polygons and the
/// bricks beside depend on no more: a leaf without the surface has no active edge, on its faces neither.
BrickLeaves leavesOfSurface(const BrickLeaves& leaves, const BitString& activeCells);

} // namespace isoslider::extract
