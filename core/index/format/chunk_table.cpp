#include "core/index/format/chunk_table.h"

#include <algorithm>

#include "core/base/byte_codec.h"
#include "core/base/check.h"

namespace isoslider::index {

std::uint64_t chunkGroupCount(const ChunkGrid& grid) { return (grid.chunkCount() + kGroupChunks - 1) / kGroupChunks; }

std::uint64_t chunkTableBytes(const ChunkGrid& grid) {
    return grid.chunkCount() * kGroupEntryBytes + chunkGroupCount(grid) * kGroupDirectoryBytes;
}

std::uint64_t chunksInGroup(const ChunkGrid& grid, std::uint64_t group) {
    return std::min<std::uint64_t>(kGroupChunks, grid.chunkCount() - group * kGroupChunks);
}

void putChunkPlace(std::vector<std::byte>& table, const ChunkPlace& place) {
    ByteWriter out(table);
    out.put<std::uint16_t>(place.bytes);
    out.put<std::uint64_t>(place.checksum);
}

bool getChunkPlaces(std::span<const std::byte> table, std::uint64_t groupOffset, std::uint64_t tableAt,
                    std::span<ChunkPlace> places) {
    ISO_CHECK(table.size() == places.size() * kGroupEntryBytes);
    ByteReader in(table);
    std::uint64_t at = groupOffset;
    for (ChunkPlace& place : places) {
        place.offset = at;
        place.bytes = in.get<std::uint16_t>();
        place.checksum = in.get<std::uint64_t>();
        at += place.bytes;
    }
    return at == tableAt;
}

} // namespace isoslider::index
