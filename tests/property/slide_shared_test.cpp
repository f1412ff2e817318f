// The law of the product on real volumes, where the folder with further test data is there.

#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/extract/full_extraction.h"
#include "core/extract/slide_engine.h"
#include "core/mesh/certificate.h"
#include "core/volume_io/volume_reader.h"
#include "tests/property/slide_ways.h"
#include "tests/property/surface_comparison.h"
#include "tests/support/result_matchers.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_paths.h"

namespace isoslider::extract {
namespace {

using test::IsOk;

// A real volume, and what can be slid on it.
class SharedVolume : public testing::TestWithParam<const char*> {
protected:
    void SetUp() override {
        const auto path = std::filesystem::path(test::sharedFolder()) / "data" / GetParam();
        if (!std::filesystem::exists(path))
            GTEST_SKIP() << "further test data is not here: " << path;
        auto read = io::readVolume(path);
        ASSERT_THAT(read, IsOk());
        grid_ = std::move(read).value();
        ways_ = test::allWays(grid_, folder_ / "");
        ASSERT_FALSE(HasFailure());
    }

    test::TemporaryFolder folder_;
    std::shared_ptr<const ScalarGrid> grid_;
    std::vector<test::Way> ways_;
};

class SharedSlide : public SharedVolume {};

TEST_P(SharedSlide, SlidingGivesTheFreshSurface) {
    // A jump, a slide of a hundredth, of a thousandth, back, a sample value, and through everything.
    const index::IndexInfo& info = ways_.front().engine->info();
    const double min = info.min, range = info.max - min;
    std::mt19937 random(11);
    const double middle = min + range * std::uniform_real_distribution<double>(0.3, 0.7)(random);
    const double sample = grid_->valueAt(grid_->dims()[0] / 2, grid_->dims()[1] / 2, grid_->dims()[2] / 2);
    for (const double isovalue :
         {middle, middle + 0.01 * range, middle + 0.009 * range, middle - 0.2 * range, sample, min + 0.97 * range}) {
        SCOPED_TRACE(isovalue);
        const auto fresh = extractFull(*grid_, isovalue);
        ASSERT_THAT(fresh, IsOk());
        for (const test::Way& way : ways_) {
            SCOPED_TRACE(way.name);
            const auto moved = way.engine->slideTo(isovalue);
            ASSERT_THAT(moved, IsOk());
            const SurfaceMesh slid = way.engine->mesh().value();
            ASSERT_TRUE(test::isSameSurface(slid, fresh.value()));
            ASSERT_TRUE(test::hasExpectedNormals(slid, *grid_));
            EXPECT_EQ(moved.value().activeEdges, slid.activeEdgeCount());
            EXPECT_EQ(moved.value().triangles, slid.triangleCount());
        }
    }
}

// Every isovalue of an 8-bit volume is a sample's: the worst case for ties. Slid upwards through all, each
// surface certified, some compared with a fresh one; then down again in strides.
class SharedBytes : public SharedVolume {};

TEST_P(SharedBytes, EveryIsovalueHasAValidSurface) {
    ASSERT_EQ(grid_->type(), ScalarType::U8);
    SlideEngine& engine = *ways_[1].engine;
    for (int isovalue = 0; isovalue < 256; ++isovalue) {
        SCOPED_TRACE(isovalue);
        ASSERT_THAT(engine.slideTo(isovalue), IsOk());
        const SurfaceMesh slid = engine.mesh().value();
        const mesh::Certificate certificate = mesh::certify(slid, {GetParam(), 0});
        ASSERT_THAT(mesh::faultsOf(certificate), testing::IsEmpty());
        ASSERT_EQ(certificate.report.degenerateTriangles, 0u);
        if (isovalue % 16 == 0) {
            const auto fresh = extractFull(*grid_, isovalue);
            ASSERT_THAT(fresh, IsOk());
            ASSERT_TRUE(test::isSameSurface(slid, fresh.value()));
        }
    }
    for (int isovalue = 255; isovalue >= 0; isovalue -= 17) {
        SCOPED_TRACE(isovalue);
        ASSERT_THAT(engine.slideTo(isovalue), IsOk());
        const auto fresh = extractFull(*grid_, isovalue);
        ASSERT_THAT(fresh, IsOk());
        ASSERT_TRUE(test::isSameSurface(engine.mesh().value(), fresh.value()));
    }
}

INSTANTIATE_TEST_SUITE_P(Volumes, SharedBytes,
                         testing::Values("mha/fuel.mha", "mha/hydrogenAtom.mha", "mha/marschnerlobb.mha",
                                         "mha/neghip.mha", "mha/nucleon.mha", "mha/silicium.mha"));

INSTANTIATE_TEST_SUITE_P(Volumes, SharedSlide,
                         testing::Values("mhd/cranium.mhd", "mha/fuel.mha", "mha/hydrogenAtom.mha",
                                         "mha/marschnerlobb.mha", "mha/neghip.mha", "mha/nucleon.mha",
                                         "mha/silicium.mha"));

} // namespace
} // namespace isoslider::extract
