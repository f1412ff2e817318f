#include "core/index/format/chunk_table.h"
#include "core/index/format/index_format.h"

#include <random>

#include <gtest/gtest.h>
#include <zstd.h>

#include "core/base/byte_codec.h"
#include "core/extract/slide_engine.h"
#include "core/index/index_reader.h"
#include "tests/property/test_volumes.h"
#include "tests/support/result_matchers.h"
#include "tests/support/temporary_folder.h"

namespace isoslider::index {
namespace {

using test::HasError;
using test::IsOk;

Preamble somePreamble() {
    Preamble preamble;
    preamble.metaOffset = 500;
    preamble.metaBytes = 300;
    preamble.metaChecksum = 0x0123456789abcdef;
    preamble.fileBytes = 800;
    preamble.seed = 42;
    return preamble;
}

TEST(Preamble, GivesBackWhatItTook) {
    const auto bytes = encodePreamble(somePreamble());
    ASSERT_EQ(bytes.size(), kPreambleBytes);
    EXPECT_TRUE(hasIndexMagic(bytes));
    const auto decoded = decodePreamble(bytes, 800, "p");
    ASSERT_THAT(decoded, IsOk());
    EXPECT_EQ(decoded.value().metaOffset, 500u);
    EXPECT_EQ(decoded.value().metaBytes, 300u);
    EXPECT_EQ(decoded.value().metaChecksum, 0x0123456789abcdefu);
    EXPECT_EQ(decoded.value().fileBytes, 800u);
    EXPECT_EQ(decoded.value().seed, 42u);
}

TEST(Preamble, RefusesEveryFlippedBit) {
    const auto bytes = encodePreamble(somePreamble());
    for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
        auto damaged = bytes;
        damaged[bit / 8] ^= std::byte(1 << (bit % 8));
        const bool isKnownVersion =
            bit / 8 == 12 && damaged[12] >= std::byte{4} && damaged[12] < std::byte{kFormatMajor};
        const ErrorCode expected = bit < 8 * 12                      ? ErrorCode::InvalidArgument
                                   : bit < 8 * 14 && !isKnownVersion ? ErrorCode::UnsupportedVersion
                                                                     : ErrorCode::Corruption;
        ASSERT_THAT(decodePreamble(damaged, 800, "p"), HasError(expected)) << "bit " << bit;
    }
}

TEST(Preamble, RefusesEveryTruncation) {
    const auto bytes = encodePreamble(somePreamble());
    for (std::size_t length = 0; length < bytes.size(); ++length) {
        const std::vector<std::byte> cut(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(length));
        ASSERT_THAT(decodePreamble(cut, 800, "p"),
                    HasError(length < 12 ? ErrorCode::InvalidArgument : ErrorCode::Corruption))
            << length;
    }
}

TEST(Preamble, RefusesAnotherVersionByName) {
    Preamble preamble = somePreamble();
    for (const std::uint16_t major : {1, 2, 3, 8}) {
        preamble.major = major;
        const auto decoded = decodePreamble(encodePreamble(preamble), 800, "a.isx");
        ASSERT_THAT(decoded, HasError(ErrorCode::UnsupportedVersion));
        EXPECT_NE(decoded.error().message.find("version " + std::to_string(major) + ","), std::string::npos);
        EXPECT_NE(decoded.error().message.find("build it again"), std::string::npos);
        EXPECT_EQ(decoded.error().message.find('\n'), std::string::npos);
        EXPECT_EQ(decoded.error().path, "a.isx");
    }
    for (const std::uint16_t major : {4, 5, 6, 7}) {
        preamble.major = major;
        EXPECT_THAT(decodePreamble(encodePreamble(preamble), 800, "p"), IsOk());
    }
    preamble.minor = 7; // states nothing that a reader must know
    EXPECT_THAT(decodePreamble(encodePreamble(preamble), 800, "p"), IsOk());
}

TEST(Preamble, RefusesPlacesOutsideTheFile) {
    const auto refuses = [](auto change) {
        Preamble preamble = somePreamble();
        change(preamble);
        EXPECT_THAT(decodePreamble(encodePreamble(preamble), 800, "p"), HasError(ErrorCode::Corruption));
    };
    refuses([](Preamble& p) { p.metaOffset = 63; });
    refuses([](Preamble& p) { p.metaOffset = 801; });
    refuses([](Preamble& p) { p.metaBytes = 301; });
    refuses([](Preamble& p) { p.metaBytes = ~std::uint64_t{0}; });
    refuses([](Preamble& p) { p.metaOffset = ~std::uint64_t{0}; });
    refuses([](Preamble& p) { p.fileBytes = 799; });
    refuses([](Preamble& p) { p.fileBytes = 801; });
}

IndexMeta someMeta() {
    IndexMeta meta;
    meta.info.geometry.dims = {20, 9, 8};
    meta.info.geometry.spacing = {0.5, 1.0, -2.0};
    meta.info.geometry.origin = {1.0, -2.0, 3.0};
    meta.info.geometry.direction[1] = {0.0, -1.0, 0.0};
    meta.info.type = ScalarType::F32;
    meta.info.min = -3.5;
    meta.info.max = 1e30;
    meta.info.distinctValues = 77;
    meta.info.nanCount = 5;
    meta.info.redundancyThreshold = 0.75;
    meta.info.sourceName = "head.mhd";
    meta.info.histogram = {-3.5, 1e30, {4, 5, 6}};
    meta.info.activeEdgesPerBin = {0, 10, 20};
    meta.info.levels = {{10, 11, 12, 6, 60, 0}, {1, 8, 9, 5, 40, 3}};
    meta.levels.resize(2);
    meta.levels[0].pages = {{1, 5, 64, 111, 30, 5, 6}, {5, 9, 94, 222, 30, 6, 6}};
    meta.levels[1].pages = {{1, 9, 124, 333, 40, 8, 9}};
    meta.levels[1].blocks = {{1, 4, 0, 1}, {5, 9, 1, 0}};
    meta.chunkGroups = {{254, 40, 666}};
    meta.info.chunkBytes = 40;
    meta.missingCells = {{BrickIndex(1), {1, 2, 3, 4, 5, 6, 7, 8}},
                         {BrickIndex(4), {0, 0, 0, 0, 0, 0, 0, ~std::uint64_t{0}}}};
    return meta;
}

TEST(IndexMeta, GivesBackWhatItTook) {
    const IndexMeta meta = someMeta();
    const auto decoded = decodeMeta(encodeMeta(meta), somePreamble(), "p");
    ASSERT_THAT(decoded, IsOk());
    const IndexMeta& back = decoded.value();
    EXPECT_EQ(back.info.geometry, meta.info.geometry);
    EXPECT_EQ(back.info.type, meta.info.type);
    EXPECT_EQ(back.info.min, meta.info.min);
    EXPECT_EQ(back.info.max, meta.info.max);
    EXPECT_EQ(back.info.distinctValues, 77u);
    EXPECT_EQ(back.info.nanCount, 5u);
    EXPECT_EQ(back.info.redundancyThreshold, 0.75);
    EXPECT_EQ(back.info.sourceName, "head.mhd");
    EXPECT_EQ(back.info.histogram.counts, meta.info.histogram.counts);
    EXPECT_EQ(back.info.activeEdgesPerBin, meta.info.activeEdgesPerBin);
    EXPECT_EQ(back.info.indexBytes, 800u);
    EXPECT_EQ(back.missingCells[1].cells[7], ~std::uint64_t{0});
    EXPECT_EQ(back.info.formatMajor, kFormatMajor);
    EXPECT_TRUE(hasSampleChunks(back.info));
    EXPECT_EQ(back.info.chunkBytes, 40u);
    ASSERT_EQ(back.chunkGroups.size(), 1u);
    EXPECT_EQ(back.chunkGroups[0].checksum, 666u);
    // Whatever is not looked at above: equal bytes again.
    EXPECT_EQ(encodeMeta(back), encodeMeta(meta));
}

TEST(IndexMeta, RefusesEveryTruncationAndTrailingBytes) {
    for (const char* unit : {"", "mm"}) {
        IndexMeta meta = someMeta();
        meta.info.lengthUnit = unit;
        meta.info.resampling = *unit == '\0' ? "" : "off by up to 3 % of the range";
        Preamble preamble = somePreamble();
        preamble.minor = minorOf(meta);
        auto bytes = encodeMeta(meta);
        for (std::size_t length = 0; length < bytes.size(); ++length) {
            const std::vector<std::byte> cut(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(length));
            ASSERT_THAT(decodeMeta(cut, preamble, "p"), HasError(ErrorCode::Corruption)) << length;
        }
        bytes.push_back(std::byte{0});
        EXPECT_THAT(decodeMeta(bytes, preamble, "p"), HasError(ErrorCode::Corruption));
        preamble.minor = kFormatMinor + 1;
        if (*unit != '\0') { // or else the byte is no unit
            EXPECT_THAT(decodeMeta(bytes, preamble, "p"), IsOk());
        }
    }
}

TEST(IndexMeta, HasAUnitOfLengthFromMinorVersion1On) {
    IndexMeta meta = someMeta();
    EXPECT_EQ(minorOf(meta), 0);
    const auto without = encodeMeta(meta);
    meta.info.lengthUnit = "µm";
    EXPECT_EQ(minorOf(meta), 1);
    const auto with = encodeMeta(meta);
    EXPECT_TRUE(std::equal(without.begin(), without.end(), with.begin())) << "what an earlier reader knows";
    Preamble preamble = somePreamble();
    EXPECT_EQ(decodeMeta(without, preamble, "p").value().info.lengthUnit, "");
    preamble.minor = 1;
    const auto decoded = decodeMeta(with, preamble, "p");
    ASSERT_THAT(decoded, IsOk());
    EXPECT_EQ(decoded.value().info.lengthUnit, "µm");
    for (const char* bad : {"m\nm", "\xff", "seventeen_letters"}) {
        meta.info.lengthUnit = bad;
        EXPECT_THAT(decodeMeta(encodeMeta(meta), preamble, "p"), HasError(ErrorCode::Corruption)) << bad;
    }
}

TEST(IndexMeta, HasWhatResamplingLostFromMinorVersion2On) {
    IndexMeta meta = someMeta();
    meta.info.lengthUnit = "mm";
    const auto without = encodeMeta(meta);
    meta.info.resampling = "onto 4 x 4 x 4 points, off by up to 26 % of the range";
    EXPECT_EQ(minorOf(meta), 2);
    const auto with = encodeMeta(meta);
    EXPECT_TRUE(std::equal(without.begin(), without.end(), with.begin())) << "what an earlier reader knows";
    Preamble preamble = somePreamble();
    preamble.minor = 1;
    EXPECT_EQ(decodeMeta(without, preamble, "p").value().info.resampling, "");
    preamble.minor = 2;
    const auto decoded = decodeMeta(with, preamble, "p");
    ASSERT_THAT(decoded, IsOk());
    EXPECT_EQ(decoded.value().info.resampling, meta.info.resampling);
    for (std::size_t length = without.size(); length < with.size(); ++length)
        EXPECT_THAT(decodeMeta(std::span(with).first(length), preamble, "p"), HasError(ErrorCode::Corruption))
            << length;
    auto bad = with;
    bad.back() = std::byte{'\n'};
    EXPECT_THAT(decodeMeta(bad, preamble, "p"), HasError(ErrorCode::Corruption)) << "control characters";
}

TEST(IndexMeta, StatesPlacesOfAPatientFromMinorVersion3On) {
    IndexMeta meta = someMeta();
    meta.info.lengthUnit = "mm";
    meta.info.resampling = "onto 4 x 4 x 4 points";
    const auto without = encodeMeta(meta);
    meta.info.isPatientSpace = true;
    EXPECT_EQ(minorOf(meta), 3);
    auto with = encodeMeta(meta);
    EXPECT_TRUE(std::equal(without.begin(), without.end(), with.begin())) << "what an earlier reader knows";
    Preamble preamble = somePreamble();
    preamble.minor = 2;
    EXPECT_FALSE(decodeMeta(without, preamble, "p").value().info.isPatientSpace);
    preamble.minor = 3;
    const auto decoded = decodeMeta(with, preamble, "p");
    ASSERT_THAT(decoded, IsOk());
    EXPECT_TRUE(decoded.value().info.isPatientSpace);
    EXPECT_EQ(decoded.value().info.lengthUnit, "mm");
    EXPECT_THAT(decodeMeta(without, preamble, "p"), HasError(ErrorCode::Corruption)) << "cut off";
    with.back() = std::byte{0};
    EXPECT_FALSE(decodeMeta(with, preamble, "p").value().info.isPatientSpace);
    with.back() = std::byte{2};
    EXPECT_THAT(decodeMeta(with, preamble, "p"), HasError(ErrorCode::Corruption));
    meta.info.lengthUnit.clear();
    meta.info.resampling.clear();
    const auto alone = decodeMeta(encodeMeta(meta), preamble, "p");
    ASSERT_THAT(alone, IsOk());
    EXPECT_TRUE(alone.value().info.isPatientSpace);
}

TEST(IndexMeta, RefusesFieldsThatCannotBe) {
    const auto refuses = [](const char* what, auto change) {
        IndexMeta meta = someMeta();
        change(meta);
        EXPECT_THAT(decodeMeta(encodeMeta(meta), somePreamble(), "p"), HasError(ErrorCode::Corruption)) << what;
    };
    constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
    refuses("scalar type", [](IndexMeta& m) { m.info.type = static_cast<ScalarType>(7); });
    refuses("no grid points", [](IndexMeta& m) { m.info.geometry.dims[1] = 0; });
    refuses("negative extent", [](IndexMeta& m) { m.info.geometry.dims[2] = -8; });
    refuses("extent too large", [](IndexMeta& m) { m.info.geometry.dims[0] = kMaxDim + 1; });
    refuses("too many grid points", [](IndexMeta& m) { m.info.geometry.dims = {kMaxDim, kMaxDim, 2}; });
    refuses("spacing 0", [](IndexMeta& m) { m.info.geometry.spacing[0] = 0.0; });
    refuses("spacing not a number", [&](IndexMeta& m) { m.info.geometry.spacing[2] = kNan; });
    refuses("range upside down", [](IndexMeta& m) { m.info.min = 2e30; });
    refuses("range not a number", [&](IndexMeta& m) { m.info.max = kNan; });
    refuses("name too long", [](IndexMeta& m) { m.info.sourceName.assign(5000, 'x'); });
    refuses("page before the pages", [](IndexMeta& m) { m.levels[0].pages[0].offset = 63; });
    refuses("page runs into meta", [](IndexMeta& m) { m.levels[0].pages[1].bytes = 500 - 94 + 1; });
    refuses("page behind the file", [](IndexMeta& m) { m.levels[1].pages[0].offset = ~std::uint64_t{0}; });
    refuses("keys of a page out of order", [](IndexMeta& m) { m.levels[0].pages[0].firstKey = 6; });
    refuses("keys of a block out of order", [](IndexMeta& m) { m.levels[1].blocks[0].firstKey = 5; });
    refuses("blocks overlap", [](IndexMeta& m) { m.levels[1].blocks[1].firstKey = 4; });
    refuses("pages left out", [](IndexMeta& m) { m.levels[1].blocks[0].firstPage = 1; });
    refuses("more pages than there are", [](IndexMeta& m) { m.levels[1].blocks[1].pageCount = 1; });
    refuses("a brick outside the grid", [](IndexMeta& m) { m.missingCells[1].brick = BrickIndex(6); });
    refuses("bricks out of order", [](IndexMeta& m) { m.missingCells[0].brick = BrickIndex(4); });
    refuses("no level", [](IndexMeta& m) {
        m.levels.clear();
        m.info.levels.clear();
    });
    refuses("nine levels", [](IndexMeta& m) {
        m.levels.resize(9);
        m.info.levels.resize(9);
    });
}

TEST(IndexMeta, SurvivesEveryFlippedBit) {
    auto bytes = encodeMeta(someMeta());
    std::size_t refused = 0;
    for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
        bytes[bit / 8] ^= std::byte(1 << (bit % 8));
        refused += !decodeMeta(bytes, somePreamble(), "p").isOk();
        bytes[bit / 8] ^= std::byte(1 << (bit % 8));
    }
    EXPECT_GT(refused, bytes.size());
}

// "Sizes are compared with what is really there before they size anything."
TEST(IndexMeta, RefusesMissingCellsThatWouldNotFitIntoMemory) {
    IndexMeta meta = someMeta();
    meta.info.geometry.dims = {kMaxDim, kMaxDim, 1};
    meta.missingCells.clear();
    auto bytes = encodeMeta(meta);
    // The number of bricks stands before the packed bytes of none: 8 bytes of length, then the frame.
    const std::size_t frame = ZSTD_compressBound(0) >= 9 ? 9 : 0;
    storeLittle<std::uint64_t>(bytes.data() + bytes.size() - frame - 16, std::uint64_t{1} << 33);
    EXPECT_NO_THROW(EXPECT_THAT(decodeMeta(bytes, somePreamble(), "p"), HasError(ErrorCode::Corruption)));
}

TEST(PageChecksum, DependsOnBytesSeedAndPlace) {
    const std::vector<std::byte> a(100, std::byte{1});
    auto b = a;
    b[99] = std::byte{2};
    EXPECT_NE(pageChecksum(a, 1, 64), pageChecksum(b, 1, 64));
    EXPECT_NE(pageChecksum(a, 1, 64), pageChecksum(a, 2, 64));
    EXPECT_NE(pageChecksum(a, 1, 64), pageChecksum(a, 1, 164));
    EXPECT_EQ(pageChecksum(a, 1, 64), pageChecksum(std::vector<std::byte>(a), 1, 64));
}

} // namespace
} // namespace isoslider::index
