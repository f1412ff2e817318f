#pragma once

#include <array>
#include <cstdint>

#include "core/extract/sample_block.h"
#include "core/grid/scalar_key.h"

namespace isoslider::extract {

/// Signs of 9^3 points as words: bit x + 8 y of plane z, for points (x, y), (x + 1, y) and (x, y + 1).
struct SignWords {
    std::array<std::uint64_t, 9> here{}, right{}, behind{};
};

/// What a move between two thresholds asks of the samples of a brick, local coordinates 0 to 8.
struct BrickSigns {
    SignWords from;       ///< points above the threshold moved from; 0 outside the box, anything at missing samples
    SignWords to;         ///< the same for the one moved to
    std::uint64_t up;     ///< least key of a finite sample that is not below `to`; all ones without one
    std::uint64_t down;   ///< greatest key of a finite sample below `to`; 0 without one
    bool hasMissing;      ///< some sample in the box is missing
};

/// One pass over the samples, in vectors where the machine has SSE4.1. What the block holds outside the box does
/// not matter. O(1).
template <class Sample>
BrickSigns findBrickSigns(const SampleBlock<Sample>& block, KeyThreshold from, KeyThreshold to);

/// The same, sample by sample: for other machines, and what the one above is tested against.
template <class Sample>
BrickSigns findBrickSignsPlainly(const SampleBlock<Sample>& block, KeyThreshold from, KeyThreshold to);

} // namespace isoslider::extract
