// The surface in a region of the volume: what the surface of the whole has there, whatever was before.

#include <algorithm>
#include <chrono>
#include <iterator>
#include <optional>
#include <thread>

#include <gtest/gtest.h>

#include "core/extract/full_extraction.h"
#include "core/extract/live/brick_picture.h"
#include "core/extract/merged/merged_extraction.h"
#include "core/extract/slide_engine.h"
#include "tests/property/random_volumes.h"
#include "tests/property/slide_ways.h"
#include "tests/property/surface_comparison.h"
#include "tests/property/test_volumes.h"
#include "tests/support/result_matchers.h"
#include "tests/support/temporary_folder.h"

namespace isoslider::extract {
namespace {

using test::IsOk;
using test::PlacedTriangle;

enum class Place { Inside, OnBorder, Outside };

// Of a triangle in relation to the cells of a region: those in the plane of its border may belong to either side.
Place placeOf(const PlacedTriangle& triangle, const BrickBox& region) {
    constexpr float kNear = 1e-3f;
    Place place = Place::Inside;
    for (std::size_t a = 0; a < 3; ++a) {
        const float middle = (triangle[0][a] + triangle[1][a] + triangle[2][a]) / 3.0f;
        const auto low = static_cast<float>(kBrickSide * region.first[a]),
                   high = static_cast<float>(kBrickSide * (region.last[a] + 1));
        if (middle < low - kNear || middle > high + kNear)
            return Place::Outside;
        if (middle < low + kNear || middle > high - kNear)
            place = Place::OnBorder;
    }
    return place;
}

std::vector<PlacedTriangle> trianglesIn(const SurfaceMesh& mesh, const BrickBox& region, bool withBorder) {
    std::vector<PlacedTriangle> all = test::placedTriangles(mesh.positions, mesh.triangles);
    std::erase_if(all, [&](const PlacedTriangle& triangle) {
        const Place place = placeOf(triangle, region);
        return place == Place::Outside || (place == Place::OnBorder && !withBorder);
    });
    return all;
}

// Without the bricks at its border, but where the volume ends there.
std::optional<BrickBox> innerPart(BrickBox region, const BrickGrid& grid) {
    for (std::size_t a = 0; a < 3; ++a) {
        if (region.first[a] > 0)
            ++region.first[a];
        if (region.last[a] < grid.bricks()[static_cast<int>(a)] - 1)
            --region.last[a];
        if (region.first[a] > region.last[a])
            return std::nullopt;
    }
    return region;
}

std::optional<BrickBox> randomRegion(const BrickGrid& grid, test::Random& random) {
    if (test::intRandom(random, 0, 4) == 0)
        return std::nullopt;
    BrickBox box;
    for (std::size_t a = 0; a < 3; ++a) {
        const std::int64_t last = grid.bricks()[static_cast<int>(a)] - 1;
        box.first[a] = test::intRandom(random, 0, last);
        box.last[a] = test::intRandom(random, box.first[a], last);
    }
    return box;
}

testing::AssertionResult includes(const std::vector<PlacedTriangle>& all, const std::vector<PlacedTriangle>& part) {
    std::vector<PlacedTriangle> missing;
    std::set_difference(part.begin(), part.end(), all.begin(), all.end(), std::back_inserter(missing));
    return missing.empty() ? testing::AssertionSuccess()
                           : testing::AssertionFailure() << missing.size() << " of " << part.size()
                                                         << " triangles are not among " << all.size();
}

class SlideRegion : public testing::TestWithParam<int> {};

TEST_P(SlideRegion, HasWhatTheWholeSurfaceHasThere) {
    for (std::uint64_t seed = test::testSeed(9000) + 100 * static_cast<std::uint64_t>(GetParam()), last = seed + 8;
         seed < last && !HasFatalFailure(); ++seed) {
        test::Random random(seed);
        const test::RandomVolume volume = test::randomVolume(random, 40);
        SCOPED_TRACE("seed " + std::to_string(seed) + ": " + volume.description);
        if (!volume.hasFinite)
            continue;
        const test::TemporaryFolder folder;
        const BrickGrid grid(volume.grid->dims());
        std::vector<test::Way> ways = test::allWays(volume.grid, folder / "");
        std::optional<BrickBox> region;
        MergeBound bound{MergeBound::Measure::Distance, 0.0};
        std::vector<SurfaceFrame> pictures(ways.size()); // of the move before, as in a window
        double isovalue = volume.min;
        for (int stop = 0; stop < 16; ++stop) {
            if (test::intRandom(random, 0, 3) > 0)
                isovalue = test::nextIsovalue(volume, isovalue, random);
            if (test::intRandom(random, 0, 2) == 0)
                region = randomRegion(grid, random);
            if (stop % 5 == 0)
                bound.limit = test::intRandom(random, 0, 2) == 0 ? 0.0 : 0.5;
            SCOPED_TRACE("stop " + std::to_string(stop) + " at " + std::to_string(isovalue));
            const auto fresh = bound.limit > 0.0 ? extractMerged(*volume.grid, isovalue, bound, kMaxBrickMergeLevel)
                                                 : extractFull(*volume.grid, isovalue);
            ASSERT_THAT(fresh, IsOk());
            for (std::size_t w = 0; w < ways.size(); ++w) {
                SlideEngine& engine = *ways[w].engine;
                SCOPED_TRACE(ways[w].name);
                engine.setRegion(region);
                engine.setMergeBound(bound);
                const auto moved = engine.slideTo(isovalue);
                ASSERT_THAT(moved, IsOk());
                EXPECT_EQ(engine.region(), region);
                engine.copyFrame(pictures[w]);
                const SurfaceMesh slid = engine.mesh().value();
                EXPECT_EQ(moved.value().triangles, slid.triangleCount());
                if (!region) {
                    ASSERT_TRUE(test::isSameSurface(slid, fresh.value()));
                    continue;
                }
                const auto all = test::placedTriangles(slid.positions, slid.triangles);
                ASSERT_EQ(trianglesIn(slid, *region, true).size(), all.size()) << "nothing lies outside";
                if (bound.limit == 0.0) {
                    ASSERT_TRUE(includes(test::placedTriangles(fresh.value().positions, fresh.value().triangles), all));
                    ASSERT_TRUE(includes(all, trianglesIn(fresh.value(), *region, false)));
                } else if (const auto inner = innerPart(*region, grid)) {
                    ASSERT_TRUE(includes(trianglesIn(fresh.value(), *inner, true), trianglesIn(slid, *inner, false)));
                    ASSERT_TRUE(includes(trianglesIn(slid, *inner, true), trianglesIn(fresh.value(), *inner, false)));
                }
            }
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Walks, SlideRegion, testing::Range(0, 4));

// A move costs what changes in the region; the first one finds out which bricks these are, and reads no other.
TEST(SlideRegion, CostsWhatChangesThere) {
    const auto grid = test::noiseVolume({96, 96, 96}, 3, 200);
    const test::TemporaryFolder folder;
    const auto engine = test::openIndex(grid, folder / "m.isx", index::IndexKind::Metacells);
    ASSERT_TRUE(engine);
    ASSERT_THAT(engine->slideTo(100.3), IsOk());
    const auto whole = engine->slideTo(101.3);
    ASSERT_THAT(whole, IsOk());
    engine->setRegion(BrickBox{{2, 3, 4}, {4, 6, 5}});
    const auto first = engine->slideTo(102.3);
    ASSERT_THAT(first, IsOk());
    const auto bounded = engine->slideTo(103.3);
    ASSERT_THAT(bounded, IsOk());
    constexpr std::uint64_t kBricks = 3 * 4 * 2;
    EXPECT_GT(whole.value().bricksRead, 40 * kBricks);
    EXPECT_GT(bounded.value().bricksRead, kBricks / 2);
    EXPECT_LE(bounded.value().bricksRead, kBricks);
    EXPECT_LE(first.value().bricksRead, kBricks);
    EXPECT_EQ(bounded.value().walk.size(), whole.value().walk.size()) << "only what lies between is walked";
    EXPECT_LT(bounded.value().activeEdges, whole.value().activeEdges / 40);
    engine->setRegion(std::nullopt);
    const auto again = engine->slideTo(103.3);
    ASSERT_THAT(again, IsOk());
    // But for some with cells at the very end of their state.
    EXPECT_LT(again.value().bricksRead, 12u * 12u * 12u - kBricks / 2) << "what is there stays";
    EXPECT_TRUE(test::isSameSurface(engine->mesh().value(), extractFull(*grid, 103.3).value()));
}

// A merged cell at the region's border is made again when there are others beside it.
TEST(SlideRegion, HasMergedCellsThatMeetThoseThatCome) {
    const auto grid = test::hillsVolume({48, 40, 33});
    const test::TemporaryFolder folder;
    const auto engine = test::openIndex(grid, folder / "m.isx", index::IndexKind::Metacells);
    ASSERT_TRUE(engine);
    const MergeBound bound{MergeBound::Measure::Distance, 0.5};
    engine->setMergeBound(bound);
    for (const double isovalue : {300.5, 420.5}) {
        for (const std::int64_t side : {1, 2, 3}) {
            engine->setRegion(BrickBox{{1, 1, 1}, {side + 1, side, side}});
            ASSERT_THAT(engine->slideTo(isovalue), IsOk());
        }
        engine->setRegion(std::nullopt);
        ASSERT_THAT(engine->slideTo(isovalue), IsOk());
        EXPECT_TRUE(test::isSameSurface(engine->mesh().value(),
                                        extractMerged(*grid, isovalue, bound, kMaxBrickMergeLevel).value()));
    }
}

// Bricks of the next move are read in the background, by the region that it was asked for.
TEST(SlideRegion, ChangesWhileBricksAreReadAhead) {
    const auto grid = test::hillsVolume({112, 112, 112}); // enough chunks to read ahead
    const test::TemporaryFolder folder;
    const auto engine = test::openIndex(grid, folder / "m.isx", index::IndexKind::Metacells);
    ASSERT_TRUE(engine);
    for (int step = 0; step < 12; ++step) {
        const double isovalue = 250.5 + 10.0 * step;
        ASSERT_THAT(engine->slideTo(isovalue), IsOk());
        std::this_thread::sleep_for(std::chrono::milliseconds(2 * (step % 3))); // a hand is not faster
        engine->setRegion(BrickBox{{step % 4, 0, 0}, {6 + step % 3, 8, 9}});
    }
    ASSERT_THAT(engine->slideTo(400.5), IsOk());
    engine->setRegion(std::nullopt);
    ASSERT_THAT(engine->slideTo(410.5), IsOk());
    EXPECT_TRUE(test::isSameSurface(engine->mesh().value(), extractFull(*grid, 410.5).value()));
}

// What could not be done leaves nothing behind: the next move has the region that was asked for.
TEST(SlideRegion, HoldsAfterAMoveWasBrokenOff) {
    const auto grid = test::hillsVolume({48, 40, 33});
    const test::TemporaryFolder folder;
    const auto engine = test::openIndex(grid, folder / "m.isx", index::IndexKind::Metacells);
    ASSERT_TRUE(engine);
    ASSERT_THAT(engine->slideTo(300.5), IsOk());
    const BrickBox region{{1, 1, 1}, {3, 3, 2}};
    engine->setRegion(region);
    std::stop_source stopped;
    stopped.request_stop();
    JobControl job;
    job.stop = stopped.get_token();
    EXPECT_FALSE(engine->slideTo(310.5, job).isOk());
    ASSERT_THAT(engine->slideTo(310.5), IsOk());
    EXPECT_EQ(engine->region(), region);
    const SurfaceMesh slid = engine->mesh().value();
    const auto fresh = extractFull(*grid, 310.5).value();
    EXPECT_GT(slid.triangleCount(), 0u);
    EXPECT_EQ(trianglesIn(slid, region, true).size(), slid.triangleCount());
    EXPECT_TRUE(includes(test::placedTriangles(slid.positions, slid.triangles), trianglesIn(fresh, region, false)));
}

} // namespace
} // namespace isoslider::extract
