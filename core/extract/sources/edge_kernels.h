#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/extract/live/active_bits.h"
#include "core/extract/sources/crossed_points.h"
#include "core/grid/scalar_key.h"

namespace isoslider::extract {

/// Which edges of points change between two thresholds: those whose far end is not crossed, too. `masks`: of the
/// points' edges; `far`: the keys at their far ends, of one point after the other, each in the order of its mask. All
/// points have keys in [lower, upper), which is not empty. Fills `above` and `below`, as many as masks: the edges whose
/// far end is at `upper` or above, and those whose far end is below `lower`. Errors: none; reads nothing behind `far`.
template <class Key>
void findChangedEdges(std::span<const std::uint8_t> masks, std::span<const Key> far, KeyThreshold lower,
                      KeyThreshold upper, std::uint8_t* above, std::uint8_t* below);
/// The same edge by edge: what that is tested against.
template <class Key>
void findChangedEdgesReference(std::span<const std::uint8_t> masks, std::span<const Key> far, KeyThreshold lower,
                               KeyThreshold upper, std::uint8_t* above, std::uint8_t* below);

/// Edges of a brick that become active and inactive.
struct ToggledEdges {
    std::array<BitString, 3> activated, deactivated; ///< by axis, bit of the point where they start
    BitString above; ///< of the ends of activated edges those that are above; not where cells are merged
};

/// The edges that change at `count` crossed points of a brick; those that the masks leave out do not. `points`: the
/// first one's edges; the others follow `stride` bytes apart. `goesUp`: the isovalue does. Writes all words of `out`.
void listToggledEdges(const CrossedEdges* points, std::size_t stride, std::size_t count, const BrickMasks& masks,
                      bool goesUp, ToggledEdges& out);

/// How often signs are spread to reach every corner of an active cell, where no cells are merged.
inline constexpr int kRoundsInCells = 2;

/// What follows from the edges of a brick.
struct EdgeSigns {
    BitString cells; ///< those with an active edge
    BitString above; ///< of the corners of these cells
};

/// Signs of the corners of all active cells. `seeds`: of the ends of active edges those that are above; every other
/// corner of an active cell is at most two inactive edges of the cell away from one of these and has its sign. `still`:
/// inactive edges, of which that is known. `rounds`: how often signs are spread along these, while that brings any.
void spreadSigns(const std::array<BitString, 3>& edges, const std::array<BitString, 3>& still, const BitString& seeds,
                 const BitString& validCells, int rounds, EdgeSigns& out);

/// Whether no edge of an active cell is but as the signs state: false when the edges are those of no scalars, which
/// only a damaged index has.
bool areEdgesOfSigns(const std::array<BitString, 3>& edges, const EdgeSigns& signs);

/// A brick without merged cells, once its edges have changed.
struct ChangedBrick {
    EdgeSigns signs;
    BitString changed; ///< cells at the ends of toggled edges
    std::uint32_t ownedEdges = 0;
    bool isConsistent = false; ///< no edge became what it was
    bool isOfSigns = false; ///< as areEdgesOfSigns()
};

/// Applies what has changed to `edges`, and finds what follows. `aboveBefore`: the signs at their ends; those of a
/// brick that had no edges may be anything. Where cells are merged, `signs` and `isOfSigns` are not what they should
/// be.
void changeEdges(const ToggledEdges& toggled, const BrickMasks& masks, const BitString& aboveBefore,
                 std::array<BitString, 3>& edges, ChangedBrick& out);

} // namespace isoslider::extract
