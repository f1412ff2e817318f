#include "core/index/index_places.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "core/grid/scalar_key.h"
#include "core/index/format/chunk_table.h"
#include "core/index/index_reader.h"

namespace isoslider::index {
namespace {

constexpr std::string_view kUnnamedPart = "index page ";

// Things of `side` points along each axis, in a grid of so many of them.
PointBox boxOf(std::array<std::int64_t, 3> begin, std::array<std::int64_t, 3> end, const GridDims& counts,
               std::int64_t side, const GridDims& dims) {
    if (begin[2] != end[2]) {
        begin[1] = 0;
        end[1] = counts[1] - 1;
    }
    if (begin[2] != end[2] || begin[1] != end[1]) {
        begin[0] = 0;
        end[0] = counts[0] - 1;
    }
    PointBox box{};
    for (std::size_t a = 0; a < 3; ++a) {
        box.first[a] = begin[a] * side;
        box.last[a] = std::min(dims[a], (end[a] + 1) * side) - 1;
    }
    return box;
}

Error named(Error error, const std::string& part, const std::string& scope) {
    if (error.code != ErrorCode::Corruption && error.code != ErrorCode::IoError)
        return error;
    const std::string name = part + (scope.empty() ? "" : " (" + scope + ")");
    error.message =
        name + (error.message.starts_with(kUnnamedPart) ? " " + problemOf(error.message) : ": " + error.message);
    return error;
}

} // namespace

std::optional<std::array<double, 2>> isovaluesOf(ScalarType type, std::uint64_t firstKey, std::uint64_t lastKey) {
    return visitScalarType(type, [&](auto sample) -> std::optional<std::array<double, 2>> {
        using Sample = decltype(sample);
        const auto valueOf = [](std::uint64_t key) {
            return static_cast<double>(sampleOfKey<Sample>(static_cast<KeyOf<Sample>>(key)));
        };
        const std::array<double, 2> range{valueOf(firstKey), valueOf(lastKey)};
        if (!std::isfinite(range[0]) || !std::isfinite(range[1]))
            return std::nullopt;
        return range;
    });
}

PointBox boxOfBricks(const BrickGrid& grid, BrickIndex first, BrickIndex last) {
    return boxOf(grid.brickCoords(first), grid.brickCoords(last), grid.bricks(), kBrickSide, grid.dims());
}

PointBox boxOfChunks(const GridDims& dims, ChunkIndex first, ChunkIndex last) {
    const ChunkGrid chunks(dims);
    return boxOf(chunks.chunkCoords(first), chunks.chunkCoords(last), chunks.chunks(), kChunkSide, dims);
}

std::string textOf(const std::array<double, 2>& isovalues) {
    std::ostringstream text;
    text.imbue(std::locale::classic());
    text << "isovalues " << isovalues[0] << " to " << isovalues[1];
    return text.str();
}

std::string textOf(const PointBox& box) {
    std::ostringstream text;
    text.imbue(std::locale::classic());
    text << "grid points " << box.first[0] << ',' << box.first[1] << ',' << box.first[2] << " to " << box.last[0] << ','
         << box.last[1] << ',' << box.last[2];
    return text.str();
}

std::string problemOf(std::string_view message) {
    return std::string(message.starts_with(kUnnamedPart) ? message.substr(kUnnamedPart.size()) : message);
}

Error inPage(const IndexReader& reader, SkipLevel level, std::size_t page, Error error) {
    const PageEntry& entry = reader.meta().levels[level.index()].pages[page];
    const auto isovalues = isovaluesOf(reader.info().type, entry.firstKey, entry.lastKey);
    error.offset = entry.offset;
    return named(std::move(error), "page " + std::to_string(page) + " of level " + std::to_string(level.number()),
                 isovalues ? textOf(*isovalues) : "");
}

Error inChunk(const IndexReader& reader, ChunkIndex chunk, Error error) {
    return named(std::move(error), "chunk " + std::to_string(chunk.number()),
                 textOf(boxOfChunks(reader.info().geometry.dims, chunk, chunk)));
}

Error inChunkGroup(const IndexReader& reader, std::uint64_t group, Error error) {
    const GridDims& dims = reader.info().geometry.dims;
    const std::uint64_t first = group * kGroupChunks;
    return named(
        std::move(error), "table of chunk group " + std::to_string(group),
        textOf(boxOfChunks(dims, ChunkIndex(first), ChunkIndex(first + chunksInGroup(ChunkGrid(dims), group) - 1))));
}

} // namespace isoslider::index
