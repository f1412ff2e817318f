#pragma once

#include <random>

#include "core/extract/live/brick_leaves.h"

namespace isoslider::extract {

/// Leaves of a brick that might be, of any size.
inline BrickLeaves someLeaves(std::mt19937& random) {
    BrickLeaves leaves;
    for (unsigned i = 0; i < 64; ++i)
        leaves.level1 |= std::uint64_t{random() % 4 != 0} << i;
    for (unsigned i = 0; i < 8; ++i)
        if (const BrickLeaves larger = leafBits(2, i); random() % 3 == 0) {
            leaves.level1 |= larger.level1;
            leaves.level2 = static_cast<std::uint8_t>(leaves.level2 | larger.level2);
        }
    return random() % 8 == 0 ? leafBits(3, 0) : random() % 8 == 0 ? BrickLeaves() : leaves;
}

} // namespace isoslider::extract
