#pragma once

#include "core/extract/live/active_bits.h"
#include "core/extract/live/brick_leaves.h"
#include "core/extract/merged/merge_bound.h"
#include "core/extract/sources/sample_kernels.h"

namespace isoslider::extract {

/// The leaves of a brick, from its own samples: those of LeafLevels::find() with cells of side 8 at most. They change
/// only where the isovalue crosses a sample of the brick. `validCells`: in the box, all corners finite.
template <class Sample>
BrickLeaves findBrickLeaves(const StoredSample<Sample>* samples, const BitString& above, const ActiveBits& active,
                            const BitString& validCells, const MergeBound& bound);

} // namespace isoslider::extract
