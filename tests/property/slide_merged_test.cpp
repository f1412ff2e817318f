// Sliding with merged cells is extracting with them: at every isovalue, from wherever, and after the bound was changed.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>

#include <gtest/gtest.h>

#include "core/extract/live/brick_picture.h"
#include "core/extract/merged/merged_extraction.h"
#include "preprocess/metacells/brick_list.h"
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
        way.engine->setMergeBound(bound);
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

// A little further, now and then anywhere.
double nextIsovalue(double isovalue, int step, test::Random& random) {
    return step % 5 == 4 ? 140.0 * test::unitRandom(random) - 50.0 : isovalue + 2.0 * test::unitRandom(random) - 1.0;
}

// The isovalue stays: no sign changes, and what has merged or split is all that does.
TEST(SlideMerged, CellsThatMergeOrSplitHaveChanged) {
    const auto engine = preprocess::makeMemoryEngine(test::hillsVolume({48, 40, 44})).value();
    ASSERT_THAT(engine->slideTo(300.0), IsOk());
    const auto changedBy = [&](const MergeBound& bound, LeafCounts& leaves) {
        engine->setMergeBound(bound);
        const auto moved = engine->slideTo(300.0).value();
        EXPECT_EQ(moved.edgesAdded, 0u);
        leaves = moved.activeLeaves;
        SurfaceFrame frame;
        engine->copyFrame(frame, {.changes = true});
        EXPECT_EQ(frame.bricks->changedTriangles().empty(), moved.cellsRetriangulated == 0);
        return moved.cellsRetriangulated;
    };
    LeafCounts merged{}, split{};
    const std::uint64_t byMerging = changedBy({Measure::Distance, 0.3}, merged);
    const std::uint64_t larger = std::accumulate(merged.begin() + 1, merged.end(), std::uint64_t{0});
    ASSERT_GT(larger, 50u);
    EXPECT_GE(byMerging, larger);
    EXPECT_EQ(changedBy({Measure::Distance, 0.3}, merged), 0u) << "the same once more";
    const std::uint64_t bySplitting = changedBy({}, split);
    EXPECT_EQ(std::accumulate(split.begin() + 1, split.end(), std::uint64_t{0}), 0u);
    EXPECT_GE(bySplitting, larger) << "each leaves several cells that the surface passes through";
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
            isovalue = nextIsovalue(isovalue, step, random);
            SCOPED_TRACE(testing::Message() << "step " << step << ", isovalue " << isovalue << ", bound "
                                            << static_cast<int>(bound.measure) << " " << bound.limit);
            expectMerged(ways, *grid, isovalue, bound, seen);
        }
        ASSERT_FALSE(testing::Test::HasFailure());
    }
    EXPECT_GT(seen.leaves, 10000u);
    EXPECT_EQ(seen.levels, 0b1110u);
}

struct BricksOfSteps {
    std::uint64_t crossed = 0, made = 0; ///< without merging, and with it
};

// Of a brick that is one leaf among such only what is crossed on its edges matters: most steps leave most bricks as
// they are. Beside rough bricks it is not alone, and where these change it comes to be.
//
// `scale`: of the values, which start at the least of the type and end at its greatest; `step`: of the isovalue, in
// cells.
template <class Sample>
void stepAmongBricksOfOneLeaf(ScalarType type, double scale, double step, const GridDims& dims, BricksOfSteps& bricks) {
    test::Random random(test::testSeed(64));
    constexpr bool kIsWhole = std::numeric_limits<Sample>::is_integer;
    const double least = kIsWhole ? static_cast<double>(std::numeric_limits<Sample>::lowest()) : 42.0,
                 greatest = kIsWhole ? static_cast<double>(std::numeric_limits<Sample>::max()) : 1e9;
    const auto valueAt = [&](double distance) {
        return std::clamp(least + scale * (distance - 42.0), least, greatest);
    };
    GridGeometry geometry;
    geometry.dims = dims;
    const auto grid = test::makeVolume<Sample>(type, geometry, [&](std::int64_t x, std::int64_t y, std::int64_t z) {
        const double dx = static_cast<double>(x) + 31.0, dy = static_cast<double>(y) + 23.0,
                     dz = static_cast<double>(z) + 17.0;
        const bool isRough = x / 8 == 4 && y / 8 == 1 && z % 32 < 9;
        return valueAt(std::sqrt(dx * dx + dy * dy + dz * dz) + (isRough ? 2.0 * test::unitRandom(random) : 0.0));
    });
    Merges seen;
    const test::TemporaryFolder folder;
    std::vector<test::Way> ways = mergingWays(grid, folder / "");
    const auto unmerged = preprocess::makeMemoryEngine(grid).value(),
               merged = preprocess::makeMemoryEngine(grid).value();
    const MergeBound bound{Measure::Distance, 0.5};
    merged->setMergeBound(bound);
    double isovalue = valueAt(75.0);
    ASSERT_THAT(unmerged->slideTo(isovalue), IsOk());
    ASSERT_THAT(merged->slideTo(isovalue), IsOk());
    for (int k = 0; k < 60 && !testing::Test::HasFatalFailure(); ++k) {
        const bool isFar = k % 10 == 9;
        isovalue += scale * (isFar ? 10.0 : step) * (2.0 * test::unitRandom(random) - 1.0);
        SCOPED_TRACE(testing::Message() << "step " << k << ", isovalue " << isovalue);
        expectMerged(ways, *grid, isovalue, k % 20 == 19 ? MergeBound() : bound, seen);
        const auto movedUnmerged = unmerged->slideTo(isovalue), movedMerged = merged->slideTo(isovalue);
        ASSERT_THAT(movedUnmerged, IsOk());
        ASSERT_THAT(movedMerged, IsOk());
        SurfaceFrame frame;
        merged->copyFrame(frame, {.changes = true});
        EXPECT_EQ(frame.bricks->changedTriangles().empty(), movedMerged.value().cellsRetriangulated == 0);
        bricks.crossed += isFar ? 0 : movedUnmerged.value().bricksRead;
        bricks.made += isFar ? 0 : movedMerged.value().bricksRead;
    }
    merged->setMergeBound({});
    const auto split = merged->slideTo(isovalue);
    ASSERT_THAT(split, IsOk());
    EXPECT_EQ(split.value().edgesAdded + split.value().edgesRemoved, 0u) << "nothing is crossed";
    EXPECT_EQ(seen.levels, 0b1110u);
}

TEST(SlideMerged, MakesBricksOfOneLeafAgainOnlyWhereTheirEdgesAreCrossed) {
    BricksOfSteps bricks;
    stepAmongBricksOfOneLeaf<float>(ScalarType::F32, 1.0, 0.02, {65, 57, 49}, bricks);
    EXPECT_GT(bricks.made, 0u);
    EXPECT_LT(3 * bricks.made, 2 * bricks.crossed);
}
TEST(SlideMerged, MakesBricksOfOneLeafAgainLikewiseInShortIntegers) {
    BricksOfSteps bricks;
    stepAmongBricksOfOneLeaf<std::int16_t>(ScalarType::I16, 620.0, 0.02, {67, 57, 54}, bricks);
    EXPECT_LT(3 * bricks.made, 2 * bricks.crossed);
}
TEST(SlideMerged, MakesBricksOfOneLeafAgainLikewiseInBytes) { // where a value is on most bricks' edges
    BricksOfSteps bricks;
    stepAmongBricksOfOneLeaf<std::uint8_t>(ScalarType::U8, 2.4, 0.3, {64, 57, 49}, bricks);
    EXPECT_GT(bricks.made, 0u);
}

// Where all bricks are one leaf each, those that are made again are those whose vertices are on other edges.
TEST(SlideMerged, PointsOutBricksOfOneLeafThatAreMadeAgain) {
    test::Random random(test::testSeed(65));
    GridGeometry geometry;
    geometry.dims = {33, 41, 33};
    const auto engine =
        preprocess::makeMemoryEngine(test::makeVolume<float>(ScalarType::F32, geometry,
                                                             [](std::int64_t x, std::int64_t y, std::int64_t z) {
                                                                 return std::hypot(static_cast<double>(x) + 70.0,
                                                                                   static_cast<double>(y) + 80.0,
                                                                                   static_cast<double>(z) + 90.0);
                                                             }))
            .value();
    engine->setMergeBound({Measure::Distance, 0.5});
    double isovalue = 168.0;
    ASSERT_THAT(engine->slideTo(isovalue), IsOk());
    std::uint64_t made = 0, unchanged = 0;
    for (int step = 0; step < 40; ++step) {
        isovalue += 0.01 * (2.0 * test::unitRandom(random) - 1.0);
        const SlideStats moved = engine->slideTo(isovalue).value();
        ASSERT_EQ(moved.activeLeaves[3],
                  std::accumulate(moved.activeLeaves.begin(), moved.activeLeaves.end(), std::uint64_t{0}));
        EXPECT_EQ(moved.cellsRetriangulated, moved.bricksRead);
        SurfaceFrame frame;
        engine->copyFrame(frame, {.changes = true});
        EXPECT_EQ(frame.bricks->changedTriangles().size(), moved.bricksRead);
        made += moved.bricksRead;
        unchanged += moved.activeLeaves[3] - moved.bricksRead;
    }
    EXPECT_GT(made, 0u);
    EXPECT_GT(unchanged, 30 * made) << "also at the upper faces, where bricks without cells follow";
}

// An index of edges that was built with an error lists the edges that carry vertices then, of any level.
std::vector<test::Way> mergedEdges(const std::shared_ptr<const ScalarGrid>& grid, const std::filesystem::path& path,
                                   const MergeError& error) {
    preprocess::BuildOptions build;
    build.kind = index::IndexKind::Edges;
    build.mergeError = error;
    EXPECT_THAT(test::buildIndexOf(grid, path, build), IsOk());
    std::vector<test::Way> ways;
    ways.push_back({"edges", test::openIndex(grid, path, index::IndexKind::Edges)});
    ways.push_back({"edges, no cache", test::openIndex(grid, path, index::IndexKind::Edges, 0)});
    return ways;
}

enum class Kept { InSamples, InEdges };

template <class Sample>
void stepThroughEveryValue(ScalarType type, Kept kept = Kept::InSamples) {
    GridGeometry geometry;
    geometry.dims = {26, 33, 17};
    const auto grid = test::makeVolume<Sample>(type, geometry, [](std::int64_t x, std::int64_t y, std::int64_t z) {
        const auto wave = [](double i, double period) { return std::sin(6.2831853 * i / period); };
        const double smooth = 3.0 + wave(static_cast<double>(x), 31.0) +
                              wave(static_cast<double>(y), 27.0) * wave(static_cast<double>(z), 23.0);
        const bool isRough = x / 8 == 1 && y / 8 != 2; // bricks beside bricks whose leaves are of other sizes
        return std::floor(20.0 * smooth + (isRough ? 3.0 * wave(static_cast<double>(x + y * z), 2.7) : 0.0));
    });
    Merges seen;
    const auto stepThrough = [&](std::vector<test::Way>& ways, const MergeBound& bound) {
        for (int value = 15; value <= 105 && !testing::Test::HasFatalFailure(); ++value)
            expectMerged(ways, *grid, value, bound, seen);
        for (int value = 105; value >= 15 && !testing::Test::HasFatalFailure(); --value)
            expectMerged(ways, *grid, value - 0.5, bound, seen);
    };
    if (kept == Kept::InEdges) {
        for (const MergeError& error : {MergeError{Measure::Scalar, 1.5}, MergeError{Measure::Distance, 0.4}}) {
            const test::TemporaryFolder folder;
            std::vector<test::Way> ways = mergedEdges(grid, folder / "e.isx", error);
            stepThrough(ways, ways.front().engine->mergeBound());
        }
    } else {
        const test::TemporaryFolder folder;
        std::vector<test::Way> ways = mergingWays(grid, folder / "");
        for (const MergeBound& bound : {MergeBound{Measure::Scalar, 1.5}, MergeBound{Measure::Distance, 0.4}})
            stepThrough(ways, bound);
    }
    EXPECT_EQ(seen.levels, 0b1110u);
}

TEST(SlideMerged, IsExtractMergedAtEveryValueOfShortIntegers) { stepThroughEveryValue<std::uint16_t>(ScalarType::U16); }
TEST(SlideMerged, IsExtractMergedAtEveryValueOfLongIntegers) { stepThroughEveryValue<std::int32_t>(ScalarType::I32); }
TEST(SlideMerged, IsExtractMergedAtEveryValueOfDoubles) { stepThroughEveryValue<double>(ScalarType::F64); }
TEST(SlideMergedEdges, AreExtractMergedAtEveryValueOfShortIntegers) {
    stepThroughEveryValue<std::uint16_t>(ScalarType::U16, Kept::InEdges);
}
TEST(SlideMergedEdges, AreExtractMergedAtEveryValueOfLongIntegers) {
    stepThroughEveryValue<std::int32_t>(ScalarType::I32, Kept::InEdges);
}
TEST(SlideMergedEdges, AreExtractMergedAtEveryValueOfDoubles) {
    stepThroughEveryValue<double>(ScalarType::F64, Kept::InEdges);
}

const MergeError kErrors[] = {{Measure::Scalar, 0.5},   {Measure::Scalar, 3.0},   {Measure::Scalar, 1e9},
                              {Measure::Distance, 0.1}, {Measure::Distance, 0.5}, {Measure::Distance, 1e9}};

TEST(SlideMergedEdges, IsExtractMergedOnRandomWalks) {
    test::Random random(test::testSeed(62));
    Merges seen;
    for (int i = 0; i < 48; ++i) {
        const test::RandomVolume other = test::randomVolume(random, 30);
        const auto grid = i % 3 == 2 && other.hasFinite ? other.grid : test::patchyVolume(random);
        const MergeError& error = kErrors[i / 3 % 6];
        SCOPED_TRACE(testing::Message() << "volume " << i << ", error " << static_cast<int>(error.measure) << " "
                                        << error.amount);
        const test::TemporaryFolder folder;
        std::vector<test::Way> ways = mergedEdges(grid, folder / "e.isx", error);
        const MergeBound bound = ways.front().engine->mergeBound();
        double isovalue = 40.0 * test::unitRandom(random);
        for (int step = 0; step < 20 && !testing::Test::HasFatalFailure(); ++step) {
            isovalue = nextIsovalue(isovalue, step, random);
            SCOPED_TRACE(testing::Message() << "step " << step << ", isovalue " << isovalue);
            expectMerged(ways, *grid, isovalue, bound, seen);
        }
        ASSERT_FALSE(testing::Test::HasFailure());
    }
    EXPECT_GT(seen.leaves, 10000u);
    EXPECT_EQ(seen.levels, 0b1110u);
}

TEST(SlideMergedEdges, AreMergedWithinAnyOtherErrorToo) {
    test::Random random(test::testSeed(63));
    const test::TemporaryFolder folder;
    const auto grid = test::patchyVolume(random);
    auto ways = mergedEdges(grid, folder / "e.isx", {Measure::Distance, 0.25});
    EXPECT_EQ(ways.front().engine->mergeBound(), (MergeBound{Measure::Distance, 0.25}));
    Merges seen;
    double isovalue = 20.0;
    for (int step = 0; step < 80 && !HasFatalFailure(); ++step) {
        isovalue = nextIsovalue(isovalue, step, random);
        const MergeBound bound{Measure::Distance, step % 4 == 0   ? 0.25
                                                  : step % 4 == 1 ? 0.0
                                                  : step % 4 == 2 ? 1.0
                                                                  : 0.05};
        for (test::Way& way : ways)
            way.engine->setMergeBound(bound);
        SCOPED_TRACE(testing::Message() << "step " << step << ", isovalue " << isovalue << ", " << bound.limit);
        expectMerged(ways, *grid, isovalue, bound, seen);
    }
    EXPECT_GT(seen.leaves, 1000u);
}

// In cells, an error does not depend on the scale of the values: also where squares of them overflow or vanish.
TEST(SlideMerged, MergesTheSameCellsAtEveryScale) {
    const auto volumeAt = [](double scale) {
        GridGeometry geometry;
        geometry.dims = {34, 27, 25};
        return test::makeVolume<double>(ScalarType::F64, geometry, [&](std::int64_t x, std::int64_t y, std::int64_t z) {
            const double dx = static_cast<double>(x) - 15.0, dy = static_cast<double>(y) - 12.0,
                         dz = static_cast<double>(z) - 11.0;
            const bool isRough = x / 8 == 1;
            return scale * (std::sqrt(dx * dx + dy * dy + dz * dz) - 9.0 +
                            (isRough ? 0.2 * std::sin(static_cast<double>(7 * x + 5 * y + 3 * z)) : 0.0));
        });
    };
    LeafCounts expected{};
    const auto unscaled =
        extractMerged(*volumeAt(1.0), 0.0, {Measure::Distance, 0.2}, kMaxBrickMergeLevel, {}, &expected);
    ASSERT_THAT(unscaled, IsOk());
    ASSERT_GT(expected[1], 10u);
    ASSERT_GT(expected[0], 10u);
    for (const double scale : {1.0, std::ldexp(1.0, 530), std::ldexp(1.0, -530), std::ldexp(1.0, 1010)}) {
        SCOPED_TRACE(scale);
        const auto grid = volumeAt(scale);
        const test::TemporaryFolder folder;
        std::vector<test::Way> ways = mergingWays(grid, folder / "");
        Merges seen;
        expectMerged(ways, *grid, 0.0, {Measure::Distance, 0.2}, seen);
        expectMerged(ways, *grid, 0.5 * scale, {Measure::Scalar, 0.2 * scale}, seen);
        LeafCounts leaves{};
        ASSERT_THAT(extractMerged(*grid, 0.0, {Measure::Distance, 0.2}, kMaxBrickMergeLevel, {}, &leaves), IsOk());
        EXPECT_EQ(leaves, expected);
    }
}

} // namespace
} // namespace isoslider::extract
