#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "core/base/result.h"
#include "core/grid/brick_grid.h"
#include "core/grid/scalar_type.h"
#include "core/index/format/chunk_grid.h"
#include "core/index/format/skip_level.h"

namespace isoslider::index {

class IndexReader;

/// A part of the volume: grid points, both within.
struct PointBox {
    std::array<std::int64_t, 3> first, last;
};

/// The scalars of two keys, as the range of a page or block; none where they are keys that no sample has.
std::optional<std::array<double, 2>> isovaluesOf(ScalarType type, std::uint64_t firstKey, std::uint64_t lastKey);
/// What bricks first to last cover, in their order with x fastest: whole rows where there are several, layers likewise.
PointBox boxOfBricks(const BrickGrid& grid, BrickIndex first, BrickIndex last);
/// Likewise of chunks.
PointBox boxOfChunks(const GridDims& dims, ChunkIndex first, ChunkIndex last);

/// "isovalues 3 to 5", "grid points 0,0,0 to 7,7,7".
std::string textOf(const std::array<double, 2>& isovalues);
std::string textOf(const PointBox& box);

/// What is wrong with a part, from the message of an error that calls it "index page" because it does not know which.
std::string problemOf(std::string_view message);

/// The error that reading a part has ended with, with the part's name, what it concerns, and its offset: "page 12 of
/// level 0 (isovalues 3 to 5) fails its checksum".
Error inPage(const IndexReader& reader, SkipLevel level, std::size_t page, Error error);
Error inChunk(const IndexReader& reader, ChunkIndex chunk, Error error);
Error inChunkGroup(const IndexReader& reader, std::uint64_t group, Error error);

} // namespace isoslider::index
