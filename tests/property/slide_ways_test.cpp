// The law of the product, for all that can be slid on: both kinds of index, and a volume in memory.

#include <chrono>
#include <thread>

#include <gtest/gtest.h>

#include "core/extract/full_extraction.h"
#include "core/extract/merged/merged_extraction.h"
#include "core/extract/slide_engine.h"
#include "preprocess/build_index.h"
#include "preprocess/metacells/brick_list.h"
#include "tests/property/random_volumes.h"
#include "tests/property/slide_ways.h"
#include "tests/property/surface_comparison.h"
#include "tests/property/test_volumes.h"
#include "tests/support/result_matchers.h"
#include "tests/support/sanitizers.h"
#include "tests/support/temporary_folder.h"

namespace isoslider::extract {
namespace {

using test::allWays;
using test::IsOk;
using test::openIndex;
using test::Way;

class SlideWays : public testing::TestWithParam<int> {};

// Active edges, cells, triangles and positions are those of a fresh extraction, whatever the source.
TEST_P(SlideWays, GiveTheFreshSurfaceAtEveryStop) {
    for (std::uint64_t seed = test::testSeed(5000) + 100 * static_cast<std::uint64_t>(GetParam()), last = seed + 8;
         seed < last && !HasFatalFailure(); ++seed) {
        test::Random random(seed);
        const test::RandomVolume volume = test::randomVolume(random, 40);
        SCOPED_TRACE("seed " + std::to_string(seed) + ": " + volume.description);
        if (!volume.hasFinite)
            continue; // refused, see below
        const test::TemporaryFolder folder;
        const std::vector<Way> ways = allWays(volume.grid, folder / "");
        ASSERT_FALSE(HasFailure());
        double isovalue = volume.min;
        for (int stop = 0; stop < 12; ++stop) {
            isovalue = test::nextIsovalue(volume, isovalue, random);
            SCOPED_TRACE("stop " + std::to_string(stop) + " at " + std::to_string(isovalue));
            const auto fresh = extractFull(*volume.grid, isovalue);
            ASSERT_THAT(fresh, IsOk());
            for (const Way& way : ways) {
                SCOPED_TRACE(way.name);
                const auto moved = way.engine->slideTo(isovalue);
                ASSERT_THAT(moved, IsOk());
                const SurfaceMesh slid = way.engine->mesh().value();
                ASSERT_TRUE(test::isSameSurface(slid, fresh.value()));
                ASSERT_TRUE(test::hasExpectedNormals(slid, *volume.grid));
                EXPECT_EQ(moved.value().activeEdges, slid.activeEdgeCount());
                EXPECT_EQ(moved.value().triangles, slid.triangleCount());
            }
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Walks, SlideWays, testing::Range(0, 8));

TEST(SlideWays, HaveTheSameNormalsBitForBit) {
    const auto grid = test::hillsVolume({40, 33, 27});
    const test::TemporaryFolder folder;
    const std::vector<Way> ways = allWays(grid, folder / "");
    ASSERT_FALSE(HasFailure());
    for (const double isovalue : {300.0, 310.0, 305.5, 700.0, 120.0}) {
        std::vector<glm::vec3> normals;
        for (const Way& way : ways) {
            SCOPED_TRACE(way.name);
            ASSERT_THAT(way.engine->slideTo(isovalue), IsOk());
            const SurfaceMesh mesh = way.engine->mesh().value();
            ASSERT_TRUE(normals.empty() || mesh.normals == normals);
            normals = mesh.normals;
        }
    }
}

// One hill of the same size in cells in the corner of a box of any size.
std::shared_ptr<const ScalarGrid> hillInABox(std::int64_t side) {
    const auto valueAt = [](std::int64_t x, std::int64_t y, std::int64_t z) {
        const double dx = static_cast<double>(x) - 32.3, dy = static_cast<double>(y) - 31.8;
        const double dz = static_cast<double>(z) - 32.1;
        return 60000.0 - 60.0 * std::sqrt(dx * dx + dy * dy + dz * dz);
    };
    return test::makeVolume<std::uint16_t>(ScalarType::U16, test::cubeGeometry(side), valueAt);
}

// The same hill seen with more and more samples.
std::shared_ptr<const ScalarGrid> hillSampledFiner(std::int64_t side) {
    const auto away = [side](std::int64_t i) {
        return (static_cast<double>(i) + 0.5) / static_cast<double>(side) - 0.501;
    };
    const auto valueAt = [away](std::int64_t x, std::int64_t y, std::int64_t z) {
        return 60000.0 - 50000.0 * std::sqrt(away(x) * away(x) + away(y) * away(y) + away(z) * away(z));
    };
    return test::makeVolume<std::uint16_t>(ScalarType::U16, test::cubeGeometry(side), valueAt);
}

struct Cost {
    double bricks, chunks, edges;
};

Cost costOfAStep(const std::shared_ptr<const ScalarGrid>& grid, double from, double to) {
    const test::TemporaryFolder folder;
    const auto engine =
        openIndex(grid, folder / "m.isx", index::IndexKind::Metacells, 0); // nothing is kept: all is counted
    EXPECT_THAT(engine->slideTo(from), IsOk());
    const auto moved = engine->slideTo(to);
    EXPECT_THAT(moved, IsOk());
    const SlideStats& stats = moved.value();
    return {static_cast<double>(stats.bricksRead), static_cast<double>(stats.chunksRead),
            static_cast<double>(stats.edgesAdded + stats.edgesRemoved)};
}

TEST(SlideWays, ReadBricksInProportionToTheChangeNotToTheBox) {
    const Cost small = costOfAStep(hillInABox(64), 58800.0, 58790.0);
    EXPECT_GT(small.edges, 0.0);
    for (const std::int64_t side : {128, 256}) {
        const Cost large = costOfAStep(hillInABox(side), 58800.0, 58790.0);
        EXPECT_EQ(large.bricks, small.bricks) << side;
        EXPECT_EQ(large.edges, small.edges) << side;
        EXPECT_LE(large.chunks, 1.2 * small.chunks)
            << side << ": the batches of a cache of eight chunks fall otherwise";
    }
}

#if !ISO_HAS_SANITIZER
constexpr std::int64_t kFinest = 512;
#else
constexpr std::int64_t kFinest = 128; // the law, at a size that instrumented code can bear
#endif

TEST(SlideWays, ReadBricksInProportionToTheSurfaceNotToTheVolume) {
    const Cost coarse = costOfAStep(hillSampledFiner(64), 45000.0, 44700.0);
    // The same way in cells: bricks that arrive are read, and those that stay only where edges come.
    const double sides = static_cast<double>(kFinest) / 64.0;
    const Cost fine = costOfAStep(hillSampledFiner(kFinest), 45000.0, 45000.0 - 300.0 / sides);
    EXPECT_GT(fine.bricks, coarse.bricks);
    EXPECT_LT(fine.bricks, 1.3 * sides * sides * coarse.bricks) << "not its third power";
    EXPECT_LT(fine.chunks, 1.5 * sides * sides * coarse.chunks);
}

// What is read while nobody waits need not be read in the next move.
TEST(SlideWays, ReadAheadInTheDirectionOfMotion) {
    const test::TemporaryFolder folder;
    const auto grid = hillSampledFiner(128);
    std::array<std::uint64_t, 2> inMoves{}, ahead{};
    for (const bool readsAhead : {false, true}) {
        const auto path = folder / "m.isx";
        ASSERT_NE(openIndex(grid, path, index::IndexKind::Metacells), nullptr);
        SlideOptions options;
        options.readsAhead = readsAhead;
        const auto engine = SlideEngine::open(path, options);
        ASSERT_THAT(engine, IsOk());
        for (int step = 0; step <= 24; ++step) {
            const auto moved = engine.value()->slideTo(55000.0 - 800.0 * step);
            ASSERT_THAT(moved, IsOk());
            engine.value()->waitForPrefetch();
            if (step < 2)
                continue; // there is no direction yet
            inMoves[readsAhead] += moved.value().bytesRead;
            ahead[readsAhead] += moved.value().bytesAhead;
        }
    }
    EXPECT_EQ(ahead[0], 0u);
    EXPECT_GT(ahead[1], 0u);
    EXPECT_LT(10 * inMoves[1], inMoves[0]) << "nearly all has been foreseen";
}

// A move that is broken off while samples are read leaves a cache that still reports the truth.
TEST(SlideWays, SurviveBeingStoppedAnywhere) {
    const test::TemporaryFolder folder;
    const auto grid = hillSampledFiner(64);
    const auto engine = openIndex(grid, folder / "m.isx", index::IndexKind::Metacells, std::uint64_t{2} << 20);
    ASSERT_NE(engine, nullptr);
    int stopped = 0;
    MergeBound bound;
    for (int round = 0; round < 90; ++round) {
        const double isovalue = 30000.0 + 300.0 * (round * 37 % 60);
        if (round % 9 == 8) {
            bound = {MergeBound::Measure::Distance, 0.1 * (round / 9 % 3)};
            engine->setMergeBound(bound);
        }
        std::stop_source stop;
        std::jthread stopper([&] {
            std::this_thread::sleep_for(std::chrono::microseconds(40 * (round % 60)));
            stop.request_stop();
        });
        if (round % 10 == 0) // at least these are, however busy the machine
            stop.request_stop();
        const auto moved = engine->slideTo(isovalue, {stop.get_token(), {}});
        stopper.join();
        if (!moved.isOk()) {
            ASSERT_TRUE(moved.isCancelled());
            ++stopped;
        }
        if (round % 5 == 4 && !moved.isOk()) {
            ASSERT_THAT(engine->slideTo(isovalue), IsOk());
        }
        if (moved.isOk() || round % 5 == 4) {
            const auto fresh = bound.limit > 0.0 ? extractMerged(*grid, isovalue, bound, kMaxBrickMergeLevel)
                                                 : extractFull(*grid, isovalue);
            ASSERT_TRUE(test::isSameSurface(engine->mesh().value(), fresh.value())) << "round " << round;
        }
    }
    EXPECT_GT(stopped, 0);
}

// More surface than cache: the memory stays within its bound, and what the last move left is used.
TEST(SlideWays, AreBoundedByTheCache) {
    const test::TemporaryFolder folder;
    const auto grid = hillSampledFiner(128);
    std::vector<std::uint64_t> chunks;
    for (const std::uint64_t cacheBytes :
         {std::uint64_t{0}, std::uint64_t{1} << 20, std::uint64_t{2} << 20, std::uint64_t{16} << 20}) {
        const auto engine = openIndex(grid, folder / "m.isx", index::IndexKind::Metacells, cacheBytes);
        ASSERT_NE(engine, nullptr);
        std::uint64_t read = 0;
        for (int step = 0; step < 12; ++step) {
            // Far enough for bricks to come and go: those that stay keep their samples.
            const auto moved = engine->slideTo(45000.0 + (step % 2 ? 2500.0 : 0.0));
            ASSERT_THAT(moved, IsOk());
            engine->waitForPrefetch();
            if (step > 1)
                read += moved.value().chunksRead;
        }
        chunks.push_back(read);
    }
    EXPECT_GT(chunks[0], chunks[1]);
    EXPECT_GT(chunks[1], chunks[2]);
    EXPECT_EQ(chunks[3], 0u) << "all in the cache";
}

// Forgetting costs reading, nothing else.
TEST(SlideWays, ReadAnewWhatTheyForgot) {
    const test::TemporaryFolder folder;
    const auto grid = hillSampledFiner(64);
    const std::vector<Way> ways = allWays(grid, folder / "");
    ASSERT_FALSE(HasFailure());
    for (const Way& way : ways) {
        SCOPED_TRACE(way.name);
        std::uint64_t kept = 0, forgotten = 0;
        for (int step = 0; step < 12; ++step) { // to and fro, forgetting in the second half
            const double isovalue = 45000.0 + (step % 2 ? 100.0 : 0.0);
            const auto moved = way.engine->slideTo(isovalue);
            ASSERT_THAT(moved, IsOk());
            way.engine->waitForPrefetch();
            if (step == 5 || step == 11) {
                ASSERT_TRUE(test::isSameSurface(way.engine->mesh().value(), extractFull(*grid, isovalue).value()));
            }
            if (step >= 2)
                (step < 6 ? kept : forgotten) += moved.value().bytesRead;
            if (step >= 5)
                way.engine->dropCaches();
        }
        EXPECT_GE(forgotten, kept);
        if (way.name == "edges" || way.name == "metacells, cache of all") {
            EXPECT_EQ(kept, 0u);
            EXPECT_GT(forgotten, 0u);
        }
    }
}

TEST(SlideWays, DoNotReadBricksThatAreOnOneSideAtBothEnds) {
    const test::TemporaryFolder folder;
    const auto grid =
        test::makeVolume<float>(ScalarType::F32, test::cubeGeometry(64),
                                [](std::int64_t x, std::int64_t, std::int64_t) { return static_cast<float>(x); });
    const auto inMemory = preprocess::makeMemoryEngine(grid);
    ASSERT_THAT(inMemory, IsOk());
    const auto stored = openIndex(grid, folder / "m.isx", index::IndexKind::Metacells, 0);
    ASSERT_NE(stored, nullptr);
    for (SlideEngine* engine : {inMemory.value().get(), stored.get()}) {
        ASSERT_THAT(engine->slideTo(4.5), IsOk());
        const auto moved = engine->slideTo(52.5); // over 40 planes of bricks that flip whole
        ASSERT_THAT(moved, IsOk());
        EXPECT_EQ(moved.value().bricksRead, 64u)
            << "those that the surface enters; those that it leaves are not looked into";
    }
}

TEST(SlideWays, KnowVolumesOfFewSamples) {
    for (const GridDims& dims : {GridDims{1, 1, 1}, GridDims{9, 1, 9}, GridDims{2, 2, 2}, GridDims{17, 9, 2},
                                 GridDims{8, 8, 8}, GridDims{2, 40, 33}, GridDims{16, 17, 1}}) {
        const test::TemporaryFolder folder;
        const auto grid = test::noiseVolume(dims, 3);
        const std::vector<Way> ways = allWays(grid, folder / "");
        ASSERT_FALSE(HasFailure());
        for (const double isovalue : {0.0, 7.0, 12.0, 30.0}) {
            const auto fresh = extractFull(*grid, isovalue);
            ASSERT_THAT(fresh, IsOk());
            for (const Way& way : ways) {
                SCOPED_TRACE(way.name);
                ASSERT_THAT(way.engine->slideTo(isovalue), IsOk());
                EXPECT_TRUE(test::isSameSurface(way.engine->mesh().value(), fresh.value()));
            }
        }
    }
}

} // namespace
} // namespace isoslider::extract
