#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/index/format/chunk_grid.h"

namespace isoslider::index {

/// Chunks of a group: consecutive in chunk order. Their table states where each lies, so that the directory in
/// memory has 24 bytes for a million samples, whatever the volume.
inline constexpr std::size_t kGroupChunks = 256;
/// Of a chunk in the table: its bytes, their checksum.
inline constexpr std::size_t kGroupEntryBytes = 2 + 8;
/// Of a group in the directory: where it lies, the bytes of its chunks, the checksum of its table.
inline constexpr std::size_t kGroupDirectoryBytes = 3 * 8;

/// Where a chunk lies.
struct ChunkPlace {
    std::uint64_t offset = 0;
    std::uint16_t bytes = 0;
    std::uint64_t checksum = 0;
};

std::uint64_t chunkGroupCount(const ChunkGrid& grid);
/// Bytes of the tables of all groups, and of the groups in the directory.
std::uint64_t chunkTableBytes(const ChunkGrid& grid);
/// Chunks of a group: kGroupChunks but in the last.
std::uint64_t chunksInGroup(const ChunkGrid& grid, std::uint64_t group);

/// Appends a chunk's entry; its offset follows from those before.
void putChunkPlace(std::vector<std::byte>& table, const ChunkPlace& place);
/// The places of a table's chunks, of which the first lies at `groupOffset`. False if they do not end at `tableAt`.
/// REQUIRES: `table` has kGroupEntryBytes for each place.
bool getChunkPlaces(std::span<const std::byte> table, std::uint64_t groupOffset, std::uint64_t tableAt,
                    std::span<ChunkPlace> places);

} // namespace isoslider::index
