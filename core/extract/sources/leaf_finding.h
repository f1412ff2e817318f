#pragma once

#include <array>
#include <cstdint>

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
    std::uint64_t valid = 0; ///< cells of side 2 in the box, all of whose samples are finite
    bool isOneLeaf = false; ///< the brick is one leaf whenever the surface passes through it
    bool isKnown = false;
};

/// Errs on the side of fewer. Some three thousand operations, for as long as the samples and the bound stay.
/// `validCells`: as findBrickLeaves() takes them.
template <class Sample>
SureCells findSureCells(const StoredSample<Sample>* samples, const BitString& validCells, const MergeBound& bound);

/// What has been found out of a brick's edges that exceed the bound in merged cells while they are active: that they do
/// depends on the samples and the bound, not on the isovalue. Nothing is known at first.
struct ExceedingEdges {
    /// Of cells of side 2: how many times each has been asked for, and one such edge: 1 + 3 * its lower point, which is
    /// x + 3 y + 9 z in the cell, + its axis.
    std::array<std::uint8_t, 64> asked{}, ofPairs{};
    /// All such edges, by axis: bits of the lower points. Of cells that have been asked for often.
    std::array<std::array<std::uint32_t, 3>, 64> allOfPairs;
    std::array<std::uint16_t, 9> ofLarger{}; ///< of side 4, then the one of side 8: one more than the ClosedEdge

    void forget() {
        asked.fill(0);
        ofPairs.fill(0);
        ofLarger.fill(0);
    }
};

/// The leaves of a brick.
struct FoundLeaves {
    BrickLeaves usable; ///< those of LeafLevels::find() with cells of side 8 at most
    /// Those through which the surface passes, with all their halves; others stand as cells of the grid. Polygons and
    /// the bricks beside depend on no more: a leaf without the surface has no active edge, on its faces neither.
    BrickLeaves ofSurface;
};

/// From the brick's own samples. They change only where the isovalue crosses a sample of the brick. `validCells`: in
/// the box, all corners finite; `sure`: as findSureCells() has it, or nothing; `exceeding`: of these samples and this
/// bound.
template <class Sample>
FoundLeaves findBrickLeaves(const StoredSample<Sample>* samples, const BitString& above, const ActiveBits& active,
                            const BitString& validCells, const MergeBound& bound, const SureCells& sure,
                            ExceedingEdges& exceeding);

/// The same where usable ones were `before`, with signs `aboveBefore`, and only cells in `changed` have other signs
/// since.
template <class Sample>
FoundLeaves updateBrickLeaves(const BrickLeaves& before, const BitString& aboveBefore, const BitString& changed,
                              const StoredSample<Sample>* samples, const BitString& above, const ActiveBits& active,
                              const BitString& validCells, const MergeBound& bound, const SureCells& sure,
                              ExceedingEdges& exceeding);

} // namespace isoslider::extract
