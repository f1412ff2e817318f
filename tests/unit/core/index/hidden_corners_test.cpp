// Hidden corners: the page codec, and looking them up in an index.

#include "core/index/hidden_corners.h"

#include <cmath>
#include <map>
#include <random>
#include <thread>

#include <gtest/gtest.h>

#include "core/base/byte_codec.h"
#include "core/grid/scalar_key.h"
#include "core/index/index_writer.h"
#include "tests/support/index_chunks.h"
#include "tests/support/result_matchers.h"
#include "tests/support/temporary_folder.h"

namespace isoslider::index {
namespace {

using test::HasError;
using test::IsOk;

IndexInfo infoOf(ScalarType type, const GridDims& dims) {
    IndexInfo info;
    info.type = type;
    info.geometry.dims = dims;
    info.min =
        visitScalarType(type, [](auto s) { return static_cast<double>(std::numeric_limits<decltype(s)>::lowest()); });
    info.max =
        visitScalarType(type, [](auto s) { return static_cast<double>(std::numeric_limits<decltype(s)>::max()); });
    return info;
}

// Some cells of bricks [first, first + bricks), of a grid of whole bricks: those at the box's end do not exist.
template <class Sample, class Random>
std::vector<HiddenCorner> someCorners(Random& random, std::uint32_t first, std::uint32_t bricks, unsigned oneIn) {
    std::vector<HiddenCorner> corners;
    for (std::uint32_t brick = first; brick < first + bricks; ++brick)
        for (std::uint16_t cell = 0; cell < kBrickPoints; ++cell)
            for (std::uint16_t corner = 0; corner < 8; ++corner) {
                const bool exists = (cell & 7) < 7 && (cell >> 3 & 7) < 7 && (cell >> 6) < 7;
                const bool isEnd = brick == first || brick + 1 == first + bricks;
                if (!exists || (random() % oneIn != 0 && !(isEnd && cell == 0 && corner == 0)))
                    continue;
                Sample sample;
                if constexpr (std::is_floating_point_v<Sample>)
                    sample = static_cast<Sample>(
                        std::ldexp(static_cast<double>(random()) - 2e9, static_cast<int>(random() % 60) - 30));
                else
                    sample = static_cast<Sample>(random());
                corners.push_back({BrickIndex(brick), static_cast<std::uint16_t>(8 * cell + corner), keyOf(sample)});
            }
    return corners;
}

template <class Sample>
void expectRoundTrip(ScalarType type) {
    std::mt19937 random(static_cast<unsigned>(type) + 1);
    const GridDims dims = {8 * 4096, 8 * 1024, 8 * 1023}; // bricks up to 2^32 - 2^22
    const BrickGrid grid(dims);
    const IndexInfo info = infoOf(type, dims);
    const auto lastBrick = static_cast<std::uint32_t>(grid.brickCount() - 1);
    for (const auto& [first, bricks, oneIn] : {std::array<std::uint32_t, 3>{0, 1, 5000},
                                               {7, 3, 5000},
                                               {lastBrick, 1, 5000},
                                               {lastBrick - 9, 10, 20},
                                               {1000, 30, 400},
                                               {5, 1, 1}}) {
        const auto corners = someCorners<Sample>(random, first, bricks, oneIn);
        ASSERT_LE(corners.size(), kMaxHiddenPageCorners);
        const auto bytes = encodeHiddenPage(corners, type);
        EXPECT_LE(bytes.size(), kMaxHiddenPageBytes);
        EXPECT_EQ(bytes, encodeHiddenPage(corners, type));
        const HiddenPageEntry entry = hiddenPageEntry(corners);
        EXPECT_EQ(entry.firstBrick.number(), first);
        EXPECT_EQ(entry.lastBrick.number(), first + bricks - 1);
        HiddenPage page;
        ASSERT_THAT(decodeHiddenPage(bytes, entry, info, page, "p"), IsOk());
        ASSERT_EQ(page.places.size(), corners.size());
        ASSERT_EQ(page.scalars.size(), corners.size());
        for (std::size_t i = 0; i < corners.size(); ++i) {
            ASSERT_EQ(page.places[i], kHiddenPlacesPerBrick * (corners[i].brick.number() - first) + corners[i].place);
            ASSERT_EQ(page.scalars[i],
                      static_cast<double>(sampleOfKey<Sample>(static_cast<KeyOf<Sample>>(corners[i].key))));
        }
    }
}

TEST(HiddenPage, GivesBackWhatItTook) {
    expectRoundTrip<std::uint8_t>(ScalarType::U8);
    expectRoundTrip<std::int8_t>(ScalarType::I8);
    expectRoundTrip<std::uint16_t>(ScalarType::U16);
    expectRoundTrip<std::int16_t>(ScalarType::I16);
    expectRoundTrip<std::int32_t>(ScalarType::I32);
    expectRoundTrip<float>(ScalarType::F32);
    expectRoundTrip<double>(ScalarType::F64);
}

TEST(HiddenPage, SpansAsManyBricksAsPlacesAllow) {
    const GridDims dims = {8 * 4096, 8 * 1024, 16};
    const std::vector<HiddenCorner> corners = {{BrickIndex(3), 7, keyOf(-1.5f)},
                                               {BrickIndex(2 + kMaxHiddenPageBricks), 2919, keyOf(2.5f)}};
    HiddenPage page;
    ASSERT_THAT(decodeHiddenPage(encodeHiddenPage(corners, ScalarType::F32), hiddenPageEntry(corners),
                                 infoOf(ScalarType::F32, dims), page, "p"),
                IsOk());
    EXPECT_EQ(page.places, (std::vector<std::uint32_t>{7, (kMaxHiddenPageBricks - 1) * kHiddenPlacesPerBrick + 2919}));
    EXPECT_EQ(page.scalars, (std::vector<double>{-1.5, 2.5}));
}

class HiddenPageDamage : public testing::Test {
protected:
    static constexpr ScalarType kType = ScalarType::F32;

    Status decode(std::span<const std::byte> bytes) { return decode(bytes, entry_); }
    Status decode(std::span<const std::byte> bytes, const HiddenPageEntry& entry) {
        HiddenPage page;
        return decodeHiddenPage(bytes, entry, info_, page, "a.isx");
    }
    // Encoded well, but not what a volume of this kind can have.
    void refuses(const char* what, std::vector<HiddenCorner> corners) {
        HiddenPageEntry entry = hiddenPageEntry(corners);
        entry.offset = 777;
        const auto decoded = decode(encodeHiddenPage(corners, kType), entry);
        ASSERT_THAT(decoded, HasError(ErrorCode::Corruption)) << what;
        EXPECT_EQ(decoded.error().path, "a.isx");
        EXPECT_EQ(decoded.error().offset, 777u);
    }

    std::mt19937 random_{3};
    IndexInfo info_ = infoOf(kType, {40, 16, 9});
    std::vector<HiddenCorner> corners_ = someCorners<float>(random_, 2, 3, 200);
    std::vector<std::byte> bytes_ = encodeHiddenPage(corners_, kType);
    HiddenPageEntry entry_ = hiddenPageEntry(corners_);
};

TEST_F(HiddenPageDamage, EveryTruncationIsRefused) {
    ASSERT_THAT(decode(bytes_), IsOk());
    for (std::size_t length = 0; length < bytes_.size(); ++length)
        ASSERT_THAT(decode(std::span(bytes_).first(length)), HasError(ErrorCode::Corruption)) << length;
    auto longer = bytes_;
    longer.push_back(std::byte{0});
    EXPECT_THAT(decode(longer), HasError(ErrorCode::Corruption));
}

// As the checksum is not looked at here, a flipped sample may pass; nothing else happens.
TEST_F(HiddenPageDamage, EveryFlippedBitIsHarmless) {
    std::size_t refused = 0;
    for (std::size_t bit = 0; bit < 8 * bytes_.size(); ++bit) {
        bytes_[bit / 8] ^= std::byte(1 << (bit % 8));
        const auto decoded = decode(bytes_);
        if (!decoded.isOk()) {
            ++refused;
            ASSERT_EQ(decoded.error().code, ErrorCode::Corruption);
        }
        ASSERT_TRUE(!decoded.isOk() || bit >= 8 * 16) << "header bit " << bit;
        bytes_[bit / 8] ^= std::byte(1 << (bit % 8));
    }
    EXPECT_GT(refused, bytes_.size());
}

TEST_F(HiddenPageDamage, WhatTheDirectorySaysMustBeSo) {
    for (const auto change : std::initializer_list<void (*)(HiddenPageEntry&)>{
             [](HiddenPageEntry& e) { ++e.corners; }, [](HiddenPageEntry& e) { --e.corners; },
             [](HiddenPageEntry& e) { ++e.firstBrick; }, [](HiddenPageEntry& e) { --e.firstBrick; },
             [](HiddenPageEntry& e) { ++e.lastBrick; }, [](HiddenPageEntry& e) { --e.lastBrick; },
             [](HiddenPageEntry& e) { e.firstBrick = BrickIndex(9), e.lastBrick = BrickIndex(2); }}) {
        HiddenPageEntry entry = entry_;
        change(entry);
        EXPECT_THAT(decode(bytes_, entry), HasError(ErrorCode::Corruption));
    }
    info_.type = ScalarType::F64;
    EXPECT_THAT(decode(bytes_), HasError(ErrorCode::Corruption)) << "another type has other keys";
}

TEST_F(HiddenPageDamage, PlacesMustRiseAndNameCells) {
    const std::uint64_t one = keyOf(1.0f);
    refuses("the same corner twice", {{BrickIndex(2), 9, one}, {BrickIndex(2), 9, one}});
    refuses("a cell that would stick out of the grid along y", {{BrickIndex(7), 8 * (7 << 3), one}});
    refuses("a cell in the last plane along z", {{BrickIndex(12), 8, one}});
    refuses("a brick outside the grid", {{BrickIndex(20), 8, one}});
    EXPECT_THAT(
        decode(encodeHiddenPage(std::vector<HiddenCorner>{{BrickIndex(2), 9, one}, {BrickIndex(2), 10, one}}, kType),
               {BrickIndex(2), BrickIndex(2), 2, 0, 0, 0}),
        IsOk());
}

TEST_F(HiddenPageDamage, ScalarsMustBeSamplesOfTheVolume) {
    refuses("not a number", {{BrickIndex(2), 9, 0xffffffff}});
    refuses("infinite", {{BrickIndex(2), 9, keyOf(std::numeric_limits<float>::infinity())}});
    refuses("another way to write 0", {{BrickIndex(2), 9, 0x7fffffff}});
    info_.min = -1.0;
    info_.max = 4.0;
    refuses("above the range", {{BrickIndex(2), 9, keyOf(std::nextafter(4.0f, 5.0f))}});
    refuses("below the range", {{BrickIndex(2), 9, keyOf(std::nextafter(-1.0f, -5.0f))}});
    const std::vector<HiddenCorner> corners = {{BrickIndex(2), 9, keyOf(4.0f)}, {BrickIndex(2), 10, keyOf(-1.0f)}};
    EXPECT_THAT(decode(encodeHiddenPage(corners, kType), {BrickIndex(2), BrickIndex(2), 2, 0, 0, 0}), IsOk());
    info_ = infoOf(ScalarType::U8, {40, 16, 9});
    const std::vector<HiddenCorner> wide = {{BrickIndex(2), 9, 256}};
    HiddenPage page;
    EXPECT_THAT(decodeHiddenPage(encodeHiddenPage(wide, ScalarType::U8), hiddenPageEntry(wide), info_, page, "p"),
                HasError(ErrorCode::Corruption));
}

// An index with nothing but pages of hidden corners.
class HiddenCornersFile : public testing::Test {
protected:
    void SetUp() override {
        std::mt19937 random(5);
        for (const auto& [first, bricks] : {std::pair<std::uint32_t, std::uint32_t>{3, 4}, {7, 1}, {20, 100}})
            pages_.push_back(someCorners<float>(random, first, bricks, 1500));
        auto writer = IndexWriter::create(path_, 42);
        ASSERT_THAT(writer, IsOk());
        for (const auto& page : pages_)
            ASSERT_THAT(writer.value()->addHiddenPage(hiddenPageEntry(page), encodeHiddenPage(page, ScalarType::F32)),
                        IsOk());
        IndexMeta meta;
        meta.info = infoOf(ScalarType::F32, {8 * 7, 8 * 7, 8 * 7});
        meta.info.levels.resize(1);
        ASSERT_THAT(test::addBlankNormals(meta.info.geometry.dims, *writer.value()), IsOk());
        auto info = writer.value()->finish(std::move(meta));
        ASSERT_THAT(info, IsOk());
        EXPECT_EQ(info.value().hiddenCorners, pages_[0].size() + pages_[1].size() + pages_[2].size());
        open();
    }
    void open() {
        auto reader = IndexReader::open(path_);
        ASSERT_THAT(reader, IsOk());
        reader_ = std::move(reader).value();
    }
    void flipByteAt(std::uint64_t offset) {
        std::string bytes = test::readText(path_);
        bytes[offset] ^= 0x10;
        folder_.write("a.isx", bytes);
        open();
    }
    static double scalarOf(const HiddenCorner& corner) {
        return sampleOfKey<float>(static_cast<std::uint32_t>(corner.key));
    }

    test::TemporaryFolder folder_;
    std::filesystem::path path_ = folder_ / "a.isx";
    std::vector<std::vector<HiddenCorner>> pages_;
    std::unique_ptr<IndexReader> reader_;
};

TEST_F(HiddenCornersFile, FindsWhatIsThereAndNothingElse) {
    const HiddenCorners hidden(*reader_);
    std::map<std::pair<BrickIndex, std::uint16_t>, double> expected;
    for (const auto& page : pages_)
        for (const HiddenCorner& corner : page)
            expected[{corner.brick, corner.place}] = scalarOf(corner);
    for (const BrickIndex brick : firstIds<BrickIndex>(reader_->grid().brickCount() + 2))
        for (std::uint16_t place = 0; place < kHiddenPlacesPerBrick; ++place) {
            const auto found = hidden.find(brick, static_cast<LocalPoint>(place / 8), place % 8);
            ASSERT_THAT(found, IsOk());
            const auto at = expected.find({brick, place});
            ASSERT_EQ(found.value().has_value(), at != expected.end()) << brick.number() << " " << place;
            if (found.value()) {
                ASSERT_EQ(*found.value(), at->second);
            }
        }
}

TEST_F(HiddenCornersFile, ReadsOnlyPagesThatAreAskedForAndEachOnce) {
    const HiddenCorners hidden(*reader_);
    const auto& entries = reader_->meta().hiddenPages;
    const std::uint64_t nothing = hidden.memoryBytes();
    for (const std::uint32_t brick : {0u, 2u, 8u, 19u, 120u, 342u, ~0u})
        ASSERT_EQ(hidden.find(BrickIndex(brick), LocalPoint(), 0).value(), std::nullopt);
    EXPECT_EQ(hidden.bytesRead(), 0u);
    EXPECT_EQ(hidden.memoryBytes(), nothing);
    for (int round = 0; round < 2; ++round) {
        ASSERT_THAT(hidden.find(BrickIndex(7), LocalPoint(), 0), IsOk());
        EXPECT_EQ(hidden.bytesRead(), entries[1].bytes);
    }
    ASSERT_THAT(hidden.find(BrickIndex(20), LocalPoint(), 0), IsOk());
    ASSERT_THAT(hidden.find(BrickIndex(119), LocalPoint(), 0), IsOk());
    EXPECT_EQ(hidden.bytesRead(), entries[1].bytes + entries[2].bytes);
    EXPECT_GT(hidden.memoryBytes(), nothing);
}

TEST_F(HiddenCornersFile, DamageIsReportedWithItsPlace) {
    for (const HiddenPageEntry& entry : std::vector<HiddenPageEntry>(reader_->meta().hiddenPages))
        for (const std::uint64_t at : {entry.offset, entry.offset + entry.bytes / 2, entry.offset + entry.bytes - 1}) {
            flipByteAt(at);
            const HiddenCorners hidden(*reader_);
            for (int round = 0; round < 2; ++round) {
                const auto found = hidden.find(entry.firstBrick, LocalPoint(), 0);
                ASSERT_THAT(found, HasError(ErrorCode::Corruption));
                EXPECT_EQ(found.error().path, path_.string());
                EXPECT_EQ(found.error().offset, entry.offset);
            }
            for (const HiddenPageEntry& other : reader_->meta().hiddenPages)
                EXPECT_EQ(hidden.find(other.firstBrick, LocalPoint(), 0).isOk(), other.offset != entry.offset);
            flipByteAt(at);
        }
}

TEST_F(HiddenCornersFile, ManyThreadsFindTheSame) {
    for (int round = 0; round < 20; ++round) {
        const HiddenCorners hidden(*reader_);
        std::atomic<int> wrong = 0;
        std::vector<std::jthread> threads;
        for (int t = 0; t < 4; ++t)
            threads.emplace_back([&] {
                for (const auto& page : pages_)
                    for (const HiddenCorner& corner : page) {
                        const auto found =
                            hidden.find(corner.brick, static_cast<LocalPoint>(corner.place / 8), corner.place % 8);
                        wrong += !found.isOk() || found.value() != scalarOf(corner);
                    }
            });
        threads.clear();
        ASSERT_EQ(wrong, 0);
    }
}

} // namespace
} // namespace isoslider::index
