#include "core/index/index_distribution.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "core/grid/volume_statistics.h"
#include "tests/property/random_volumes.h"
#include "tests/property/surface_comparison.h"
#include "tests/support/result_matchers.h"
#include "tests/support/temporary_folder.h"

namespace isoslider::index {
namespace {

using test::IsOk;

class IndexDistribution : public testing::Test {
protected:
    std::unique_ptr<IndexReader> readerOf(const std::shared_ptr<const ScalarGrid>& grid,
                                          IndexKind kind = IndexKind::Metacells) {
        preprocess::BuildOptions options;
        options.kind = kind;
        EXPECT_THAT(test::buildIndexOf(grid, folder_ / "a.isx", options), IsOk());
        auto reader = IndexReader::open(folder_ / "a.isx");
        EXPECT_THAT(reader, IsOk());
        return std::move(reader).value();
    }

    test::TemporaryFolder folder_;
};

bool areSame(const ValueCell& a, const ValueCell& b) {
    return a.lower == b.lower && a.upper == b.upper && a.count == b.count;
}

TEST_F(IndexDistribution, OfAllSamplesIsThatOfTheVolume) {
    for (const auto& grid : {test::noiseVolume({50, 41, 33}, 6, 250), test::hillsVolume({50, 41, 30})}) {
        const auto reader = readerOf(grid);
        const auto found = distributionOf(*reader, 1'000'000);
        ASSERT_THAT(found, IsOk());
        const auto wanted = isoslider::distributionOf(*grid, reader->info().min, reader->info().max);
        ASSERT_THAT(wanted, IsOk());
        EXPECT_TRUE(found.value().isExact());
        EXPECT_TRUE(found.value().spread.isExact);
        EXPECT_EQ(found.value().spread.mean, wanted.value().spread.mean);
        EXPECT_EQ(found.value().spread.deviation, wanted.value().spread.deviation);
        const auto spread = spreadOf(*reader);
        ASSERT_THAT(spread, IsOk());
        EXPECT_EQ(spread.value().mean, isoslider::spreadOf(*grid).value().mean);
        EXPECT_EQ(spread.value().deviation, wanted.value().spread.deviation);
        EXPECT_EQ(found.value().body.counts, wanted.value().body.counts);
        EXPECT_EQ(found.value().body.min, wanted.value().body.min);
        EXPECT_EQ(found.value().body.max, wanted.value().body.max);
        const auto &a = found.value().cells, &b = wanted.value().cells;
        EXPECT_TRUE(std::equal(a.begin(), a.end(), b.begin(), b.end(), areSame));
    }
}

TEST_F(IndexDistribution, OfSomeSamplesStandsForAll) {
    const auto grid = test::hillsVolume({90, 80, 70});
    const auto reader = readerOf(grid);
    const auto found = distributionOf(*reader, 100'000);
    ASSERT_THAT(found, IsOk());
    EXPECT_LE(found.value().counted(), 130'000u);
    EXPECT_GE(found.value().counted(), 40'000u);
    EXPECT_FALSE(found.value().spread.isExact);
    const ValueSpread whole = isoslider::spreadOf(*grid).value();
    EXPECT_NEAR(found.value().spread.mean, whole.mean, 0.1 * whole.deviation);
    EXPECT_NEAR(found.value().spread.deviation, whole.deviation, 0.1 * whole.deviation);
    EXPECT_FALSE(found.value().isExact());
    EXPECT_NEAR(found.value().weight * static_cast<double>(found.value().counted()), 90.0 * 80.0 * 70.0, 1.0);
    EXPECT_EQ(found.value().max, reader->info().max) << "known, counted or not";
}

TEST_F(IndexDistribution, OfEdgesIsThatOfTheSamplesToo) {
    const auto grid = test::hillsVolume({20, 20, 20});
    const auto edges = distributionOf(*readerOf(grid, IndexKind::Edges), 1'000'000);
    ASSERT_THAT(edges, IsOk());
    const auto metacells = distributionOf(*readerOf(grid), 1'000'000);
    ASSERT_THAT(metacells, IsOk());
    EXPECT_EQ(edges.value().body.counts, metacells.value().body.counts);
    EXPECT_EQ(edges.value().counted(), 8000u);
}

TEST_F(IndexDistribution, StopsWhenAsked) {
    const auto reader = readerOf(test::hillsVolume({40, 40, 40}));
    std::stop_source stop;
    stop.request_stop();
    EXPECT_TRUE(distributionOf(*reader, 1'000'000, {stop.get_token(), {}}).isCancelled());
}

} // namespace
} // namespace isoslider::index
