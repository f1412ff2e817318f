#pragma once

#include <array>
#include <cstdint>

#include "core/extract/live/brick_bits.h"
#include "core/extract/live/run_arena.h"
#include "core/extract/merged/merge_bound.h"
#include "core/grid/brick_grid.h"

namespace isoslider::extract {

/// What is needed of a brick that is not made: all but its bits.
struct LiveBrickHead {
    BrickIndex index;
    ArenaRun vertices, indices, inner, points, ambiguous, merged;
    std::uint32_t indexCount = 0;
    std::uint32_t pointsVersion = 0; ///< the move that brought the points
    std::uint16_t edgeVertices = 0;
    std::uint16_t innerVertices = 0;
    std::uint16_t ambiguousCells = 0;
    std::uint16_t mergedCells = 0; ///< that the surface passes through
    std::array<std::uint8_t, kMaxBrickMergeLevel> mergedByLevel{}; ///< the same of side 2, 4 and 8
    std::uint16_t cellCount = 0; ///< of `cells`
    std::uint16_t ownedEdges = 0;
    bool isLive = false;
    bool isNearMissing = false;
    bool hasPoints = false; ///< else nothing is in its run of points
};

/// What the live surface keeps of one of its bricks. The bits are those of the last brick in its place until it is made
/// for the first time.
struct LiveBrick : LiveBrickHead {
    BitString above; ///< signs of the corners of its active cells; other points may have any
    BitString cells; ///< active ones that are not merged
    BitString changed; ///< cells that the last move which replaced the brick has changed
};

} // namespace isoslider::extract
