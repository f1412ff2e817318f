#pragma once

#include "core/extract/live/active_bits.h"
#include "core/extract/live/brick_leaves.h"
#include "core/extract/merged/merge_bound.h"
#include "core/extract/sources/sample_kernels.h"

namespace isoslider::extract {

/// What holds of a brick's merged cells at any isovalue, whichever edges are active: of smooth data it holds of most.
struct SureCells {
    BrickLeaves within; ///< no edge can exceed the bound
    /// Along each axis the samples ascend or descend throughout: then topology is kept, for what is above the isovalue
    /// reaches one corner of the cell along all three axes.
    BrickLeaves monotone;
    bool isOneLeaf = false; ///< the brick is one leaf whenever the surface passes through it
    bool isKnown = false;
};

/// Errs on the side of fewer. Some three thousand operations, for as long as the samples and the bound stay.
/// `validCells`: as findBrickLeaves() takes them.
template <class Sample>
SureCells findSureCells(const StoredSample<Sample>* samples, const BitString& validCells, const MergeBound& bound);

/// The leaves of a brick, from its own samples: those of LeafLevels::find() with cells of side 8 at most. They change
/// only where the isovalue crosses a sample of the brick. `validCells`: in the box, all corners finite; `sure`: as
/// findSureCells() has it, or nothing.
template <class Sample>
BrickLeaves findBrickLeaves(const StoredSample<Sample>* samples, const BitString& above, const ActiveBits& active,
                            const BitString& validCells, const MergeBound& bound, const SureCells& sure);

/// The same where they were `before`, and only cells in `changed` have other signs since.
template <class Sample>
BrickLeaves updateBrickLeaves(const BrickLeaves& before, const BitString& changed, const StoredSample<Sample>* samples,
                              const BitString& above, const ActiveBits& active, const BitString& validCells,
                              const MergeBound& bound, const SureCells& sure);

/// Those through which the surface passes, with all their halves; others stand as cells of the grid. Polygons and the
/// bricks beside depend on no more: a leaf without the surface has no active edge, on its faces neither.
BrickLeaves leavesOfSurface(const BrickLeaves& leaves, const BitString& activeCells);

} // namespace isoslider::extract
