#pragma once

#include <array>
#include <cstdint>
#include <cstring>

#include "core/extract/live/brick_bits.h"
#include "core/extract/live/run_arena.h"
#include "core/extract/merged/merge_bound.h"
#include "core/grid/brick_grid.h"

namespace isoslider::extract {

/// What is needed of a brick that is not made: all but its bits. What tells where else to look comes first, and is in
/// one cache line.
struct LiveBrickHead {
    BrickIndex index;
    std::uint16_t ambiguousCells = 0;
    bool isLive = false;
    bool hasPoints = false; ///< else nothing is in its run of points
    ArenaRun points, ambiguous, vertices, indices, inner, merged;
    std::uint32_t indexCount = 0;
    std::uint32_t pointsVersion = 0; ///< the move that put the points where they are
    std::uint16_t cellCount = 0; ///< of `cells`
    std::uint16_t edgeVertices = 0;
    std::uint16_t innerVertices = 0;
    std::uint16_t ownedEdges = 0;
    std::uint16_t mergedCells = 0; ///< that the surface passes through
    std::array<std::uint8_t, kMaxBrickMergeLevel> mergedByLevel{}; ///< the same of side 2, 4 and 8
    bool isNearMissing = false;
};

/// The bits of a brick, those of the last one in its place until it is made for the first time.
class LiveBrickBits {
public:
    /// Signs of the corners of its active cells; other points may have any.
    BitsInMemory above() const { return BitsInMemory(words_.data()); }
    /// Active ones that are not merged.
    BitsInMemory cells() const { return BitsInMemory(words_.data() + kBitWords); }
    /// Cells that the last move which replaced the brick has changed.
    BitsInMemory changed() const { return BitsInMemory(words_.data() + 2 * kBitWords); }

    void set(const BitString& above, const BitString& cells, const BitString& changed) {
        std::uint64_t* out = words_.data();
        for (const BitString* bits : {&above, &cells, &changed}) {
            std::memcpy(out, bits->words.data(), kBitWords * sizeof *out);
            out += kBitWords;
        }
    }

private:
    std::array<std::uint64_t, 3 * kBitWords> words_{};
};

/// What the live surface keeps of one of its bricks. There are many: each is as many cache lines as it must be.
struct alignas(64) LiveBrick : LiveBrickBits, LiveBrickHead {};
static_assert(sizeof(LiveBrick) == 6 * 64);

} // namespace isoslider::extract
