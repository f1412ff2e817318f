#pragma once

// Shared by the sources of ActiveSurface only.

#include <chrono>
#include <optional>

#include "core/extract/active_surface.h"
#include "core/cell/cell_states.h"

namespace isoslider::extract {

inline constexpr std::uint64_t kMaxVertices = std::uint64_t{1} << 31;
inline constexpr std::uint64_t kMaxTriangles = std::uint64_t{1} << 31;
inline constexpr std::uint32_t kVertexGranule = 16;
inline constexpr std::uint32_t kTriangleGranule = 16;

/// Where run `run` of a bucket begins in I.
inline std::uint32_t runInBucket(const Brick& brick, int bucket, std::uint32_t run) {
    const auto b = static_cast<std::size_t>(bucket);
    return brick.triangleBegin + brick.bucketBegin[b] + kRunLengths[b] * run;
}

/// Where the triangles of an active cell with that many begin in I.
inline std::uint32_t runBegin(const Brick& brick, LocalPoint cell, int triangles) {
    return runInBucket(brick, kBucketOf[static_cast<std::size_t>(triangles)], brick.cellRun[cell]);
}

// Where the twelve edges of each cell of a brick start: brick of the neighbourhood << 11 | local edge.
using EdgePlace = std::uint16_t;
inline constexpr int kEdgeBits = 11;
inline constexpr EdgePlace kEdgeMask = (1u << kEdgeBits) - 1;
const std::array<std::array<EdgePlace, 12>, kBrickPoints>& edgePlaces();

template <class T>
inline void prefetchLines(const T* first, std::size_t count) {
    for (std::size_t i = 0; i < count; i += 64 / sizeof(T))
        __builtin_prefetch(first + i);
}

/// States below this number have at most five triangles and no inner vertex.
inline constexpr cell::StateId kPlainStates = 256;

/// Whether signs are ambiguous: 256 bytes at hand instead of a call.
const std::array<bool, 256>& ambiguousSigns();

/// State of a cell, 0 when it is inactive.
inline cell::StateId stateOf(const Brick& brick, LocalPoint cell, const std::array<bool, 256>& isAmbiguous) {
    const std::uint8_t signs = brick.cellSigns[cell];
    return isAmbiguous[signs] ? brick.slow->state[cell] : cell::StateId{signs};
}
inline cell::StateId stateOf(const Brick& brick, LocalPoint cell) { return stateOf(brick, cell, ambiguousSigns()); }

/// Asks for a brick's lines before its turn: most of a move is waiting for memory.
inline void prefetchBrick(const Brick& brick) {
    const char* bytes = reinterpret_cast<const char*>(&brick);
    for (std::size_t line = 0; line < sizeof(Brick); line += 64)
        __builtin_prefetch(bytes + line, 1, 2);
}

/// What one thread needs during a move.
template <class Live>
struct ActiveSurface<Live>::Scratch {
    // Changes of the partition at hand, chained per brick.
    std::vector<Brick*> touched;
    std::vector<const ActivatedEdge<Live>*> activated;
    std::vector<const DeactivatedEdge*> deactivated;
    std::vector<std::uint32_t> nextActivated, nextDeactivated;
    std::vector<std::uint16_t> holes;
    // Cells of the brick at hand that must be written again, and their new states (first their signs).
    BrickBits rewritten{};
    std::array<cell::StateId, kBrickPoints> newState;
    bool hasAmbiguous = false; ///< one of them has ambiguous signs
    std::vector<LocalPoint> leavingInner; ///< cells whose inner vertices go
    std::vector<InnerCell> arrivingInner;
    std::vector<std::array<std::uint32_t, 12>> innerEdges; ///< vertices round the inner cells of a brick

    std::vector<Brick*> dirty;
    std::uint64_t added = 0;
    std::uint64_t removed = 0;
    std::uint64_t cells = 0;
    std::uint64_t resolved = 0;
    std::chrono::nanoseconds resolving{};
    std::int64_t triangleDifference = 0;
    std::int64_t ambiguousDifference = 0;
    bool isConsistent = true;
    std::optional<Error> error;

    void beginMove() {
        dirty.clear();
        added = removed = cells = resolved = 0;
        resolving = {};
        triangleDifference = ambiguousDifference = 0;
        isConsistent = true;
        error.reset();
    }
};

/// A brick and the seven above it, which own the far edges of its outermost cells. Bit 0: +x, bit 1:
/// +y, bit 2: +z. Null where there is no live brick.
template <class Live>
struct ActiveSurface<Live>::Neighbourhood {
    std::array<Brick*, 8> bricks{};
    std::array<bool, 8> isTouched{};
};

} // namespace isoslider::extract
