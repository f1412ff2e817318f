// The law of the product: sliding from a to b gives what extracting b afresh gives.

#include <optional>

#include <gtest/gtest.h>

#include "core/extract/full_extraction.h"
#include "core/extract/live/brick_picture.h"
#include "core/extract/slide_engine.h"
#include "tests/property/random_volumes.h"
#include "tests/property/surface_comparison.h"
#include "tests/support/result_matchers.h"
#include "tests/support/temporary_folder.h"

namespace isoslider::extract {
namespace {

using test::IsOk;
using test::Random;
using test::RandomVolume;

constexpr std::int64_t kLongest = 40;

// An engine on its own index, and the surface it showed last.
class Walker {
public:
    Walker(const RandomVolume& volume, const std::filesystem::path& path, const preprocess::BuildOptions& options,
           std::uint64_t cacheBytes)
        : volume_(volume) {
        EXPECT_THAT(test::buildIndexOf(volume.grid, path, options), IsOk());
        auto engine = SlideEngine::open(path, {cacheBytes});
        EXPECT_THAT(engine, IsOk());
        if (engine.isOk())
            engine_ = std::move(engine).value();
    }

    bool isOpen() const { return engine_ != nullptr; }

    void goTo(double isovalue, const SurfaceMesh& fresh) {
        const auto moved = engine_->slideTo(isovalue);
        ASSERT_THAT(moved, IsOk());
        const SlideStats& stats = moved.value();
        const SurfaceMesh slid = engine_->mesh().value();
        ASSERT_TRUE(test::isSameSurface(slid, fresh));
        expectOldFrame();
        ASSERT_TRUE(test::hasExpectedNormals(slid, *volume_.grid));
        EXPECT_EQ(slid.isovalue, isovalue);
        EXPECT_EQ(stats.isovalue, isovalue);
        expectCounts(stats, slid);
        expectFrame(stats, slid);
        edges_ = test::distinctEdges(slid);
    }

private:
    void expectCounts(const SlideStats& stats, const SurfaceMesh& slid) const {
        EXPECT_EQ(stats.activeEdges, slid.activeEdgeCount());
        EXPECT_EQ(stats.triangles, slid.triangleCount());
        if (stats.hasRebuilt) {
            EXPECT_EQ(stats.edgesRemoved, edges_.size());
            EXPECT_EQ(stats.edgesAdded, slid.activeEdgeCount());
        } else { // net changes, to the edge
            const std::vector<EdgeId> edges = test::distinctEdges(slid);
            std::vector<EdgeId> added, removed;
            std::set_difference(edges.begin(), edges.end(), edges_.begin(), edges_.end(), std::back_inserter(added));
            std::set_difference(edges_.begin(), edges_.end(), edges.begin(), edges.end(), std::back_inserter(removed));
            EXPECT_EQ(stats.edgesAdded, added.size());
            EXPECT_EQ(stats.edgesRemoved, removed.size());
            EXPECT_TRUE(stats.cellsRetriangulated > 0 || (added.empty() && removed.empty()));
        }
        std::uint64_t walked = 0;
        for (const WalkStep& step : stats.walk)
            walked += step.edges;
        EXPECT_EQ(walked, stats.edgesTouched);
    }

    // The window draws the frame before while the surface moves on: nothing of it may have changed.
    void expectOldFrame() const {
        if (!before_)
            return;
        SurfaceFrame frame = *before_;
        expandPicture(frame);
        ASSERT_EQ(test::placedTriangles(frame.positions, frame.indices), shownBefore_);
    }

    void expectFrame(const SlideStats& stats, const SurfaceMesh& slid) {
        SurfaceFrame frame;
        engine_->copyFrame(frame, {.changes = true});
        before_ = frame;
        expandPicture(frame);
        EXPECT_EQ(frame.isovalue, slid.isovalue);
        EXPECT_TRUE(frame.isFromIndex);
        EXPECT_EQ(frame.geometry, volume_.grid->geometry());
        ASSERT_EQ(frame.indices.size() % 3, 0u);
        ASSERT_EQ(frame.normals.size(), frame.positions.size());
        for (const std::uint32_t index : frame.indices)
            ASSERT_TRUE(index < frame.positions.size() || index == 0);
        const auto shown = test::placedTriangles(frame.positions, frame.indices);
        ASSERT_EQ(shown, test::placedTriangles(slid.positions, slid.triangles));
        shownBefore_ = shown;

        // What is highlighted is on the surface, and every triangle at a new edge is highlighted.
        const auto highlighted = test::placedTriangles(frame.positions, frame.changedIndices);
        EXPECT_EQ(highlighted.size() * 3, frame.changedIndices.size());
        EXPECT_TRUE(std::includes(shown.begin(), shown.end(), highlighted.begin(), highlighted.end()));
        if (stats.hasRebuilt)
            return;
        std::vector<std::uint32_t> mustBeMarked;
        for (std::size_t i = 0; i < slid.triangles.size(); i += 3) {
            const auto isNew = [&](std::size_t k) {
                const std::uint32_t vertex = slid.triangles[i + k];
                return vertex < slid.edgeIds.size() &&
                       !std::binary_search(edges_.begin(), edges_.end(), slid.edgeIds[vertex]);
            };
            if (isNew(0) || isNew(1) || isNew(2))
                mustBeMarked.insert(mustBeMarked.end(), slid.triangles.begin() + static_cast<std::ptrdiff_t>(i),
                                    slid.triangles.begin() + static_cast<std::ptrdiff_t>(i + 3));
        }
        const auto expected = test::placedTriangles(slid.positions, mustBeMarked);
        EXPECT_TRUE(std::includes(highlighted.begin(), highlighted.end(), expected.begin(), expected.end()));
    }

    const RandomVolume& volume_;
    std::unique_ptr<SlideEngine> engine_;
    std::vector<EdgeId> edges_;
    std::optional<SurfaceFrame> before_;
    std::vector<test::PlacedTriangle> shownBefore_;
};

// One volume, three ways through it: its own skip levels, one level only, nearly no cache.
void walkOneVolume(std::uint64_t seed, std::int64_t longest, int stops) {
    Random random(seed);
    const RandomVolume volume = test::randomVolume(random, longest);
    preprocess::BuildOptions options;
    options.skipLevels = static_cast<int>(test::intRandom(random, 1, 8));
    options.redundancyThreshold = std::exp(6.0 * test::unitRandom(random) - 4.0);
    SCOPED_TRACE("seed " + std::to_string(seed) + ": " + volume.description + ", " +
                 std::to_string(options.skipLevels) +
                 " skip levels, k = " + std::to_string(options.redundancyThreshold));
    const test::TemporaryFolder folder;
    if (!volume.hasFinite) {
        EXPECT_THAT(test::buildIndexOf(volume.grid, folder / "a.isx"), test::HasError(ErrorCode::InvalidArgument));
        return;
    }
    preprocess::BuildOptions oneLevel;
    oneLevel.skipLevels = 1;
    Walker leveled(volume, folder / "leveled.isx", options, std::uint64_t{64} << 20);
    Walker plain(volume, folder / "plain.isx", oneLevel, std::uint64_t{64} << 20);
    Walker uncached(volume, folder / "uncached.isx", options, 1);
    ASSERT_TRUE(leveled.isOpen() && plain.isOpen() && uncached.isOpen());
    double isovalue = volume.min;
    for (int stop = 0; stop < stops && !testing::Test::HasFatalFailure(); ++stop) {
        isovalue = test::nextIsovalue(volume, isovalue, random);
        std::ostringstream where;
        where.precision(17);
        where << "stop " << stop << " at isovalue " << isovalue;
        SCOPED_TRACE(where.str());
        const auto fresh = extractFull(*volume.grid, isovalue);
        ASSERT_THAT(fresh, IsOk());
        leveled.goTo(isovalue, fresh.value());
        plain.goTo(isovalue, fresh.value());
        if (stop % 3 == 0) // so that this one takes longer steps
            uncached.goTo(isovalue, fresh.value());
    }
}

class SlideLaw : public testing::TestWithParam<int> {};

TEST_P(SlideLaw, SlidingGivesTheFreshSurface) {
    const std::uint64_t base = test::testSeed(20260) + static_cast<std::uint64_t>(GetParam()) * 1000;
    RecordProperty("seed", std::to_string(base));
    for (std::uint64_t i = 0; i < 30 && !HasFailure(); ++i)
        walkOneVolume(base + i, 20, 10);
}

INSTANTIATE_TEST_SUITE_P(Walks, SlideLaw, testing::Range(0, 8));

TEST(SlideWalk, HoldsOnLargerVolumes) {
    const std::uint64_t base = test::testSeed(977);
    RecordProperty("seed", std::to_string(base));
    for (std::uint64_t i = 0; i < 10 && !HasFailure(); ++i)
        walkOneVolume(base + i, kLongest, 8);
}

// Every gap of a volume with few values, crossed in every possible step, both ways.
TEST(SlideWalk, HoldsBetweenEveryPairOfValues) {
    RandomVolume volume;
    volume.grid = test::noiseVolume({11, 9, 10}, 3, 9);
    preprocess::BuildOptions options;
    options.redundancyThreshold = 0.3;
    const test::TemporaryFolder folder;
    Walker walker(volume, folder / "a.isx", options, std::uint64_t{1} << 20);
    ASSERT_TRUE(walker.isOpen());
    std::vector<SurfaceMesh> fresh;
    for (int value = 0; value < 10; ++value)
        fresh.push_back(extractFull(*volume.grid, value).value());
    for (int from = 0; from < 10; ++from)
        for (int to = 0; to < 10; ++to) {
            SCOPED_TRACE(std::to_string(from) + " to " + std::to_string(to));
            walker.goTo(from, fresh[static_cast<std::size_t>(from)]);
            walker.goTo(to, fresh[static_cast<std::size_t>(to)]);
            ASSERT_FALSE(HasFailure());
        }
}

} // namespace
} // namespace isoslider::extract
