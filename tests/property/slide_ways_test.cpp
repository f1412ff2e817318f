// The law of the product without an index: sliding on a volume in memory gives the fresh surface, and the
// surface of the index of edge blocks.

#include <gtest/gtest.h>

#include "core/extract/full_extraction.h"
#include "core/extract/slide_engine.h"
#include "preprocess/brick_list.h"
#include "preprocess/build_index.h"
#include "tests/property/random_volumes.h"
#include "tests/property/surface_comparison.h"
#include "tests/property/test_volumes.h"
#include "tests/support/result_matchers.h"
#include "tests/support/temporary_folder.h"

namespace isoslider::extract {
namespace {

using test::IsOk;

// The ways to slide: each has a source of its own, all feed the same surface.
struct Way {
    std::string name;
    std::unique_ptr<SlideEngine> engine;
};

std::unique_ptr<SlideEngine> openIndex(const std::shared_ptr<const ScalarGrid>& grid, const std::filesystem::path& path,
                                       index::IndexKind kind, std::uint64_t cacheBytes = SlideOptions{}.cacheBytes) {
    preprocess::BuildOptions build;
    build.kind = kind;
    if (!std::filesystem::exists(path)) {
        EXPECT_THAT(test::buildIndexOf(grid, path, build), IsOk());
    }
    SlideOptions options;
    options.cacheBytes = cacheBytes;
    auto opened = SlideEngine::open(path, options);
    EXPECT_THAT(opened, IsOk());
    return opened.isOk() ? std::move(opened).value() : nullptr;
}

constexpr std::uint64_t kChunkBytes = 16 * 16 * 16 * 8; // of doubles

std::vector<Way> allWays(const std::shared_ptr<const ScalarGrid>& grid, const std::filesystem::path& folder) {
    std::vector<Way> ways;
    auto inMemory = preprocess::makeMemoryEngine(grid);
    EXPECT_THAT(inMemory, IsOk());
    if (!inMemory.isOk())
        return ways;
    ways.push_back({"in memory", std::move(inMemory).value()});
    ways.push_back({"edges", openIndex(grid, folder / "e.isx", index::IndexKind::Edges)});
    const auto metacells = folder / "m.isx";
    ways.push_back({"metacells, cache of one brick", openIndex(grid, metacells, index::IndexKind::Metacells, 0)});
    ways.push_back({"metacells, cache of eight bricks", openIndex(grid, metacells, index::IndexKind::Metacells, 9 * kChunkBytes)});
    ways.push_back({"metacells, cache of all", openIndex(grid, metacells, index::IndexKind::Metacells)});
    return ways;
}

class SlideWays : public testing::TestWithParam<int> {};

// Active edges, cells, triangles and positions are those of a fresh extraction, whatever the source.
TEST_P(SlideWays, GiveTheFreshSurfaceAtEveryStop) {
    for (std::uint64_t seed = test::testSeed(5000) + 100 * static_cast<std::uint64_t>(GetParam()), last = seed + 8; seed < last && !HasFatalFailure(); ++seed) {
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
                const SurfaceMesh slid = way.engine->mesh();
                ASSERT_TRUE(test::isSameSurface(slid, fresh.value()));
                ASSERT_TRUE(test::hasExpectedNormals(slid, *volume.grid));
                EXPECT_EQ(moved.value().activeEdges, slid.edgeIds.size());
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
            const SurfaceMesh mesh = way.engine->mesh();
            ASSERT_TRUE(normals.empty() || mesh.normals == normals);
            normals = mesh.normals;
        }
    }
}

TEST(MemorySlide, ReadsBricksInProportionToTheChange) {
    std::vector<std::uint64_t> bricks;
    for (const std::int64_t side : {64, 128}) {
        GridGeometry geometry = test::cubeGeometry(side);
        const auto grid = test::makeVolume<float>(ScalarType::F32, geometry, [&](std::int64_t x, std::int64_t y, std::int64_t z) {
            // One hill of the same size in cells, whatever the box.
            const double dx = static_cast<double>(x) - 32.3, dy = static_cast<double>(y) - 31.8, dz = static_cast<double>(z) - 32.1;
            return -std::sqrt(dx * dx + dy * dy + dz * dz);
        });
        const auto engine = preprocess::makeMemoryEngine(grid);
        ASSERT_THAT(engine, IsOk());
        ASSERT_THAT(engine.value()->slideTo(-20.0), IsOk());
        const auto moved = engine.value()->slideTo(-20.01);
        ASSERT_THAT(moved, IsOk());
        bricks.push_back(moved.value().bricksRead);
        EXPECT_GT(moved.value().edgesAdded, 0u);
    }
    EXPECT_EQ(bricks[0], bricks[1]);
}

TEST(MemorySlide, DoesNotReadBricksThatAreOnOneSideAtBothEnds) {
    const auto grid = test::makeVolume<float>(ScalarType::F32, test::cubeGeometry(64), [](std::int64_t x, std::int64_t, std::int64_t) { return static_cast<float>(x); });
    const auto engine = preprocess::makeMemoryEngine(grid);
    ASSERT_THAT(engine, IsOk());
    ASSERT_THAT(engine.value()->slideTo(4.5), IsOk());
    const auto moved = engine.value()->slideTo(52.5); // over 40 planes of bricks that flip whole
    ASSERT_THAT(moved, IsOk());
    EXPECT_EQ(moved.value().bricksRead, 64u) << "those that the surface enters; those that it leaves are not looked into";
}

TEST(MemorySlide, KnowsVolumesWithoutCells) {
    for (const GridDims& dims : {GridDims{1, 1, 1}, GridDims{9, 1, 9}, GridDims{2, 2, 2}, GridDims{17, 9, 2}}) {
        const auto grid = test::noiseVolume(dims, 3);
        const auto engine = preprocess::makeMemoryEngine(grid);
        ASSERT_THAT(engine, IsOk());
        for (const double isovalue : {0.0, 7.0, 12.0, 30.0}) {
            ASSERT_THAT(engine.value()->slideTo(isovalue), IsOk());
            const auto fresh = extractFull(*grid, isovalue);
            ASSERT_THAT(fresh, IsOk());
            EXPECT_TRUE(test::isSameSurface(engine.value()->mesh(), fresh.value()));
        }
    }
}

} // namespace
} // namespace isoslider::extract
