#include "core/index/sample_blocks.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "tests/property/surface_comparison.h"
#include "tests/property/test_volumes.h"
#include "tests/support/result_matchers.h"
#include "tests/support/temporary_folder.h"

namespace isoslider::index {
namespace {

using test::HasError;
using test::IsOk;

class SampleBlocksTest : public testing::Test {
protected:
    std::filesystem::path build(const std::shared_ptr<const ScalarGrid>& grid, IndexKind kind) {
        preprocess::BuildOptions options;
        options.kind = kind;
        EXPECT_THAT(test::buildIndexOf(grid, folder_ / "volume.isx", options), IsOk());
        return folder_ / "volume.isx";
    }
    test::TemporaryFolder folder_;
};

/// Outside the grid, too, and more than once: from the last to the first, so that each block is left and come back to.
void expectSamplesOf(const ScalarGrid& grid, SampleBlocks& blocks) {
    const GridDims& dims = grid.dims();
    ASSERT_EQ(blocks.dims(), dims);
    for (std::int64_t z = dims[2]; z >= -1; --z)
        for (std::int64_t y = dims[1]; y >= -1; --y)
            for (std::int64_t x = dims[0]; x >= -1; --x) {
                const bool isInside = x >= 0 && y >= 0 && z >= 0 && x < dims[0] && y < dims[1] && z < dims[2];
                const double expected = isInside ? grid.valueAt(x, y, z) : std::numeric_limits<double>::quiet_NaN();
                const double found = blocks.at(x, y, z);
                ASSERT_TRUE(std::isfinite(expected) ? found == expected : std::isnan(found))
                    << x << ' ' << y << ' ' << z << ": " << found << " for " << expected;
            }
    EXPECT_THAT(blocks.status(), IsOk());
}

TEST_F(SampleBlocksTest, AreTheSamplesOfTheVolumeInMemoryAndInAnIndex) {
    GridGeometry geometry;
    geometry.dims = {41, 17, 33};
    const auto grid = test::makeVolume<float>(ScalarType::F32, geometry, [](auto x, auto y, auto z) {
        return x == 20 && y == 15   ? std::numeric_limits<float>::infinity()
               : x == 40 && z == 32 ? std::numeric_limits<float>::quiet_NaN()
                                    : static_cast<float>(x) + 0.25f * static_cast<float>(y * z);
    });
    expectSamplesOf(*grid, *makeSampleBlocks(grid));
    const auto opened = openSampleBlocks(build(grid, IndexKind::Metacells));
    ASSERT_THAT(opened, IsOk());
    expectSamplesOf(*grid, *opened.value());
}

TEST_F(SampleBlocksTest, ComeBackAfterMoreThanThereIsRoomFor) {
    GridGeometry geometry;
    geometry.dims = {1 + 16 * 70, 16, 16 * 70}; // 71 * 1 * 70 blocks of one sample or more
    const auto grid = test::makeVolume<std::uint8_t>(
        ScalarType::U8, geometry, [](auto x, auto y, auto z) { return (x * 7 + y * 3 + z * 5) & 255; });
    const auto blocks = makeSampleBlocks(grid);
    for (int round = 0; round < 2; ++round)
        for (std::int64_t z = 3; z < geometry.dims[2]; z += 16)
            for (std::int64_t x = 0; x < geometry.dims[0]; x += 16)
                ASSERT_EQ(blocks->at(x, 5, z), grid->valueAt(x, 5, z)) << x << ' ' << z;
}

TEST_F(SampleBlocksTest, OfAnIndexOfEdgesAreThoseOfTheVolumeToo) {
    const auto grid = test::hillsVolume({12, 12, 12});
    const auto opened = openSampleBlocks(build(grid, IndexKind::Edges));
    ASSERT_THAT(opened, IsOk());
    for (std::int64_t i = 0; i < 12; ++i)
        ASSERT_EQ(opened.value()->at(i, 11 - i, 5), grid->valueAt(i, 11 - i, 5));
    EXPECT_THAT(openSampleBlocks(folder_ / "none.isx"), HasError(ErrorCode::NotFound));
}

TEST_F(SampleBlocksTest, ReportDamageAndGiveNothingMore) {
    const auto path = build(test::hillsVolume({40, 40, 40}), IndexKind::Metacells);
    const auto blocks = openSampleBlocks(path);
    ASSERT_THAT(blocks, IsOk());
    EXPECT_FALSE(std::isnan(blocks.value()->at(1, 1, 1)));
    std::filesystem::resize_file(path, 100);
    EXPECT_TRUE(std::isnan(blocks.value()->at(39, 39, 39)));
    EXPECT_FALSE(blocks.value()->status().isOk());
    EXPECT_TRUE(std::isnan(blocks.value()->at(20, 20, 20)));
}

} // namespace
} // namespace isoslider::index
