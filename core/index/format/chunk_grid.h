#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "core/base/strong_id.h"
#include "core/grid/brick_grid.h"
#include "core/index/format/chunk_codec.h"

namespace isoslider::index {

struct ChunkTag;
/// A chunk, in an order with x fastest.
using ChunkIndex = StrongId<ChunkTag, std::uint64_t>;

/// The grid cut into chunks of 16^3 samples: 2^3 bricks each.
class ChunkGrid {
public:
    static constexpr int kBricksPerSide = kChunkSide / kBrickSide;

    ChunkGrid() = default;
    explicit ChunkGrid(const GridDims& dims) : dims_(dims) {
        for (std::size_t a = 0; a < 3; ++a)
            chunks_[a] = (dims[a] + kChunkSide - 1) / kChunkSide;
    }

    const GridDims& chunks() const { return chunks_; }
    std::uint64_t chunkCount() const { return static_cast<std::uint64_t>(pointCount(chunks_)); }
    ChunkIndex chunkAt(std::int64_t cx, std::int64_t cy, std::int64_t cz) const {
        return ChunkIndex(cx + chunks_[0] * (cy + chunks_[1] * cz));
    }
    std::array<std::int64_t, 3> chunkCoords(ChunkIndex chunk) const {
        const auto c = static_cast<std::int64_t>(chunk.number());
        return {c % chunks_[0], c / chunks_[0] % chunks_[1], c / (chunks_[0] * chunks_[1])};
    }
    /// Samples of a chunk along each axis: fewer than kChunkSide where the grid ends.
    ChunkExtent extent(ChunkIndex chunk) const { return pointsFrom(chunk, kChunkSide); }

private:
    std::array<int, 3> pointsFrom(ChunkIndex chunk, std::int64_t most) const {
        const auto c = chunkCoords(chunk);
        std::array<int, 3> count;
        for (std::size_t a = 0; a < 3; ++a)
            count[a] = static_cast<int>(std::min(most, dims_[a] - c[a] * kChunkSide));
        return count;
    }

    GridDims dims_{0, 0, 0};
    GridDims chunks_{0, 0, 0};
};

} // namespace isoslider::index
