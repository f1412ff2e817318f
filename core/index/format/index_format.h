#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/grid/brick_grid.h"
#include "core/index/format/index_info.h"
#include "core/index/format/point_record.h"
#include "core/index/format/skip_level.h"

namespace isoslider::index {

/// FORMAT.md describes the bytes; this header is the one place where code knows them.
inline constexpr char kIndexMagic[12] = {'I', 'S', 'O', 'S', 'L', 'I', 'D', 'E', '\r', '\n', '\x1a', '\n'};
inline constexpr std::uint16_t kFormatMajor = 7;
inline constexpr std::uint16_t kFormatMinor = 3;
/// Up to this version normals stood in the records of pages, those of far ends too.
inline constexpr int kLastMajorWithNormals = 4;
/// Up to this version pages of a list of edges stated the keys of far ends.
inline constexpr int kLastMajorWithFarKeys = 6;
inline constexpr std::size_t kPreambleBytes = 64;
inline constexpr std::uint64_t kMaxMetaBytes = std::uint64_t{4} << 30;
inline constexpr int kMaxSkipLevels = 8;

/// The first bytes of the file: where everything else is.
struct Preamble {
    std::uint16_t major = kFormatMajor;
    std::uint16_t minor = 0; ///< minorOf() the meta
    std::uint64_t metaOffset = 0;
    std::uint64_t metaBytes = 0;
    std::uint64_t metaChecksum = 0;
    std::uint64_t fileBytes = 0;
    std::uint64_t seed = 0; ///< of all page checksums: a page of another index is never taken for one of this
};

/// One encoded page and the keys of its points.
struct PageEntry {
    std::uint64_t firstKey = 0; ///< smallest key of a point in the page
    std::uint64_t lastKey = 0; ///< largest
    std::uint64_t offset = 0;
    std::uint64_t checksum = 0;
    std::uint32_t bytes = 0;
    std::uint32_t points = 0;
    std::uint32_t edges = 0;
};

/// A block of a level above 0: the points with keys in [firstKey, lastKey], on consecutive pages.
/// Edges with both ends in that interval are redundant and left out.
struct BlockEntry {
    std::uint64_t firstKey = 0;
    std::uint64_t lastKey = 0;
    std::uint64_t firstPage = 0;
    std::uint64_t pageCount = 0;
};

/// Directory of one skip level. Level 0 has one block per distinct key, found inside its pages, and
/// no block entries; its pages are in key order. Blocks of other levels are in key order, disjoint.
struct LevelDirectory {
    std::vector<PageEntry> pages;
    std::vector<BlockEntry> blocks;
};

/// Chunks that lie one after the other, and the table of them that follows (chunk_table.h): a group.
struct ChunkGroupEntry {
    std::uint64_t offset = 0;
    std::uint64_t chunkBytes = 0; ///< of its chunks; the table begins there
    std::uint64_t checksum = 0; ///< of the table
};

/// Cells of a brick that have a missing corner: bit x + 8 y + 64 z.
struct MissingCells {
    BrickIndex brick;
    std::uint64_t cells[8] = {};
};

/// Everything but the pages.
struct IndexMeta {
    IndexInfo info;
    std::vector<LevelDirectory> levels;
    std::vector<ChunkGroupEntry> chunkGroups; ///< as many as the grid needs; none of a list of bricks
    std::vector<MissingCells> missingCells; ///< sorted by brick
};

/// What pages of the index state of far ends. Lists of bricks, which are small, state keys.
inline FarEnds farEndsOf(const IndexInfo& info) {
    return info.kind == IndexKind::Edges && info.formatMajor > kLastMajorWithFarKeys ? FarEnds::Directions
                                                                                     : FarEnds::Keys;
}
/// Whether a page belongs to the index, by what it has.
inline bool isPageOfVersion(const IndexInfo& info, bool hasNormals, FarEnds farEnds) {
    return (!hasNormals || info.formatMajor <= kLastMajorWithNormals) && farEnds == farEndsOf(info);
}
/// Not of a list of bricks.
inline bool hasSampleChunks(const IndexInfo& info) { return info.kind != IndexKind::BrickList; }

std::vector<std::byte> encodePreamble(const Preamble& preamble);
/// Errors: InvalidArgument (not an index), UnsupportedVersion, Corruption.
Result<Preamble> decodePreamble(std::span<const std::byte> bytes, std::uint64_t fileBytes, const std::string& path);

/// The least minor version whose readers know all of `meta`: 0 of volumes without a unit
/// that were not resampled.
std::uint16_t minorOf(const IndexMeta& meta);

std::vector<std::byte> encodeMeta(const IndexMeta& meta);
/// Checks every field against the file's size and the grid. Errors: Corruption.
Result<IndexMeta> decodeMeta(std::span<const std::byte> bytes, const Preamble& preamble, const std::string& path);

std::uint64_t metaChecksum(std::span<const std::byte> bytes);
/// Depends on the index (seed) and the page's place, so that swapped pages are found.
std::uint64_t pageChecksum(std::span<const std::byte> bytes, std::uint64_t seed, std::uint64_t offset);

/// True when the file begins like an index of any version.
bool hasIndexMagic(std::span<const std::byte> firstBytes);

} // namespace isoslider::index
