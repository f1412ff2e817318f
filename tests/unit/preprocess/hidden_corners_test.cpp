// Which hidden corners a build lists: those of all cells that need one, and no others.

#include <bit>
#include <fstream>
#include <map>

#include <gtest/gtest.h>

#include "core/cell/trilinear_cell.h"
#include "core/grid/classification.h"
#include "core/grid/scalar_key.h"
#include "core/index/hidden_corners.h"
#include "preprocess/edges/hidden_corner_filter.h"
#include "preprocess/edges/hidden_page_builder.h"
#include "tests/property/random_volumes.h"
#include "tests/support/result_matchers.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_paths.h"

namespace isoslider::preprocess {
namespace {

using test::IsOk;

// By brick and place in it.
using Corners = std::map<std::pair<BrickIndex, std::uint32_t>, double>;

// Cell by cell, each asked in full.
Corners neededCorners(const ScalarGrid& grid) {
    Corners corners;
    const GridDims dims = grid.dims();
    const BrickGrid bricks(dims);
    for (std::int64_t z = 0; z + 1 < dims[2]; ++z)
        for (std::int64_t y = 0; y + 1 < dims[1]; ++y)
            for (std::int64_t x = 0; x + 1 < dims[0]; ++x) {
                cell::CornerScalars scalars;
                for (std::size_t c = 0; c < 8; ++c)
                    scalars[c] = grid.valueAt(x + static_cast<int>(c & 1), y + static_cast<int>(c >> 1 & 1),
                                              z + static_cast<int>(c >> 2));
                if (std::any_of(scalars.begin(), scalars.end(), [](double s) { return isMissing(s); }))
                    continue;
                const unsigned needed = cell::hiddenCornersNeeded(scalars);
                const PointId id = bricks.pointId(x, y, z);
                for (std::uint32_t c = 0; c < 8; ++c)
                    if (needed >> c & 1)
                        corners[{brickOf(id), std::uint32_t{localOf(id).number()} * 8 + c}] = scalars[c];
            }
    return corners;
}

Corners listedCorners(const index::IndexReader& reader) {
    Corners corners;
    std::uint64_t count = 0, bytes = 0;
    for (const index::HiddenPageEntry& entry : reader.meta().hiddenPages) {
        std::vector<std::byte> encoded;
        index::HiddenPage page;
        EXPECT_THAT(reader.readPage(entry, encoded), IsOk());
        EXPECT_THAT(index::decodeHiddenPage(encoded, entry, reader.info(), page, "p"), IsOk());
        for (std::size_t i = 0; i < page.places.size(); ++i)
            corners[{entry.firstBrick + page.places[i] / index::kHiddenPlacesPerBrick,
                     page.places[i] % index::kHiddenPlacesPerBrick}] = page.scalars[i];
        count += page.places.size();
        bytes += encoded.size();
    }
    EXPECT_EQ(count, corners.size());
    EXPECT_EQ(count, reader.info().hiddenCorners);
    EXPECT_EQ(bytes, reader.info().hiddenCornerBytes);
    return corners;
}

// Their number.
std::size_t expectThoseThatAreNeeded(const std::shared_ptr<const ScalarGrid>& grid) {
    const test::TemporaryFolder folder;
    EXPECT_THAT(test::buildIndexOf(grid, folder / "a.isx"), IsOk());
    const auto reader = index::IndexReader::open(folder / "a.isx");
    EXPECT_THAT(reader, IsOk());
    const Corners needed = neededCorners(*grid);
    EXPECT_TRUE(listedCorners(*reader.value()) == needed);
    const index::HiddenCorners hidden(*reader.value());
    for (const auto& [place, scalar] : needed) {
        const auto found =
            hidden.find(place.first, static_cast<LocalPoint>(place.second / 8), static_cast<int>(place.second % 8));
        EXPECT_THAT(found, IsOk());
        EXPECT_EQ(found.value(), scalar);
    }
    return needed.size();
}

TEST(HiddenCorners, AreThoseOfRandomVolumes) {
    std::size_t count = 0;
    for (std::uint64_t seed = test::testSeed(4100), last = seed + 200; seed < last && !testing::Test::HasFailure();
         ++seed) {
        test::Random random(seed);
        const test::RandomVolume volume = test::randomVolume(random, 20);
        SCOPED_TRACE("seed " + std::to_string(seed) + ": " + volume.description);
        if (volume.hasFinite)
            count += expectThoseThatAreNeeded(volume.grid);
    }
    EXPECT_GT(count, 1000u);
}

TEST(HiddenCorners, AreThoseOfNoiseOfEachType) {
    GridGeometry geometry;
    for (const GridDims& dims : {GridDims{2, 2, 2}, GridDims{9, 8, 10}, GridDims{17, 25, 11}, GridDims{33, 16, 18}}) {
        geometry.dims = dims;
        SCOPED_TRACE(std::to_string(dims[0]) + " x " + std::to_string(dims[1]) + " x " + std::to_string(dims[2]));
        for (const ScalarType type : kAllScalarTypes)
            visitScalarType(type, [&](auto sample) {
                using Sample = decltype(sample);
                SCOPED_TRACE(scalarTypeName(type));
                test::Random random(static_cast<std::uint64_t>(type));
                for (const bool isCoarse : {false, true}) {
                    const auto count =
                        expectThoseThatAreNeeded(test::makeVolume<Sample>(type, geometry, [&](auto, auto, auto) {
                            if (isCoarse)
                                return static_cast<Sample>(random() % 5);
                            if constexpr (std::is_floating_point_v<Sample>)
                                return static_cast<Sample>(test::unitRandom(random) * 2e3 - 1e3);
                            else
                                return static_cast<Sample>(random());
                        }));
                    EXPECT_TRUE(count > 10 || dims[0] == 2);
                }
            });
    }
}

TEST(HiddenCorners, AreNotThoseOfCellsWithAMissingCorner) {
    for (const int share : {1, 5, 20}) {
        test::Random random(static_cast<std::uint64_t>(share));
        std::size_t missing = 0;
        const auto grid = test::makeVolume<float>(ScalarType::F32, test::cubeGeometry(26), [&](auto, auto, auto) {
            const bool isHole = random() % 100 < static_cast<unsigned>(share);
            missing += isHole;
            return isHole ? std::numeric_limits<double>::quiet_NaN() : test::unitRandom(random);
        });
        EXPECT_GT(missing, 0u);
        EXPECT_GT(expectThoseThatAreNeeded(grid), 20u);
    }
}

TEST(HiddenCorners, FillManyPagesOfWholeBricks) {
    const auto grid = test::noiseVolume({70, 66, 61}, 3, 256);
    EXPECT_GT(expectThoseThatAreNeeded(grid), 3 * index::kMaxHiddenPageCorners);
    const test::TemporaryFolder folder;
    ASSERT_THAT(test::buildIndexOf(grid, folder / "a.isx"), IsOk());
    const auto reader = index::IndexReader::open(folder / "a.isx");
    ASSERT_THAT(reader, IsOk());
    const auto& pages = reader.value()->meta().hiddenPages;
    ASSERT_GE(pages.size(), 4u);
    for (std::size_t i = 0; i + 1 < pages.size(); ++i)
        EXPECT_GT(pages[i].corners, index::kMaxHiddenPageCorners * 9 / 10) << "room for more bricks";
}

TEST(HiddenCorners, SmoothVolumesHaveNone) {
    for (const auto& grid : {test::hillsVolume({40, 33, 21}), test::hillsVolume({24, 70, 30})}) {
        const test::TemporaryFolder folder;
        const auto built = test::buildIndexOf(grid, folder / "a.isx");
        ASSERT_THAT(built, IsOk());
        EXPECT_EQ(built.value().info.hiddenCorners, 0u);
        EXPECT_EQ(built.value().info.hiddenCornerBytes, 0u);
        EXPECT_TRUE(neededCorners(*grid).empty());
    }
}

// Bricks that no test could fill with samples, cut into pages and looked up.
class LargeGrid : public testing::Test {
protected:
    using Brick = std::pair<std::uint32_t, unsigned>; // and the number of its hidden corners

    void build(const GridDims& dims, std::initializer_list<Brick> bricks) {
        index::IndexMeta meta;
        meta.info.geometry.dims = dims;
        meta.info.type = ScalarType::I32;
        meta.info.min = -2147483648.0;
        meta.info.max = 2147483647.0;
        meta.info.levels.resize(1);
        auto writer = index::IndexWriter::create(folder_ / "a.isx", 1);
        ASSERT_THAT(writer, IsOk());
        HiddenPageBuilder builder(*writer.value(), ScalarType::I32);
        for (const auto& [brick, places] : bricks) {
            std::vector<index::HiddenCorner> corners;
            for (unsigned place = 0; place < places; ++place) {
                const auto sample = static_cast<std::int32_t>(brick * 31u + place);
                corners.push_back({BrickIndex(brick), static_cast<std::uint16_t>(place), keyOf(sample)});
                expected_[{BrickIndex(brick), place}] = sample;
            }
            ASSERT_THAT(builder.addBrick(corners), IsOk());
        }
        ASSERT_THAT(builder.finish(), IsOk());
        ASSERT_THAT(writer.value()->finish(std::move(meta)), IsOk());
        // As version 4, whose edges have no chunks.
        std::string file = test::readText(folder_ / "a.isx");
        auto preamble = index::decodePreamble(std::as_bytes(std::span(file)), file.size(), "a.isx").value();
        preamble.major = 4;
        const auto head = index::encodePreamble(preamble);
        std::copy_n(reinterpret_cast<const char*>(head.data()), head.size(), file.begin());
        std::ofstream(folder_ / "a.isx", std::ios::binary) << file;
        auto reader = index::IndexReader::open(folder_ / "a.isx");
        ASSERT_THAT(reader, IsOk());
        reader_ = std::move(reader).value();
    }
    // First brick, last brick and hidden corners of each page.
    std::vector<std::array<std::uint64_t, 3>> pages() const {
        std::vector<std::array<std::uint64_t, 3>> pages;
        for (const auto& page : reader_->meta().hiddenPages)
            pages.push_back({page.firstBrick.number(), page.lastBrick.number(), page.corners});
        return pages;
    }
    void expectAllFound() {
        EXPECT_TRUE(listedCorners(*reader_) == expected_);
        const index::HiddenCorners hidden(*reader_);
        for (const auto& [place, scalar] : expected_)
            ASSERT_EQ(
                hidden.find(place.first, static_cast<LocalPoint>(place.second / 8), static_cast<int>(place.second % 8))
                    .value(),
                scalar);
        EXPECT_EQ(hidden.find(expected_.rbegin()->first.first + 1, LocalPoint(), 0).value(), std::nullopt);
    }

    test::TemporaryFolder folder_;
    Corners expected_;
    std::unique_ptr<index::IndexReader> reader_;
};

using Pages = std::vector<std::array<std::uint64_t, 3>>;

TEST_F(LargeGrid, PagesTakeFullBricksAndEndBeforeTheyAreTooLong) {
    const std::uint32_t far = 6 + (1u << 20);
    build({kMaxDim, 8 * 90, 8 * 180}, {{0, 1},
                                       {1, 4096},
                                       {2, 4096},
                                       {3, 0},
                                       {4, 100},
                                       {5, 3996},
                                       {6, 1},
                                       {7, 3},
                                       {far - 1, 1},
                                       {far, 1},
                                       {2100000000, 4096}});
    EXPECT_EQ(pages(), (Pages{{0, 0, 1},
                              {1, 1, 4096},
                              {2, 2, 4096},
                              {4, 5, 4096},
                              {6, far - 1, 5},
                              {far, far, 1},
                              {2100000000, 2100000000, 4096}}));
    expectAllFound();
}

TEST_F(LargeGrid, BricksHaveAll32Bits) {
    const std::uint32_t last = 131072u * 32767u - 131072u - 2; // its upper neighbours exist
    build({kMaxDim, 8 * 32767, 2},
          {{0x7fffffff, 2}, {0x80000000, 512}, {0x80000000 + (1u << 20), 2}, {last - 1, 9}, {last, 512}});
    EXPECT_EQ(pages(), (Pages{{0x7fffffff, 0x80000000, 514},
                              {0x80000000 + (1u << 20), 0x80000000 + (1u << 20), 2},
                              {last - 1, last, 521}}));
    expectAllFound();
}

// Against all orders that eight corners can have, ties too, at each place in the row.
TEST(HiddenCornerFilter, NeverMissesACaseSeven) {
    test::Random random(test::testSeed(17));
    std::size_t passed = 0, cells = 0;
    for (int round = 0; round < 40000; ++round) {
        std::uint16_t rows[4][kFilterCells + 1];
        const std::uint64_t values = round % 3 == 0 ? 4 : round % 3 == 1 ? 9 : 65536;
        for (auto& row : rows)
            for (auto& key : row)
                key = static_cast<std::uint16_t>(random() % values - (round % 2 ? values / 2 : 0));
        const unsigned found = mayNeedHiddenCorners<std::uint16_t>({rows[0], rows[1], rows[2], rows[3]});
        for (int i = 0; i < kFilterCells; ++i) {
            // Three neighbours of a corner are all above, or all below, the five others.
            bool hasCaseSeven = false;
            const auto at = [&](int c) { return rows[c >> 1][i + (c & 1)]; };
            for (int centre = 0; centre < 8; ++centre) {
                int least = 65536, greatest = -1, leastOther = 65536, greatestOther = -1;
                for (int c = 0; c < 8; ++c) {
                    const bool isNeighbour = std::popcount(static_cast<unsigned>(c ^ centre)) == 1;
                    (isNeighbour ? least : leastOther) = std::min<int>(isNeighbour ? least : leastOther, at(c));
                    (isNeighbour ? greatest : greatestOther) =
                        std::max<int>(isNeighbour ? greatest : greatestOther, at(c));
                }
                hasCaseSeven = hasCaseSeven || least > greatestOther || greatest < leastOther;
            }
            ASSERT_TRUE(!hasCaseSeven || (found >> i & 1)) << "round " << round << ", cell " << i;
            passed += found >> i & 1;
            ++cells;
        }
        ASSERT_EQ(found >> kFilterCells, 0u);
    }
    EXPECT_LT(passed, cells / 3);
}

} // namespace
} // namespace isoslider::preprocess
