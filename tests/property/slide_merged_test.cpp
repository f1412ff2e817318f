// Sliding with merged cells is extracting with them: at every isovalue, from wherever, and after the bound was changed.

#include <cmath>

#include <gtest/gtest.h>

#include "core/extract/merged/merged_extraction.h"
#include "tests/property/random_volumes.h"
#include "tests/property/slide_ways.h"
#include "tests/property/surface_comparison.h"
#include "tests/property/test_volumes.h"
#include "tests/support/result_matchers.h"
#include "tests/support/temporary_folder.h"

namespace isoslider::extract {
namespace {

using test::IsOk;
using Measure = MergeBound::Measure;

const MergeBound kBounds[] = {{},
                              {Measure::Scalar, 0.5},
                              {Measure::Scalar, 3.0},
                              {Measure::Scalar, 1e9},
                              {Measure::Distance, 0.1},
                              {Measure::Distance, 0.5},
                              {Measure::Distance, 1e9}};

std::vector<test::Way> mergingWays(const std::shared_ptr<const ScalarGrid>& grid, const std::filesystem::path& folder) {
    std::vector<test::Way> ways = test::allWays(grid, folder);
    std::erase_if(ways, [](const test::Way& way) { return way.name == "edges"; });
    return ways;
}

struct Merges {
    std::uint64_t leaves = 0, levels = 0;
};

void expectMerged(std::vector<test::Way>& ways, const ScalarGrid& grid, double isovalue, const MergeBound& bound,
                  Merges& seen) {
    LeafCounts leaves{};
    const auto fresh = extractMerged(grid, isovalue, bound, kMaxBrickMergeLevel, {}, &leaves);
    ASSERT_THAT(fresh, IsOk());
    for (const test::Way& way : ways) {
        SCOPED_TRACE(way.name);
        ASSERT_THAT(way.engine->setMergeBound(bound), IsOk());
        const auto stats = way.engine->slideTo(isovalue);
        ASSERT_THAT(stats, IsOk());
        const auto slid = way.engine->mesh();
        ASSERT_THAT(slid, IsOk());
        ASSERT_TRUE(test::isSameSurface(slid.value(), fresh.value()));
        ASSERT_EQ(stats.value().activeLeaves, leaves);
        ASSERT_EQ(stats.value().triangles, fresh.value().triangleCount());
        ASSERT_EQ(stats.value().activeEdges, test::distinctEdges(fresh.value()).size());
    }
    for (std::size_t n = 1; n < leaves.size(); ++n) {
        seen.leaves += leaves[n];
        seen.levels |= leaves[n] > 0 ? 1u << n : 0u;
    }
}

TEST(SlideMerged, IsExtractMergedOnRandomWalks) {
    test::Random random(test::testSeed(61));
    Merges seen;
    for (int i = 0; i < 24; ++i) {
        const test::RandomVolume other = test::randomVolume(random, 30);
        const auto grid = i % 3 == 2 && other.hasFinite ? other.grid : test::patchyVolume(random);
        SCOPED_TRACE("volume " + std::to_string(i));
        const test::TemporaryFolder folder;
        std::vector<test::Way> ways = mergingWays(grid, folder / "");
        MergeBound bound = kBounds[static_cast<std::size_t>(test::intRandom(random, 1, 6))];
        double isovalue = 40.0 * test::unitRandom(random);
        for (int step = 0; step < 20 && !testing::Test::HasFatalFailure(); ++step) {
            if (step % 7 == 6)
                bound = kBounds[static_cast<std::size_t>(test::intRandom(random, 0, 6))];
            isovalue = step % 5 == 4 ? 140.0 * test::unitRandom(random) - 50.0
                                     : isovalue + 2.0 * test::unitRandom(random) - 1.0;
            SCOPED_TRACE(testing::Message() << "step " << step << ", isovalue " << isovalue << ", bound "
                                            << static_cast<int>(bound.measure) << " " << bound.limit);
            expectMerged(ways, *grid, isovalue, bound, seen);
        }
        ASSERT_FALSE(testing::Test::HasFailure());
    }
    EXPECT_GT(seen.leaves, 10000u);
    EXPECT_EQ(seen.levels, 0b1110u);
}

template <class Sample>
void stepThroughEveryValue(ScalarType type) {
    GridGeometry geometry;
    geometry.dims = {26, 33, 17};
    const auto grid = test::makeVolume<Sample>(type, geometry, [](std::int64_t x, std::int64_t y, std::int64_t z) {
        const auto wave = [](double i, double period) { return std::sin(6.2831853 * i / period); };
        const double smooth = 3.0 + wave(static_cast<double>(x), 31.0) +
                              wave(static_cast<double>(y), 27.0) * wave(static_cast<double>(z), 23.0);
        const bool isRough = x / 8 == 1 && y / 8 != 2; // bricks beside bricks whose leaves are of other sizes
        return std::floor(20.0 * smooth + (isRough ? 3.0 * wave(static_cast<double>(x + y * z), 2.7) : 0.0));
    });
    const test::TemporaryFolder folder;
    std::vector<test::Way> ways = mergingWays(grid, folder / "");
    Merges seen;
    for (const MergeBound& bound : {MergeBound{Measure::Scalar, 1.5}, MergeBound{Measure::Distance, 0.4}}) {
        for (int value = 15; value <= 105 && !testing::Test::HasFatalFailure(); ++value)
            expectMerged(ways, *grid, value, bound, seen);
        for (int value = 105; value >= 15 && !testing::Test::HasFatalFailure(); --value)
            expectMerged(ways, *grid, value - 0.5, bound, seen);
    }
    EXPECT_EQ(seen.levels, 0b1110u);
}

TEST(SlideMerged, IsExtractMergedAtEveryValueOfShortIntegers) { stepThroughEveryValue<std::uint16_t>(ScalarType::U16); }
TEST(SlideMerged, IsExtractMergedAtEveryValueOfLongIntegers) { stepThroughEveryValue<std::int32_t>(ScalarType::I32); }
TEST(SlideMerged, IsExtractMergedAtEveryValueOfDoubles) { stepThroughEveryValue<double>(ScalarType::F64); }

} // namespace
} // namespace isoslider::extract
