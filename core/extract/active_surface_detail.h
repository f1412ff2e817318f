#pragma once

// Shared by the sources of ActiveSurface only.

#include "core/extract/active_surface.h"
#include "core/extract/case_table.h"

namespace isoslider::extract {

inline constexpr std::uint64_t kMaxVertices = std::uint64_t{1} << 31;
inline constexpr std::uint64_t kMaxTriangles = std::uint64_t{1} << 31;
inline constexpr std::uint32_t kVertexGranule = 16;
inline constexpr std::uint32_t kTriangleGranule = 16;

/// Where the triangles of an active cell begin in I.
inline std::uint32_t runBegin(const Brick& brick, LocalPoint cell, int triangles) {
    return brick.triangleBegin + brick.bucketBegin[triangles] + static_cast<std::uint32_t>(triangles) * brick.cellRun[cell];
}

template <class T>
inline void prefetchLines(const T* first, std::size_t count) {
    for (std::size_t i = 0; i < count; i += 64 / sizeof(T))
        __builtin_prefetch(first + i);
}

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
    // Cells of the brick at hand that must be written again, and their new cases.
    BrickBits rewritten{};
    std::array<std::uint8_t, kBrickPoints> newCase;

    std::vector<Brick*> dirty;
    std::uint64_t added = 0;
    std::uint64_t removed = 0;
    std::uint64_t cells = 0;
    std::int64_t triangleDifference = 0;
    bool isConsistent = true;

    void beginMove() {
        dirty.clear();
        added = removed = cells = 0;
        triangleDifference = 0;
        isConsistent = true;
    }
};

/// A brick and the seven above it, which own the far edges of its outermost cells. Bit 0: +x, bit 1:
/// +y, bit 2: +z. Null where there is no live brick.
template <class Live>
struct ActiveSurface<Live>::Neighbourhood {
    std::array<const Brick*, 8> bricks{};
};

} // namespace isoslider::extract
