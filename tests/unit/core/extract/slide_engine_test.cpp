#include "core/extract/slide_engine.h"

#include <algorithm>
#include <array>
#include <map>
#include <random>
#include <set>
#include <utility>

#include <gtest/gtest.h>

#include <glm/geometric.hpp>

#include "core/extract/full_extraction.h"
#include "core/extract/live/brick_picture.h"
#include "core/extract/merged/merged_extraction.h"
#include "preprocess/metacells/brick_list.h"
#include "tests/property/surface_comparison.h"
#include "tests/property/test_volumes.h"
#include "tests/support/result_matchers.h"
#include "tests/support/temporary_folder.h"

namespace isoslider::extract {
namespace {

using test::HasError;
using test::IsOk;

class SlideEngineTest : public testing::Test {
protected:
    std::unique_ptr<SlideEngine> openOn(const std::shared_ptr<const ScalarGrid>& grid, int skipLevels = 5,
                                        std::uint64_t cacheBytes = 1u << 28) {
        preprocess::BuildOptions options;
        options.skipLevels = skipLevels;
        options.sourceName = "hills";
        const auto path = folder_ / ("levels" + std::to_string(skipLevels) + ".isx");
        EXPECT_THAT(test::buildIndexOf(grid, path, options), IsOk());
        auto engine = SlideEngine::open(path, {cacheBytes});
        EXPECT_THAT(engine, IsOk());
        return std::move(engine).value();
    }

    std::filesystem::path buildMetacells() {
        preprocess::BuildOptions options;
        options.kind = index::IndexKind::Metacells;
        auto path = folder_ / "metacells.isx";
        EXPECT_THAT(test::buildIndexOf(hills_, path, options), IsOk());
        return path;
    }

    test::TemporaryFolder folder_;
    std::shared_ptr<const ScalarGrid> hills_ = test::hillsVolume({48, 40, 44});
};

TEST_F(SlideEngineTest, IsEmptyUntilTheFirstMove) {
    const auto engine = openOn(hills_);
    EXPECT_EQ(engine->info().sourceName, "hills");
    EXPECT_EQ(engine->info().geometry, hills_->geometry());
    EXPECT_TRUE(engine->mesh().value().positions.empty());
    SurfaceFrame frame;
    engine->copyFrame(frame);
    expandPicture(frame);
    EXPECT_TRUE(frame.indices.empty());
    EXPECT_TRUE(frame.positions.empty());
}

TEST_F(SlideEngineTest, RefusesAnIsovalueThatIsNotANumberAndKeepsItsSurface) {
    const auto engine = openOn(hills_);
    ASSERT_THAT(engine->slideTo(300.0), IsOk());
    EXPECT_THAT(engine->slideTo(std::numeric_limits<double>::quiet_NaN()), HasError(ErrorCode::InvalidArgument));
    ASSERT_THAT(engine->slideTo(301.0), IsOk());
    EXPECT_TRUE(test::isSameSurface(engine->mesh().value(), extractFull(*hills_, 301.0).value()));
}

TEST_F(SlideEngineTest, ACancelledMoveLeavesNoSurfaceAndTheNextIsRight) {
    const auto engine = openOn(hills_);
    ASSERT_THAT(engine->slideTo(300.0), IsOk());
    std::stop_source stop;
    stop.request_stop();
    const auto cancelled = engine->slideTo(350.0, {stop.get_token(), {}});
    ASSERT_THAT(cancelled, HasError(ErrorCode::Cancelled));
    EXPECT_TRUE(engine->mesh().value().positions.empty());
    const auto moved = engine->slideTo(350.0);
    ASSERT_THAT(moved, IsOk());
    EXPECT_EQ(moved.value().edgesAdded, moved.value().activeEdges) << "built anew from nothing";
    EXPECT_TRUE(test::isSameSurface(engine->mesh().value(), extractFull(*hills_, 350.0).value()));
}

TEST_F(SlideEngineTest, AJumpReportsHowFarItIs) {
    const auto engine = openOn(hills_, 5, 1u << 16); // room for a few chunks: they are read in turns
    std::vector<double> parts{0.0};
    ASSERT_THAT(engine->slideTo(300.0, {{},
                                        [&](double fraction, std::string_view stage) {
                                            EXPECT_GE(fraction, parts.back()) << stage;
                                            parts.push_back(fraction);
                                        }}),
                IsOk());
    EXPECT_GT(parts.size(), 3u);
    EXPECT_LT(parts[1], 0.4);
    EXPECT_EQ(parts.back(), 1.0);
}

// Every other grid point lies above all isovalues, the others at random below. The bricks grow in step until all edges
// are active: each run is outgrown everywhere at once, and the surface's arrays are in pieces long before that. They
// hold no more than the largest bricks there can be, which these are not.
TEST_F(SlideEngineTest, SlidesOnWhenItsArraysAreInPieces) {
    std::mt19937 random(4);
    const auto grid = test::makeVolume<float>(ScalarType::F32, test::cubeGeometry(33), [&](auto x, auto y, auto z) {
        return (x + y + z) % 2 == 0 ? static_cast<double>(random() % 1000) : 2000.0;
    });
    const auto engine = openOn(grid);
    double isovalue = 4.0;
    for (const double step : {4.0, -13.0, 3.0, -7.0, 5.0})
        for (isovalue += step; isovalue > 0.0 && isovalue < 1000.0; isovalue += step)
            ASSERT_THAT(engine->slideTo(isovalue), IsOk()) << isovalue;
    ASSERT_THAT(engine->slideTo(990.0), IsOk());
    EXPECT_TRUE(test::isSameSurface(engine->mesh().value(), extractFull(*grid, 990.0).value()));
}

TEST_F(SlideEngineTest, StandingStillCostsNothing) {
    const auto engine = openOn(hills_);
    ASSERT_THAT(engine->slideTo(300.25), IsOk());
    const auto moved = engine->slideTo(300.75); // no sample between
    ASSERT_THAT(moved, IsOk());
    EXPECT_EQ(moved.value().edgesTouched, 0u);
    EXPECT_EQ(moved.value().bytesRead, 0u);
    EXPECT_EQ(moved.value().cellsRetriangulated, 0u);
    EXPECT_TRUE(test::isSameSurface(engine->mesh().value(), extractFull(*hills_, 300.75).value()))
        << "vertices move all the same";
}

// L6: work follows the change, counted where it happens.
TEST_F(SlideEngineTest, CostFollowsTheChange) {
    const auto engine = openOn(hills_);
    const std::uint64_t allEntries = engine->info().levels[0].edges;
    ASSERT_THAT(engine->slideTo(300.0), IsOk());
    const auto small = engine->slideTo(301.0);
    const auto large = engine->slideTo(340.0);
    ASSERT_THAT(small, IsOk());
    ASSERT_THAT(large, IsOk());
    EXPECT_GT(small.value().edgesTouched, 0u);
    EXPECT_LT(small.value().edgesTouched, allEntries / 100);
    EXPECT_FALSE(small.value().hasRebuilt);
    const auto changed = [](const SlideStats& s) { return s.edgesAdded + s.edgesRemoved; };
    EXPECT_LE(small.value().edgesTouched, 3 * changed(small.value()));
    EXPECT_LE(large.value().edgesTouched, 3 * changed(large.value()));
    EXPECT_LE(small.value().cellsRetriangulated, 4 * changed(small.value())) << "an edge has four cells";
}

TEST_F(SlideEngineTest, SkipLevelsShortenAJump) {
    const auto leveled = openOn(hills_, 5);
    const auto plain = openOn(hills_, 1);
    ASSERT_THAT(leveled->slideTo(200.0), IsOk());
    ASSERT_THAT(plain->slideTo(200.0), IsOk());
    const auto far = leveled->slideTo(700.0), slow = plain->slideTo(700.0);
    ASSERT_THAT(far, IsOk());
    ASSERT_THAT(slow, IsOk());
    EXPECT_LT(far.value().edgesTouched, slow.value().edgesTouched);
    EXPECT_TRUE(std::any_of(far.value().walk.begin(), far.value().walk.end(),
                            [](const WalkStep& s) { return s.level > index::kLevel0; }));
    EXPECT_TRUE(std::all_of(slow.value().walk.begin(), slow.value().walk.end(),
                            [](const WalkStep& s) { return s.level == index::kLevel0; }));
    EXPECT_TRUE(test::isSameSurface(leveled->mesh().value(), plain->mesh().value()));
}

TEST_F(SlideEngineTest, ReadsFromTheFileOnlyWhatIsNotCached) {
    const auto cached = openOn(hills_, 3);
    const auto uncached = openOn(hills_, 3, 1);
    for (SlideEngine* engine : {cached.get(), uncached.get()}) {
        ASSERT_THAT(engine->slideTo(300.0), IsOk());
        ASSERT_THAT(engine->slideTo(320.0), IsOk());
        ASSERT_THAT(engine->slideTo(300.0), IsOk());
        const auto again = engine->slideTo(320.0);
        ASSERT_THAT(again, IsOk());
        std::uint64_t bytes = 0;
        for (const WalkStep& step : again.value().walk)
            bytes += step.bytes;
        EXPECT_GT(bytes, 0u);
        if (engine == cached.get()) {
            EXPECT_EQ(again.value().bytesRead, 0u);
        } else {
            EXPECT_GE(again.value().bytesRead, bytes);
        }
    }
}

TEST_F(SlideEngineTest, IsEmptyOutsideTheRangeAndComesBack) {
    const auto engine = openOn(hills_);
    for (const double outside :
         {-1e9, 1e9, -std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()}) {
        ASSERT_THAT(engine->slideTo(400.0), IsOk());
        EXPECT_GT(engine->mesh().value().triangleCount(), 0u);
        const auto moved = engine->slideTo(outside);
        ASSERT_THAT(moved, IsOk());
        EXPECT_EQ(moved.value().activeEdges, 0u);
        EXPECT_EQ(moved.value().triangles, 0u);
        EXPECT_TRUE(engine->mesh().value().positions.empty());
        SurfaceFrame frame;
        engine->copyFrame(frame);
        expandPicture(frame);
        EXPECT_TRUE(test::placedTriangles(frame.positions, frame.indices).empty());
    }
}

// A sweep there and back leaves the memory of one surface, not of all that were shown: also where each is looked at
// until the next is there.
TEST_F(SlideEngineTest, FramesDoNotGrowWithTheNumberOfMoves) {
    for (const bool isWatched : {false, true}) {
        const auto engine = openOn(hills_);
        std::uint64_t first = 0, last = 0;
        SurfaceFrame shown;
        for (int round = 0; round < 6; ++round) {
            for (int step = 0; step <= 40; ++step) {
                ASSERT_THAT(engine->slideTo(150.0 + 15.0 * (round % 2 ? 40 - step : step)), IsOk());
                if (!isWatched)
                    continue;
                SurfaceFrame frame;
                engine->copyFrame(frame);
                shown = std::move(frame);
            }
            SurfaceFrame frame;
            engine->copyFrame(frame);
            last = pictureBytes(frame);
            if (round < 2)
                first = std::max(first, last);
        }
        EXPECT_LE(last, 2 * first) << isWatched;
    }
}

// What a large surface took is given back, here and on the card, though nothing is rebuilt.
TEST_F(SlideEngineTest, MemoryFollowsASurfaceThatShrinks) {
    SlideOptions options;
    options.cacheBytes = 0; // which points of bricks that have left would have a share of
    const auto built = buildMetacells();
    auto made = SlideEngine::open(built, options);
    ASSERT_THAT(made, IsOk());
    SlideEngine& engine = *made.value();
    std::uint64_t largest = 0, last = 0;
    SurfaceFrame shown;
    double isovalue = 400.0;
    for (; isovalue < 1300.0; isovalue += 7.0) {
        const auto moved = engine.slideTo(isovalue);
        ASSERT_THAT(moved, IsOk());
        EXPECT_FALSE(isovalue > 400.0 && moved.value().hasRebuilt);
        SurfaceFrame frame;
        engine.copyFrame(frame);
        last = pictureBytes(frame);
        largest = std::max(largest, last);
        auto fresh = SlideEngine::open(built, options);
        ASSERT_THAT(fresh, IsOk());
        ASSERT_THAT(fresh.value()->slideTo(isovalue), IsOk());
        SurfaceFrame needed;
        fresh.value()->copyFrame(needed);
        if (isovalue < 1000.0) { // of the smallest surfaces a granule is a large part
            EXPECT_LT(last, 2.25 * static_cast<double>(pictureBytes(needed))) << isovalue;
        }
        shown = std::move(frame);
        ASSERT_TRUE(test::isSameSurface(engine.mesh().value(), extractFull(*hills_, isovalue).value())) << isovalue;
        if (moved.value().activeEdges < 500)
            break;
    }
    EXPECT_LT(last, largest / 3) << isovalue;
}

// Where memory is given back runs move, those of points that are kept for bricks which have left too.
TEST_F(SlideEngineTest, KeptPointsSurviveThatMemoryIsGivenBack) {
    SlideOptions options;
    options.cacheBytes = std::uint64_t{256} << 10; // some twenty bricks of points, and little slack
    const auto opened = SlideEngine::open(buildMetacells(), options);
    ASSERT_THAT(opened, IsOk());
    SlideEngine& engine = *opened.value();
    SurfaceFrame shrunk, grown;
    const auto slideTo = [&](double isovalue, SurfaceFrame& frame) {
        ASSERT_THAT(engine.slideTo(isovalue), IsOk());
        engine.copyFrame(frame);
        const SurfaceMesh slid = engine.mesh().value();
        ASSERT_TRUE(test::isSameSurface(slid, extractFull(*hills_, isovalue).value())) << isovalue;
        ASSERT_TRUE(test::hasExpectedNormals(slid, *hills_)) << isovalue;
    };
    double isovalue = 400.0;
    ASSERT_NO_FATAL_FAILURE(slideTo(isovalue, shrunk));
    std::uint64_t lines = 0;
    while (shrunk.bricks->pointLineEnd() >= lines && isovalue < 1000.0) {
        lines = shrunk.bricks->pointLineEnd();
        ASSERT_NO_FATAL_FAILURE(slideTo(isovalue += 7.0, shrunk));
    }
    ASSERT_LT(shrunk.bricks->pointLineEnd(), lines) << "nothing was given back";
    ASSERT_NO_FATAL_FAILURE(slideTo(isovalue - 50.0, grown));
    std::set<std::array<std::uint16_t, 3>> before;
    for (const PictureBrick& brick : shrunk.bricks->bricks())
        if (brick.indexCount > 0)
            before.insert(brick.place);
    int cameBack = 0;
    for (const PictureBrick& brick : grown.bricks->bricks())
        cameBack += brick.indexCount > 0 && !before.contains(brick.place) && brick.pointsVersion < brick.version;
    EXPECT_GT(cameBack, 5);
}

// Of the bound on caches points have a half where the list of edges and the samples leave it, and less after a handle
// has gone through the list slowly, so that much of it is kept.
TEST_F(SlideEngineTest, PointsAreKeptInWhatTheListLeaves) {
    const auto path = folder_ / "edges.isx";
    ASSERT_THAT(test::buildIndexOf(hills_, path, {}), IsOk());
    constexpr std::uint64_t kCacheBytes = std::uint64_t{512} << 10, kHalf = kCacheBytes / 2;
    const auto keptBytes = [&](bool goesSlowly) -> std::uint64_t { // of points that a handle finds which comes back
        SlideOptions options;
        options.cacheBytes = kCacheBytes;
        options.buildsLevels = false; // when they are there cannot be told
        const auto engine = SlideEngine::open(path, options).value();
        for (double isovalue = 100.0; goesSlowly && isovalue < 700.0; isovalue += 1.0)
            EXPECT_THAT(engine->slideTo(isovalue), IsOk());
        SurfaceFrame frame;
        for (const double isovalue : {300.0, 1e9, 300.0, 1e9, 300.0}) {
            EXPECT_THAT(engine->slideTo(isovalue), IsOk());
            engine->copyFrame(frame);
        }
        EXPECT_TRUE(test::isSameSurface(engine->mesh().value(), extractFull(*hills_, 300.0).value()));
        const auto bricks = frame.bricks->bricks();
        const auto cameBack = std::count_if(bricks.begin(), bricks.end(), [](const PictureBrick& brick) {
            return brick.indexCount > 0 && brick.pointsVersion < brick.version;
        });
        return static_cast<std::uint64_t>(cameBack) * pointLineCount(sizeof(std::uint16_t)) * sizeof(PointLine);
    };
    const std::uint64_t after = keptBytes(false), afterSlow = keptBytes(true);
    EXPECT_LE(after, kHalf);
    EXPECT_GT(after, kHalf * 9 / 10);
    EXPECT_LT(afterSlow, kHalf * 8 / 10);
    EXPECT_GT(afterSlow, kHalf * 4 / 10);
}

// Some runs move at a time, those of kept points last, while bricks return with theirs.
TEST_F(SlideEngineTest, MemoryIsGivenBackOverSeveralMoves) {
    const std::shared_ptr<const ScalarGrid> hills = test::hillsVolume({176, 168, 160});
    const auto path = folder_ / "large.isx";
    preprocess::BuildOptions build;
    build.kind = index::IndexKind::Metacells;
    ASSERT_THAT(test::buildIndexOf(hills, path, build), IsOk());
    SlideOptions options;
    options.cacheBytes = std::uint64_t{16} << 20;
    const auto engine = SlideEngine::open(path, options).value();
    SurfaceFrame shown;
    const auto slideTo = [&](double isovalue) {
        ASSERT_THAT(engine->slideTo(isovalue), IsOk());
        SurfaceFrame frame;
        engine->copyFrame(frame);
        shown = std::move(frame);
    };
    for (const double isovalue : {300.0, 350.0, 400.0, 450.0, 500.0})
        ASSERT_NO_FATAL_FAILURE(slideTo(isovalue));
    const std::uint64_t large = shown.bricks->pointLineEnd(), series = shown.bricks->series();
    for (int k = 0; k < 40; ++k) {
        ASSERT_NO_FATAL_FAILURE(slideTo(k < 10 ? 1100.0 : std::max(900.0, 1100.0 - 70.0 * (k - 9)) + 0.01 * k));
        ASSERT_EQ(shown.bricks->series(), series) << "the card is sent all again";
    }
    EXPECT_LT(shown.bricks->pointLineEnd(), large * 9 / 10);
    EXPECT_TRUE(test::isSameSurface(engine->mesh().value(), extractFull(*hills, shown.isovalue).value()));
}

// What vertices are made from may be kept beside them: the arrays are the same, also when bricks have moved in memory,
// while a picture is held and while none is, with merged cells and without.
TEST_F(SlideEngineTest, ArraysFromKeptGroupsAreThoseFromPoints) {
    const auto path = buildMetacells();
    SlideOptions options;
    options.cacheBytes = std::uint64_t{128} << 10; // small: memory is given back
    const auto plain = SlideEngine::open(path, options);
    options.keepsGroups = true;
    const auto keeping = SlideEngine::open(path, options);
    ASSERT_THAT(plain, IsOk());
    ASSERT_THAT(keeping, IsOk());
    std::vector<glm::vec3> positions, normals, keptPositions, keptNormals;
    std::uint64_t mergedLeaves = 0, vertexEnd = 0;
    int timesGivenBack = 0;
    for (const double limit : {0.0, 0.4})
        for (const bool holdsPicture : {true, false}) {
            SurfaceFrame held;
            for (const double isovalue : {300.5, 301.0, 310.25, 290.0, 291.0, 900.0, 903.0, 950.0, 951.0, 953.0, 953.5,
                                          954.0, 955.0, 956.0, 957.0, 300.0}) {
                SurfaceFrame frame, kept;
                for (const auto& [engine, its] : {std::pair(&plain, &frame), std::pair(&keeping, &kept)}) {
                    engine->value()->setMergeBound({MergeBound::Measure::Distance, limit});
                    ASSERT_THAT(engine->value()->slideTo(isovalue), IsOk());
                    engine->value()->copyFrame(*its);
                }
                expandVertices(*frame.bricks, isovalue, positions, normals);
                expandVertices(*kept.bricks, isovalue, keptPositions, keptNormals);
                ASSERT_EQ(positions, keptPositions) << isovalue;
                ASSERT_EQ(normals, keptNormals) << isovalue;
                EXPECT_NE(kept.bricks->groups(kept.bricks->bricks()[0]), nullptr);
                EXPECT_EQ(frame.bricks->groups(frame.bricks->bricks()[0]), nullptr);
                mergedLeaves += kept.stats.activeLeaves[1];
                timesGivenBack += kept.bricks->vertexEnd() < std::exchange(vertexEnd, kept.bricks->vertexEnd());
                if (holdsPicture)
                    held = std::move(kept);
            }
        }
    EXPECT_GT(timesGivenBack, 2);
    EXPECT_GT(mergedLeaves, 0u);
}

// A handle that goes to and fro does not pay for it again and again: little is never given back.
TEST_F(SlideEngineTest, LittleMemoryStaysWithASurfaceThatShrinks) {
    const auto engine = SlideEngine::open(buildMetacells());
    ASSERT_THAT(engine, IsOk());
    SurfaceFrame first, frame;
    ASSERT_THAT(engine.value()->slideTo(400.0), IsOk());
    engine.value()->copyFrame(first);
    for (double isovalue = 430.0; isovalue < 1000.0; isovalue += 30.0) {
        ASSERT_THAT(engine.value()->slideTo(isovalue), IsOk());
        engine.value()->copyFrame(frame);
        ASSERT_GE(frame.bricks->vertexEnd(), first.bricks->vertexEnd()) << isovalue;
        ASSERT_GE(frame.bricks->indexEnd(), first.bricks->indexEnd()) << isovalue;
        ASSERT_GE(frame.bricks->pointLineEnd(), first.bricks->pointLineEnd()) << isovalue;
    }
}

// The same where the surface starts again; what a picture shows stays while it is shown.
TEST_F(SlideEngineTest, MemoryFollowsAJumpToASmallSurface) {
    const auto engine = openOn(hills_, 5, 1u << 16); // no room for points of bricks that have left
    ASSERT_THAT(engine->slideTo(500.0), IsOk());
    SurfaceFrame shown, before, after;
    engine->copyFrame(shown);
    const std::uint64_t large = pictureBytes(shown);
    before.isovalue = after.isovalue = shown.isovalue;
    expandPicture(*shown.bricks, before);
    ASSERT_GT(before.indices.size(), 10'000u);

    const auto jumped = engine->slideTo(engine->info().max - 1.0);
    ASSERT_THAT(jumped, IsOk());
    EXPECT_LT(jumped.value().activeEdges, before.positions.size() / 20);
    expandPicture(*shown.bricks, after);
    EXPECT_EQ(before.positions, after.positions);
    EXPECT_EQ(before.indices, after.indices);

    shown = {};
    ASSERT_THAT(engine->slideTo(engine->info().max - 2.0), IsOk());
    engine->copyFrame(shown);
    EXPECT_LT(pictureBytes(shown), large / 3);
}

// A brick that has changed once is made from what is kept of it: nothing is decoded again, whatever the cache holds.
TEST_F(SlideEngineTest, CrossedBricksReadNoSamplesAgain) {
    const auto path = buildMetacells();
    SlideOptions options;
    options.readsAhead = false;
    auto opened = SlideEngine::open(path, options);
    ASSERT_THAT(opened, IsOk());
    SlideEngine& engine = *opened.value();
    const std::vector<double> way{300.5, 301.5, 302.5, 301.5, 300.5};
    for (const double isovalue : way)
        ASSERT_THAT(engine.slideTo(isovalue), IsOk());
    engine.dropCaches();
    std::uint64_t changed = 0, made = 0;
    for (const double isovalue : way) {
        const auto moved = engine.slideTo(isovalue);
        ASSERT_THAT(moved, IsOk());
        changed += moved.value().edgesAdded + moved.value().edgesRemoved;
        made += moved.value().bricksRead;
        EXPECT_EQ(moved.value().chunksRead, 0u) << isovalue;
    }
    EXPECT_GT(changed, 0u);
    EXPECT_GT(made, 20u);
    EXPECT_TRUE(test::isSameSurface(engine.mesh().value(), extractFull(*hills_, way.back()).value()));
}

// A handle goes to and fro: bricks that have left and come back need not be read again, nor sent to the graphics card,
// as many of them as the bound on caches allows.
TEST_F(SlideEngineTest, BricksThatComeBackHaveKeptTheirPoints) {
    const auto path = buildMetacells();
    SlideOptions options;
    options.readsAhead = false;
    const auto pointsOf = [](const SurfaceFrame& frame) { // by place: where they are, and since when
        std::map<std::array<std::uint16_t, 3>, std::pair<std::uint32_t, std::uint32_t>> points;
        for (const PictureBrick& brick : frame.bricks->bricks())
            if (brick.indexCount > 0)
                points[brick.place] = {brick.firstPointLine, brick.pointsVersion};
        return points;
    };
    const std::size_t bytesOfPoints = pointLineCount(sizeof(std::uint16_t)) * sizeof(PointLine);
    ASSERT_EQ(hills_->type(), ScalarType::U16);
    std::vector<std::size_t> kept;
    for (const std::uint64_t cacheBytes : {std::uint64_t{128} << 10, std::uint64_t{64} << 20})
        for (const bool drops : {false, true}) {
            options.cacheBytes = cacheBytes;
            const auto engine = SlideEngine::open(path, options);
            ASSERT_THAT(engine, IsOk());
            SurfaceFrame first, between, last;
            SurfaceFrame before, after;
            ASSERT_THAT(engine.value()->slideTo(300.5), IsOk());
            engine.value()->copyFrame(first);
            before.isovalue = after.isovalue = first.isovalue;
            expandPicture(*first.bricks, before);
            ASSERT_THAT(engine.value()->slideTo(150.5), IsOk());
            engine.value()->copyFrame(between);
            if (drops)
                engine.value()->dropCaches();
            ASSERT_THAT(engine.value()->slideTo(300.5), IsOk());
            engine.value()->copyFrame(last);
            EXPECT_TRUE(test::isSameSurface(engine.value()->mesh().value(), extractFull(*hills_, 300.5).value()));
            EXPECT_TRUE(test::hasExpectedNormals(engine.value()->mesh().value(), *hills_));
            expandPicture(*first.bricks, after);
            EXPECT_EQ(before.positions, after.positions);
            EXPECT_EQ(before.normals, after.normals);
            const auto then = pointsOf(first), meanwhile = pointsOf(between), now = pointsOf(last);
            std::size_t back = 0, same = 0;
            for (const auto& [place, points] : now)
                if (!meanwhile.contains(place)) {
                    ++back;
                    same += then.at(place) == points;
                }
            ASSERT_GT(back, 40u);
            if (drops)
                EXPECT_EQ(same, 0u);
            else if (cacheBytes > (1u << 20))
                EXPECT_EQ(same, back);
            else
                EXPECT_LE(same * bytesOfPoints, cacheBytes / 2);
            kept.push_back(same);
        }
    EXPECT_GT(kept[0], 5u) << "else the bound is never met";
}

// The window uploads the bricks that have another version: they must be few where little changes.
TEST_F(SlideEngineTest, PicturesDifferInTheBricksThatChange) {
    const auto engine = openOn(hills_);
    ASSERT_THAT(engine->slideTo(300.25), IsOk());
    SurfaceFrame before, after;
    engine->copyFrame(before);
    const auto differing = [&] {
        engine->copyFrame(after);
        EXPECT_EQ(before.bricks->series(), after.bricks->series());
        const auto old = before.bricks->bricks(), now = after.bricks->bricks();
        std::size_t count = 0;
        for (std::size_t slot = 0; slot < now.size(); ++slot)
            count += slot >= old.size() || now[slot] != old[slot];
        return count;
    };
    const std::size_t bricks = before.bricks->bricks().size();
    ASSERT_GT(bricks, 60u);
    const auto none = engine->slideTo(300.75);
    ASSERT_THAT(none, IsOk());
    ASSERT_EQ(none.value().edgesAdded + none.value().edgesRemoved, 0u);
    EXPECT_LT(differing(), bricks / 10) << "only those with vertices inside cells";
    const auto few = engine->slideTo(301.25);
    ASSERT_THAT(few, IsOk());
    ASSERT_GT(few.value().edgesAdded + few.value().edgesRemoved, 0u);
    EXPECT_GT(differing(), 0u);
    EXPECT_LT(differing(), bricks);
}

} // namespace
} // namespace isoslider::extract
