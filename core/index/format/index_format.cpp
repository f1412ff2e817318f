#include "core/index/format/index_format.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include <xxhash.h>
#include <zstd.h>

#include "core/base/byte_codec.h"
#include "core/base/check.h"
#include "core/base/plain_text.h"
#include "core/grid/length_unit.h"
#include "core/index/format/chunk_table.h"
#include "core/index/format/zstd_contexts.h"

namespace isoslider::index {
namespace {

// The first versions that are read, of each kind.
constexpr std::uint16_t kFirstMajorOfEdges = 6, kFirstMajorOfMetacells = 4;

constexpr std::size_t kMaxStringBytes = 4096;
constexpr std::size_t kMaxHistogramBins = 1u << 16;
constexpr std::size_t kMissingCellsBytes = 4 + 64;
constexpr std::size_t kMaxResamplingBytes = 500;
constexpr std::size_t kMaxPackingRatio = 1u << 15; // a zstd block of 128 KiB takes 3 bytes and more

std::uint64_t hashBytes(std::span<const std::byte> bytes, std::uint64_t seed) {
    return XXH3_64bits_withSeed(bytes.data(), bytes.size(), seed);
}

void putGeometry(ByteWriter& out, const GridGeometry& geometry) {
    for (int a = 0; a < 3; ++a)
        out.put<std::int64_t>(geometry.dims[a]);
    for (int a = 0; a < 3; ++a)
        out.put<double>(geometry.spacing[a]);
    for (int a = 0; a < 3; ++a)
        out.put<double>(geometry.origin[a]);
    for (int column = 0; column < 3; ++column)
        for (int row = 0; row < 3; ++row)
            out.put<double>(geometry.direction[column][row]);
}

bool getGeometry(ByteReader& in, GridGeometry& geometry) {
    bool isSane = true;
    for (int a = 0; a < 3; ++a) {
        geometry.dims[a] = in.get<std::int64_t>();
        isSane = isSane && geometry.dims[a] >= 1 && geometry.dims[a] <= kMaxDim;
    }
    for (int a = 0; a < 3; ++a) {
        geometry.spacing[a] = in.get<double>();
        isSane = isSane && std::isfinite(geometry.spacing[a]) && geometry.spacing[a] != 0.0;
    }
    for (int a = 0; a < 3; ++a)
        geometry.origin[a] = in.get<double>();
    for (int column = 0; column < 3; ++column)
        for (int row = 0; row < 3; ++row)
            geometry.direction[column][row] = in.get<double>();
    return isSane && !in.hasFailed() && pointCount(geometry.dims) <= kMaxPoints &&
           BrickGrid(geometry.dims).brickCount() <= std::numeric_limits<BrickIndex::NumberType>::max();
}

// In order, and samples of the type.
bool isRangeOf(ScalarType type, double min, double max) {
    return visitScalarType(type, [&](auto sample) {
        using Limits = std::numeric_limits<decltype(sample)>;
        return min <= max && min >= static_cast<double>(Limits::lowest()) && max <= static_cast<double>(Limits::max());
    });
}

void putLevel(ByteWriter& out, const SkipLevelInfo& info, const LevelDirectory& level) {
    for (const std::uint64_t value :
         {info.blocks, info.points, info.edges, info.activatedEdges, info.bytes, info.redundantRemoved})
        out.put<std::uint64_t>(value);
    out.put<std::uint64_t>(level.pages.size());
    out.put<std::uint64_t>(level.blocks.size());
    for (const PageEntry& page : level.pages) {
        for (const std::uint64_t value : {page.firstKey, page.lastKey, page.offset, page.checksum})
            out.put<std::uint64_t>(value);
        for (const std::uint32_t value : {page.bytes, page.points, page.edges})
            out.put<std::uint32_t>(value);
    }
    for (const BlockEntry& block : level.blocks)
        for (const std::uint64_t value : {block.firstKey, block.lastKey, block.firstPage, block.pageCount})
            out.put<std::uint64_t>(value);
}

constexpr std::size_t kPageEntryBytes = 44;
constexpr std::size_t kBlockEntryBytes = 32;

// Reports what is wrong, or nothing.
const char* getLevel(ByteReader& in, bool isLevel0, SkipLevelInfo& info, LevelDirectory& level,
                     const Preamble& preamble) {
    for (std::uint64_t* value :
         {&info.blocks, &info.points, &info.edges, &info.activatedEdges, &info.bytes, &info.redundantRemoved})
        *value = in.get<std::uint64_t>();
    const std::uint64_t pages = in.get<std::uint64_t>();
    const std::uint64_t blocks = in.get<std::uint64_t>();
    if (in.hasFailed() || pages > in.remaining() / kPageEntryBytes || blocks > in.remaining() / kBlockEntryBytes)
        return "level directory is cut off";
    level.pages.resize(pages);
    level.blocks.resize(blocks);
    for (PageEntry& page : level.pages) {
        for (std::uint64_t* value : {&page.firstKey, &page.lastKey, &page.offset, &page.checksum})
            *value = in.get<std::uint64_t>();
        for (std::uint32_t* value : {&page.bytes, &page.points, &page.edges})
            *value = in.get<std::uint32_t>();
        if (page.firstKey > page.lastKey || page.offset < kPreambleBytes || page.offset > preamble.metaOffset ||
            page.bytes > preamble.metaOffset - page.offset)
            return "page entry";
    }
    if (isLevel0)
        for (std::size_t i = 1; i < level.pages.size(); ++i)
            if (level.pages[i].firstKey < level.pages[i - 1].lastKey)
                return "pages of level 0 are out of order";
    std::uint64_t nextPage = 0;
    for (std::size_t i = 0; i < level.blocks.size(); ++i) {
        BlockEntry& block = level.blocks[i];
        for (std::uint64_t* value : {&block.firstKey, &block.lastKey, &block.firstPage, &block.pageCount})
            *value = in.get<std::uint64_t>();
        if (block.firstKey > block.lastKey || (i > 0 && block.firstKey <= level.blocks[i - 1].lastKey) ||
            block.firstPage != nextPage || block.pageCount > pages - nextPage)
            return "block entry";
        nextPage += block.pageCount;
    }
    return in.hasFailed() ? "level directory is cut off" : nullptr;
}

void putChunkGroups(ByteWriter& out, const IndexMeta& meta) {
    out.put<std::uint64_t>(meta.info.chunkBytes);
    out.put<std::uint64_t>(meta.chunkGroups.size());
    for (const ChunkGroupEntry& group : meta.chunkGroups)
        for (const std::uint64_t value : {group.offset, group.chunkBytes, group.checksum})
            out.put<std::uint64_t>(value);
}

bool getChunkGroups(ByteReader& in, IndexMeta& meta, const Preamble& preamble) {
    meta.info.chunkBytes = in.get<std::uint64_t>();
    const std::uint64_t count = in.get<std::uint64_t>();
    const ChunkGrid grid(meta.info.geometry.dims);
    if (in.hasFailed() || count > in.remaining() / kGroupDirectoryBytes ||
        count != (hasSampleChunks(meta.info) ? chunkGroupCount(grid) : 0))
        return false;
    meta.chunkGroups.resize(count);
    for (std::uint64_t i = 0; i < count; ++i) {
        ChunkGroupEntry& group = meta.chunkGroups[i];
        for (std::uint64_t* value : {&group.offset, &group.chunkBytes, &group.checksum})
            *value = in.get<std::uint64_t>();
        const std::uint64_t chunks = chunksInGroup(grid, i);
        const std::uint64_t room = preamble.metaOffset - chunks * kGroupEntryBytes;
        if (preamble.metaOffset < chunks * kGroupEntryBytes || group.offset < kPreambleBytes || group.offset > room ||
            group.chunkBytes > room - group.offset)
            return false;
    }
    return true;
}

void putMissingCells(ByteWriter& out, const std::vector<MissingCells>& bricks) {
    std::vector<std::byte> plain;
    ByteWriter writer(plain);
    for (const MissingCells& brick : bricks) {
        writer.put<std::uint32_t>(brick.brick.number());
        for (const std::uint64_t cells : brick.cells)
            writer.put<std::uint64_t>(cells);
    }
    std::vector<std::byte> packed(ZSTD_compressBound(plain.size()));
    const std::size_t size = orOutOfMemory(ZSTD_compress(packed.data(), packed.size(), plain.data(), plain.size(), 3));
    ISO_CHECK(!ZSTD_isError(size)); // there is room for whatever comes of it
    packed.resize(size);
    out.put<std::uint64_t>(bricks.size());
    out.put<std::uint64_t>(packed.size());
    out.putBytes(packed);
}

bool getMissingCells(ByteReader& in, std::vector<MissingCells>& bricks, const BrickGrid& grid) {
    const std::uint64_t count = in.get<std::uint64_t>();
    const std::uint64_t packedBytes = in.get<std::uint64_t>();
    if (in.hasFailed() || count > grid.brickCount() || packedBytes > in.remaining())
        return false;
    const auto packed = in.getBytes(packedBytes);
    // The packed frame's own word, and what zstd can at best achieve, before memory is taken.
    if (count > 0 && (ZSTD_getFrameContentSize(packed.data(), packed.size()) != count * kMissingCellsBytes ||
                      count * kMissingCellsBytes > (packedBytes + 1) * kMaxPackingRatio))
        return false;
    std::vector<std::byte> plain(count * kMissingCellsBytes);
    const std::size_t size = orOutOfMemory(ZSTD_decompress(plain.data(), plain.size(), packed.data(), packed.size()));
    if (ZSTD_isError(size) || size != plain.size())
        return false;
    ByteReader reader(plain);
    bricks.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
        bricks[i].brick = BrickIndex(reader.get<std::uint32_t>());
        for (std::uint64_t& cells : bricks[i].cells)
            cells = reader.get<std::uint64_t>();
        if (bricks[i].brick.number() >= grid.brickCount() || (i > 0 && bricks[i].brick <= bricks[i - 1].brick))
            return false;
    }
    return true;
}

bool getMergeError(ByteReader& in, IndexInfo& info) {
    const std::uint8_t measure = in.get<std::uint8_t>();
    info.isMergeErrorInCells = measure == 1;
    info.mergeError = in.get<double>();
    return !in.hasFailed() && measure <= 1 && std::isfinite(info.mergeError) && info.mergeError >= 0.0 &&
           (!(info.mergeError > 0.0) || info.kind == IndexKind::Edges);
}

Error tooOld(std::uint16_t major, const char* flaw, const std::string& path) {
    return makeError(ErrorCode::UnsupportedVersion,
                     "index has format version " + std::to_string(major) + ", which " + flaw +
                         "; this program reads versions " + std::to_string(kFirstMajorOfMetacells) + " to " +
                         std::to_string(kFormatMajor) + " and, of edges, " + std::to_string(kFirstMajorOfEdges) +
                         ": build it again from its volume",
                     path, sizeof kIndexMagic);
}

} // namespace

const char* indexKindName(IndexKind kind) { return kind == IndexKind::Edges ? "edges" : "metacells"; }

bool hasIndexMagic(std::span<const std::byte> firstBytes) {
    return firstBytes.size() >= sizeof kIndexMagic &&
           std::memcmp(firstBytes.data(), kIndexMagic, sizeof kIndexMagic) == 0;
}

std::uint64_t metaChecksum(std::span<const std::byte> bytes) { return hashBytes(bytes, 0); }

std::uint64_t pageChecksum(std::span<const std::byte> bytes, std::uint64_t seed, std::uint64_t offset) {
    return hashBytes(bytes, seed ^ (offset * 0x9e3779b97f4a7c15ull));
}

std::vector<std::byte> encodePreamble(const Preamble& preamble) {
    std::vector<std::byte> bytes;
    ByteWriter out(bytes);
    out.putBytes(std::as_bytes(std::span(kIndexMagic)));
    out.put<std::uint16_t>(preamble.major);
    out.put<std::uint16_t>(preamble.minor);
    for (const std::uint64_t value :
         {preamble.metaOffset, preamble.metaBytes, preamble.metaChecksum, preamble.fileBytes, preamble.seed})
        out.put<std::uint64_t>(value);
    out.put<std::uint64_t>(hashBytes(bytes, 0));
    ISO_CHECK(bytes.size() == kPreambleBytes);
    return bytes;
}

Result<Preamble> decodePreamble(std::span<const std::byte> bytes, std::uint64_t fileBytes, const std::string& path) {
    if (!hasIndexMagic(bytes))
        return makeError(ErrorCode::InvalidArgument, "not an ISOSLIDER index: it does not begin with \"ISOSLIDE\"",
                         path, 0);
    ByteReader in(bytes);
    in.getBytes(sizeof kIndexMagic);
    Preamble preamble;
    preamble.major = in.get<std::uint16_t>();
    preamble.minor = in.get<std::uint16_t>();
    if (bytes.size() < kPreambleBytes)
        return makeError(ErrorCode::Corruption, "index ends inside its header", path, bytes.size());
    if (preamble.major > kFormatMajor)
        return makeError(ErrorCode::UnsupportedVersion,
                         "index was made by a newer version of the program: it has format version " +
                             std::to_string(preamble.major) + ", this program reads version " +
                             std::to_string(kFormatMajor) + ": open it with that version, or build it again",
                         path, sizeof kIndexMagic);
    if (preamble.major < kFirstMajorOfMetacells)
        return tooOld(preamble.major, "keeps samples in another way, or none", path);
    for (std::uint64_t* value :
         {&preamble.metaOffset, &preamble.metaBytes, &preamble.metaChecksum, &preamble.fileBytes, &preamble.seed})
        *value = in.get<std::uint64_t>();
    if (in.get<std::uint64_t>() != hashBytes(bytes.first(kPreambleBytes - 8), 0))
        return makeError(ErrorCode::Corruption, "index header fails its checksum", path, 0);
    if (preamble.fileBytes > fileBytes) // what follows an index is an appendix
        return makeError(ErrorCode::Corruption,
                         "index should have " + std::to_string(preamble.fileBytes) + " bytes, the file has " +
                             std::to_string(fileBytes),
                         path);
    if (preamble.metaOffset < kPreambleBytes || preamble.metaOffset > preamble.fileBytes ||
        preamble.metaBytes > preamble.fileBytes - preamble.metaOffset || preamble.metaBytes > kMaxMetaBytes)
        return makeError(ErrorCode::Corruption, "index header points outside the file", path, 16);
    return preamble;
}

std::uint16_t minorOf(const IndexMeta& meta) {
    if (meta.info.isPatientSpace)
        return 3;
    return !meta.info.resampling.empty() ? 2 : meta.info.lengthUnit.empty() ? 0 : 1;
}

std::vector<std::byte> encodeMeta(const IndexMeta& meta) {
    std::vector<std::byte> bytes;
    ByteWriter out(bytes);
    const IndexInfo& info = meta.info;
    out.put<std::uint8_t>(static_cast<std::uint8_t>(info.kind));
    out.put<std::uint8_t>(static_cast<std::uint8_t>(info.type));
    putGeometry(out, info.geometry);
    out.put<double>(info.min);
    out.put<double>(info.max);
    out.put<std::uint64_t>(info.distinctValues);
    out.put<std::uint64_t>(info.nanCount);
    out.put<double>(info.redundancyThreshold);
    out.putString(info.sourceName);
    out.put<double>(info.histogram.min);
    out.put<double>(info.histogram.max);
    out.put<std::uint32_t>(static_cast<std::uint32_t>(info.histogram.counts.size()));
    for (std::size_t i = 0; i < info.histogram.counts.size(); ++i) {
        out.put<std::uint64_t>(info.histogram.counts[i]);
        out.put<std::uint64_t>(info.activeEdgesPerBin[i]);
    }
    out.put<std::uint32_t>(static_cast<std::uint32_t>(meta.levels.size()));
    for (std::size_t i = 0; i < meta.levels.size(); ++i)
        putLevel(out, info.levels[i], meta.levels[i]);
    putChunkGroups(out, meta);
    putMissingCells(out, meta.missingCells);
    out.put<std::uint8_t>(info.isMergeErrorInCells);
    out.put<double>(info.mergeError);
    if (minorOf(meta) >= 1)
        out.putString(info.lengthUnit);
    if (minorOf(meta) >= 2)
        out.putString(oneLine(info.resampling).substr(0, kMaxResamplingBytes));
    if (minorOf(meta) >= 3)
        out.put<std::uint8_t>(info.isPatientSpace);
    return bytes;
}

Result<IndexMeta> decodeMeta(std::span<const std::byte> bytes, const Preamble& preamble, const std::string& path) {
    const auto corrupt = [&](const char* what) {
        return makeError(ErrorCode::Corruption, std::string("index directory is damaged: ") + what, path,
                         preamble.metaOffset);
    };
    IndexMeta meta;
    IndexInfo& info = meta.info;
    ByteReader in(bytes);
    const std::uint8_t kind = in.get<std::uint8_t>();
    if (kind > static_cast<std::uint8_t>(IndexKind::BrickList))
        return corrupt("kind of index");
    info.kind = static_cast<IndexKind>(kind);
    info.formatMajor = preamble.major;
    if (preamble.major < kFirstMajorOfEdges && info.kind == IndexKind::Edges)
        return tooOld(preamble.major, "keeps no samples with the edges", path);
    const std::uint8_t type = in.get<std::uint8_t>();
    if (type >= kAllScalarTypes.size())
        return corrupt("scalar type");
    info.type = static_cast<ScalarType>(type);
    if (!getGeometry(in, info.geometry))
        return corrupt("geometry");
    info.min = in.get<double>();
    info.max = in.get<double>();
    info.distinctValues = in.get<std::uint64_t>();
    info.nanCount = in.get<std::uint64_t>();
    info.redundancyThreshold = in.get<double>();
    info.sourceName = in.getString(kMaxStringBytes);
    info.histogram.min = in.get<double>();
    info.histogram.max = in.get<double>();
    const std::size_t bins = in.get<std::uint32_t>();
    if (in.hasFailed() || bins > kMaxHistogramBins || !isRangeOf(info.type, info.min, info.max))
        return corrupt("value range or histogram");
    for (std::size_t i = 0; i < bins; ++i) {
        info.histogram.counts.push_back(in.get<std::uint64_t>());
        info.activeEdgesPerBin.push_back(in.get<std::uint64_t>());
    }
    const std::size_t levels = in.get<std::uint32_t>();
    if (levels < 1 || levels > kMaxSkipLevels)
        return corrupt("number of skip levels");
    info.levels.resize(levels);
    meta.levels.resize(levels);
    for (std::size_t i = 0; i < levels; ++i)
        if (const char* fault = getLevel(in, i == 0, info.levels[i], meta.levels[i], preamble))
            return corrupt(fault);
    if (preamble.major < kFirstMajorOfEdges && in.get<std::uint64_t>() != 0) // pages that only edges had
        return corrupt("pages of metacells");
    if (!getChunkGroups(in, meta, preamble))
        return corrupt("chunk groups");
    if (!getMissingCells(in, meta.missingCells, BrickGrid(info.geometry.dims)))
        return corrupt("missing cells");
    if (!getMergeError(in, info))
        return corrupt("error of merged cells");
    if (preamble.minor >= 1)
        info.lengthUnit = in.getString(kMaxLengthUnitBytes);
    if (!isLengthUnit(info.lengthUnit))
        return corrupt("unit of length");
    if (preamble.minor >= 2)
        info.resampling = in.getString(kMaxResamplingBytes);
    if (oneLine(info.resampling) != info.resampling)
        return corrupt("line on resampling");
    if (preamble.minor >= 3) {
        const std::uint8_t places = in.get<std::uint8_t>();
        if (places > 1)
            return corrupt("what its places are");
        info.isPatientSpace = places == 1;
    }
    // A later minor version may have more to say, which a reader of this one need not know.
    if (in.hasFailed() || (in.remaining() != 0 && preamble.minor <= kFormatMinor))
        return corrupt("length");
    info.indexBytes = preamble.fileBytes;
    return meta;
}

} // namespace isoslider::index
