#pragma once

#include <array>
#include <atomic>
#include <bit>
#include <cstdint>
#include <limits>

#include "core/grid/brick_grid.h"

namespace isoslider::extract {

/// Slot of an edge that is not active.
inline constexpr std::uint16_t kNoSlot = std::numeric_limits<std::uint16_t>::max();
inline constexpr std::uint32_t kNoRun = std::numeric_limits<std::uint32_t>::max();

/// Triangles are kept in buckets by the number of triangles of a cell: five as in the paper (3.2), and one
/// for each larger number that a cell's state has. The surface checks that the list is complete.
inline constexpr std::array<std::uint8_t, 15> kRunLengths{1, 2, 3, 4, 5, 6, 8, 9, 10, 12, 18, 19, 20, 21, 22};
inline constexpr int kBuckets = static_cast<int>(kRunLengths.size());
inline constexpr int kCommonBuckets = 5; ///< those that have room to grow beforehand

/// Bucket of a number of triangles.
inline constexpr std::array<std::uint8_t, kRunLengths.back() + 1> kBucketOf = [] {
    std::array<std::uint8_t, kRunLengths.back() + 1> buckets{};
    for (int b = 0; b < kBuckets; ++b)
        buckets[kRunLengths[static_cast<std::size_t>(b)]] = static_cast<std::uint8_t>(b);
    return buckets;
}();

/// One bit per cell or grid point of a brick: word z, bit x + 8 y.
using BrickBits = std::array<std::uint64_t, 8>;

struct SlowCells;

/// The live state of one brick: its active edges and active cells (the paper's H_E and H_C, as plain
/// tables, because a brick is small) and its runs in the shared arrays E, V, N and I.
///
/// Invariants, between moves: 1. slot[e] < vertexCount exactly for edges with their active bit set,
/// and the vertex in that slot names e; slots have no holes. 2. cellSigns[c] are the signs of cell c, 0
/// when the cell is inactive, missing or outside the box; they are its state too unless they are ambiguous,
/// then that is in slow->state. 3. the triangles of an active cell are run
/// cellRun[c] of their number's bucket; runs of a bucket are numbered without holes; what is unused of the
/// triangle run is zeros. 4. `slow` lists exactly the cells whose signs are ambiguous; null when there are
/// none and no inner vertices.
struct Brick {
    BrickIndex index = 0;
    std::array<std::int32_t, 3> origin{}; ///< grid coordinates of its first point
    std::uint32_t listPosition = 0;       ///< in the surface's list of bricks

    std::uint32_t vertexBegin = kNoRun;
    std::uint32_t vertexCapacity = 0;
    std::uint32_t vertexCount = 0;

    // The buckets, one after the other in the brick's triangle run.
    std::uint32_t triangleBegin = kNoRun;
    std::uint32_t triangleCapacity = 0;
    std::array<std::uint16_t, kBuckets + 1> bucketBegin{}; ///< in triangles; [b] .. [b + 1]
    std::array<std::uint16_t, kBuckets> bucketRuns{};      ///< runs in use

    std::array<BrickBits, 3> active{};  ///< edges, by axis
    std::array<BrickBits, 3> touched{}; ///< during a move: edges that changed or whose vertex moved
    BrickBits usableCells{};            ///< inside the box, no missing corner
    BrickBits activeCells{};
    BrickBits changedCells{};           ///< whose state changed in the last move: what glows
    SlowCells* slow = nullptr;
    bool hasMissing = false;            ///< some cell has a missing corner
    std::atomic<bool> isListedDirty{false};

    // Changes waiting for this brick, as chains through the change set.
    bool isCleared = false; ///< all its edges leave
    std::uint32_t firstActivated = kNoRun;
    std::uint32_t firstDeactivated = kNoRun;
    std::uint32_t activatedCount = 0;
    std::uint32_t deactivatedCount = 0;

    std::array<std::uint16_t, kBrickEdges> slot;
    std::array<std::uint8_t, kBrickPoints> cellSigns;
    std::array<std::uint16_t, kBrickPoints> cellRun;

    bool isActiveEdge(LocalEdge edge) const { return active[edge >> 9][(edge >> 6) & 7] >> (edge & 63) & 1; }
    /// In runs.
    std::uint32_t bucketCapacity(int b) const {
        const auto at = static_cast<std::size_t>(b);
        return static_cast<std::uint32_t>(bucketBegin[at + 1] - bucketBegin[at]) / kRunLengths[at];
    }
    std::uint32_t triangleCount() const {
        std::uint32_t count = 0;
        for (std::size_t b = 0; b < kRunLengths.size(); ++b)
            count += std::uint32_t{kRunLengths[b]} * bucketRuns[b];
        return count;
    }
    /// Vertex of an active edge, as triangles name it.
    std::uint32_t vertexOf(LocalEdge edge) const { return vertexBegin + slot[edge]; }
};

inline int countBits(const BrickBits& bits) {
    int count = 0;
    for (const std::uint64_t word : bits)
        count += std::popcount(word);
    return count;
}

/// Calls visit(local) for each set bit, in order.
template <class Visit>
inline void forEachBit(const BrickBits& bits, const Visit& visit) {
    for (int z = 0; z < 8; ++z)
        for (std::uint64_t word = bits[z]; word != 0; word &= word - 1)
            visit(static_cast<LocalPoint>(64 * z + std::countr_zero(word)));
}

} // namespace isoslider::extract
