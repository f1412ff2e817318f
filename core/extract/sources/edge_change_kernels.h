#pragma once

#include <cstdint>
#include <span>

#include "core/grid/scalar_key.h"
#include "core/index/format/point_record.h"

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

} // namespace isoslider::extract
