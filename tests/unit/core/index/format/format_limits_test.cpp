// Each limit of FORMAT.md, "Limits": what is at it is read, what is one past it is refused.

#include <algorithm>
#include <functional>
#include <limits>

#include <gtest/gtest.h>

#include "core/index/format/block_codec.h"
#include "core/index/format/chunk_codec.h"
#include "core/index/format/chunk_table.h"
#include "core/index/format/index_format.h"
#include "tests/support/result_matchers.h"

namespace isoslider::index {
namespace {

using test::HasError;
using test::IsOk;

constexpr std::uint64_t kMetaOffset = std::uint64_t{1} << 20;

IndexMeta leastMeta() {
    IndexMeta meta;
    meta.info.geometry.dims = {16, 16, 16};
    meta.info.levels.resize(1);
    meta.levels.resize(1);
    return meta;
}

// Where nothing is said of chunks, as many groups as the grid needs.
Status statusOf(IndexMeta meta) {
    if (meta.chunkGroups.empty())
        meta.chunkGroups.assign(chunkGroupCount(ChunkGrid(meta.info.geometry.dims)), {kPreambleBytes, 0, 0});
    const auto bytes = encodeMeta(meta);
    Preamble preamble;
    preamble.minor = minorOf(meta);
    preamble.metaOffset = kMetaOffset;
    preamble.metaBytes = bytes.size();
    preamble.fileBytes = kMetaOffset + bytes.size();
    const auto decoded = decodeMeta(bytes, preamble, "x");
    return decoded.isOk() ? Status() : Status(decoded.error());
}

/// `set` brings a meta to a limit: the last argument is how far past it.
void expectLimit(const char* what, const std::function<void(IndexMeta&, std::int64_t past)>& set) {
    for (const std::int64_t past : {0, 1}) {
        IndexMeta meta = leastMeta();
        set(meta, past);
        if (past == 0)
            EXPECT_THAT(statusOf(meta), IsOk()) << what;
        else
            EXPECT_THAT(statusOf(meta), HasError(ErrorCode::Corruption)) << what;
    }
}

void setBins(IndexMeta& meta, std::int64_t bins) {
    meta.info.histogram.counts.assign(static_cast<std::size_t>(bins), 0);
    meta.info.activeEdgesPerBin.assign(static_cast<std::size_t>(bins), 0);
}

PageEntry pageAt(std::uint64_t offset, std::uint32_t bytes, std::uint64_t firstKey = 0, std::uint64_t lastKey = 0) {
    PageEntry page;
    page.offset = offset;
    page.bytes = bytes;
    page.firstKey = firstKey;
    page.lastKey = lastKey;
    return page;
}

TEST(FormatLimits, OfTheVolume) {
    expectLimit("points along x", [](IndexMeta& meta, auto past) { meta.info.geometry.dims = {kMaxDim + past, 1, 1}; });
    expectLimit("points along z", [](IndexMeta& meta, auto past) { meta.info.geometry.dims = {1, 1, kMaxDim + past}; });
    expectLimit("least extent", [](IndexMeta& meta, auto past) { meta.info.geometry.dims = {4, 1 - past, 4}; });
    expectLimit("points in all", [](IndexMeta& meta, auto past) {
        meta.info.geometry.dims = {kMaxDim, kMaxDim / 16, 16 + past};
    });
    expectLimit("bricks", [](IndexMeta& meta, auto past) { // 2^32 of them are one too many
        meta.info.geometry.dims = {kMaxDim, kMaxDim / 4 - 8 + 8 * past, 1};
    });
    expectLimit("spacing", [](IndexMeta& meta, auto past) {
        meta.info.geometry.spacing[1] = past == 0 ? std::numeric_limits<double>::denorm_min() : 0.0;
    });
    expectLimit("least value of the type", [](IndexMeta& meta, auto past) {
        meta.info.type = ScalarType::I16;
        meta.info.min = -32768.0 - static_cast<double>(past);
    });
    expectLimit("greatest value of the type",
                [](IndexMeta& meta, auto past) { meta.info.max = 255.0 + static_cast<double>(past); });
}

TEST(FormatLimits, OfTextsAndTables) {
    expectLimit("bytes of the name", [](IndexMeta& meta, auto past) {
        meta.info.sourceName.assign(static_cast<std::size_t>(4096 + past), 'n');
    });
    expectLimit("characters of the unit", [](IndexMeta& meta, auto past) {
        meta.info.lengthUnit.assign(static_cast<std::size_t>(16 + past), 'm');
    });
    expectLimit("bins", [](IndexMeta& meta, auto past) { setBins(meta, 65536 + past); });
    expectLimit("levels", [](IndexMeta& meta, auto past) {
        meta.info.levels.resize(static_cast<std::size_t>(8 + past));
        meta.levels.resize(meta.info.levels.size());
    });
    expectLimit("no level", [](IndexMeta& meta, auto past) {
        meta.info.levels.resize(static_cast<std::size_t>(1 - past));
        meta.levels.resize(meta.info.levels.size());
    });
}

// Writers cut the line, so a longer one is put into the bytes.
TEST(FormatLimits, OfTheLineOnResampling) {
    IndexMeta meta = leastMeta();
    meta.chunkGroups = {{kPreambleBytes, 0, 0}};
    meta.info.resampling.assign(501, 'r');
    const auto decode = [&](const std::vector<std::byte>& bytes) {
        Preamble preamble;
        preamble.minor = minorOf(meta);
        preamble.metaOffset = kMetaOffset;
        preamble.metaBytes = bytes.size();
        preamble.fileBytes = kMetaOffset + bytes.size();
        return decodeMeta(bytes, preamble, "x");
    };
    auto bytes = encodeMeta(meta);
    const auto decoded = decode(bytes);
    ASSERT_THAT(decoded, IsOk());
    EXPECT_EQ(decoded.value().info.resampling, std::string(500, 'r'));
    const std::vector<std::byte> line(500, std::byte{'r'});
    const auto found = std::search(bytes.begin(), bytes.end(), line.begin(), line.end());
    ASSERT_NE(found, bytes.end());
    const auto length = found - 4;
    ASSERT_EQ(std::to_integer<int>(length[0]) + 256 * std::to_integer<int>(length[1]), 500);
    length[0] = static_cast<std::byte>(501 & 255);
    bytes.insert(bytes.begin() + (found - bytes.begin()), std::byte{'r'});
    EXPECT_THAT(decode(bytes), HasError(ErrorCode::Corruption));
}

TEST(FormatLimits, OfTheFile) {
    for (const std::uint64_t past : {0, 1}) {
        Preamble preamble;
        preamble.metaOffset = kMetaOffset;
        preamble.metaBytes = kMaxMetaBytes + past;
        preamble.fileBytes = kMetaOffset + preamble.metaBytes;
        const auto decoded = decodePreamble(encodePreamble(preamble), preamble.fileBytes, "x");
        EXPECT_EQ(decoded.isOk(), past == 0) << "bytes of the meta";
        // The file itself has no limit but its number: what it states has to be there.
        preamble.metaBytes = 100;
        preamble.metaOffset = std::numeric_limits<std::uint64_t>::max() - 100 + past;
        preamble.fileBytes = std::numeric_limits<std::uint64_t>::max();
        const auto largest = decodePreamble(encodePreamble(preamble), preamble.fileBytes, "x");
        EXPECT_EQ(largest.isOk(), past == 0) << "end of the meta";
        preamble.fileBytes = kMetaOffset + past;
        preamble.metaOffset = kMetaOffset - 100;
        const auto shorter = decodePreamble(encodePreamble(preamble), kMetaOffset, "x");
        EXPECT_EQ(shorter.isOk(), past == 0) << "bytes of the file";
    }
}

TEST(FormatLimits, OfEntries) {
    expectLimit("end of a page", [](IndexMeta& meta, auto past) {
        meta.levels[0].pages = {pageAt(kMetaOffset - 100, static_cast<std::uint32_t>(100 + past))};
    });
    expectLimit("begin of a page", [](IndexMeta& meta, auto past) {
        meta.levels[0].pages = {pageAt(kPreambleBytes - static_cast<std::uint64_t>(past), 100)};
    });
    expectLimit("keys of pages", [](IndexMeta& meta, auto past) {
        meta.levels[0].pages = {pageAt(64, 10, 3, 5), pageAt(74, 10, static_cast<std::uint64_t>(5 - past), 9)};
    });
    expectLimit("keys of blocks", [](IndexMeta& meta, auto past) {
        meta.info.levels.resize(2);
        meta.levels.resize(2);
        meta.levels[1].blocks = {{0, 4, 0, 0}, {static_cast<std::uint64_t>(5 - past), 9, 0, 0}};
    });
    expectLimit("bricks with missing cells", [](IndexMeta& meta, auto past) {
        meta.missingCells = {{BrickIndex(static_cast<std::uint32_t>(7 + past)), {1}}};
    });
}

// Their fields cannot state more; what they state has to be there.
TEST(FormatLimits, OfBytesOfAPage) {
    constexpr std::uint32_t kMost = std::numeric_limits<std::uint32_t>::max();
    for (const std::uint64_t past : {0, 1}) {
        IndexMeta meta = leastMeta();
        meta.levels[0].pages = {pageAt(kPreambleBytes, kMost)};
        meta.chunkGroups = {{kPreambleBytes, 0, 0}};
        Preamble preamble;
        const auto bytes = encodeMeta(meta);
        preamble.metaOffset = kPreambleBytes + kMost - past;
        preamble.metaBytes = bytes.size();
        preamble.fileBytes = preamble.metaOffset + bytes.size();
        EXPECT_EQ(decodeMeta(bytes, preamble, "x").isOk(), past == 0);
    }
}

TEST(FormatLimits, OfBytesOfAPlane) {
    const BrickGrid grid({2, 2, 2});
    PointRecord<std::uint16_t> record;
    record.setId(PointId(0));
    record.edgeMask = 2;
    auto bytes = encodePage<std::uint16_t>(std::span(&record, 1), PageOrder::Value, FarEnds::Directions, grid);
    DecodedPage<std::uint16_t> page;
    ASSERT_THAT(decodePage<std::uint16_t>(bytes, grid, page, "x"), IsOk());
    constexpr std::size_t kPlaneTable = 32;
    for (const std::uint8_t mode : {0, 1, 2}) { // 2^30 - 1 bytes, of which none is there
        for (std::size_t i = 0; i < 3; ++i)
            bytes[kPlaneTable + i] = std::byte{0xff};
        bytes[kPlaneTable + 3] = static_cast<std::byte>(mode << 6 | 0x3f);
        EXPECT_THAT(decodePage<std::uint16_t>(bytes, grid, page, "x"), HasError(ErrorCode::Corruption)) << int{mode};
    }
}

TEST(FormatLimits, OfChunks) {
    std::vector<std::byte> table;
    putChunkPlace(table, {64, std::numeric_limits<std::uint16_t>::max(), 7});
    ASSERT_EQ(table.size(), kGroupEntryBytes);
    for (const std::uint64_t past : {0, 1}) {
        ChunkPlace place;
        EXPECT_EQ(getChunkPlaces(table, 64, 64 + 65535 + past, std::span(&place, 1)), past == 0);
        EXPECT_EQ(place.bytes, 65535);
    }
    expectLimit("chunks of a group", [](IndexMeta& meta, auto past) {
        meta.info.kind = IndexKind::Metacells;
        meta.info.geometry.dims = {256 * kChunkSide + past, 1, 1};
        meta.chunkGroups = {{kPreambleBytes, 100, 1}};
    });
}

TEST(FormatLimits, OfPages) {
    const BrickGrid grid({64, 64, 64});
    for (const std::size_t points : {kMaxPagePoints, kMaxPagePoints + 1}) {
        // The header alone decides: its count is looked at before anything is sized.
        std::vector<PointRecord<std::uint16_t>> records(kMaxPagePoints);
        for (std::size_t i = 0; i < records.size(); ++i) {
            records[i].setId(PointId(i)); // bricks of 8^3 points, all but the last layer with an upward edge
            records[i].edgeMask = grid.pointCoords(PointId(i))[0] + 1 < 64 ? 2 : 1;
        }
        auto bytes = encodePage<std::uint16_t>(records, PageOrder::Value, FarEnds::Directions, grid);
        bytes[0] = static_cast<std::byte>(points);
        bytes[1] = static_cast<std::byte>(points >> 8);
        bytes[2] = static_cast<std::byte>(points >> 16);
        DecodedPage<std::uint16_t> page;
        const Status decoded = decodePage<std::uint16_t>(bytes, grid, page, "x");
        if (points == kMaxPagePoints)
            EXPECT_THAT(decoded, IsOk());
        else
            EXPECT_THAT(decoded, HasError(ErrorCode::Corruption));
    }
}

} // namespace
} // namespace isoslider::index
