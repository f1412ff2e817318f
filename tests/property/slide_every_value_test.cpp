// Every isovalue that samples have, one after the other, up and down: what a brick's border does to its neighbours,
// which random walks meet by chance only.

#include <cmath>
#include <random>
#include <set>

#include <gtest/gtest.h>

#include "core/extract/full_extraction.h"
#include "core/mesh/certificate.h"
#include "tests/property/slide_ways.h"
#include "tests/property/surface_comparison.h"
#include "tests/property/test_volumes.h"
#include "tests/support/result_matchers.h"
#include "tests/support/temporary_folder.h"

namespace isoslider::extract {
namespace {

using test::IsOk;

struct NamedVolume {
    const char* name;
    std::shared_ptr<const ScalarGrid> grid;
};

template <class Sample>
std::shared_ptr<const ScalarGrid> waves(ScalarType type, const GridDims& dims, double scale) {
    GridGeometry geometry;
    geometry.dims = dims;
    return test::makeVolume<Sample>(type, geometry, [&](std::int64_t x, std::int64_t y, std::int64_t z) {
        const auto wave = [](std::int64_t i, double period) {
            return std::sin(6.2831853 * static_cast<double>(i) / period);
        };
        return std::floor(scale * (3.0 + wave(x, 11.3) + wave(y, 9.1) * wave(z, 13.7) + wave(x + y + z, 17.9)));
    });
}

// Noise with a sixth of its samples missing, alone and in a block across bricks.
std::shared_ptr<const ScalarGrid> noiseWithHoles(const GridDims& dims, unsigned seed) {
    GridGeometry geometry;
    geometry.dims = dims;
    std::mt19937 random(seed);
    return test::makeVolume<float>(ScalarType::F32, geometry, [&](std::int64_t x, std::int64_t y, std::int64_t z) {
        const bool isInBlock = x > 5 && x < 11 && y > 6 && y < 10 && z > 5 && z < 9;
        const unsigned value = random() % 60;
        return isInBlock || random() % 6 == 0 ? std::numeric_limits<float>::quiet_NaN() : static_cast<float>(value);
    });
}

std::vector<double> valuesOf(const ScalarGrid& grid) {
    std::set<double> values;
    grid.visit([&](auto samples) {
        for (const auto sample : samples)
            if (std::isfinite(static_cast<double>(sample)))
                values.insert(static_cast<double>(sample));
    });
    return {values.begin(), values.end()};
}

void stepThroughEveryValue(const NamedVolume& volume) {
    SCOPED_TRACE(volume.name);
    const test::TemporaryFolder folder;
    std::vector<test::Way> ways = test::allWays(volume.grid, folder / "");
    ASSERT_FALSE(testing::Test::HasFailure());
    const std::vector<double> values = valuesOf(*volume.grid);
    const auto visit = [&](double isovalue) {
        SCOPED_TRACE("at " + std::to_string(isovalue));
        const auto fresh = extractFull(*volume.grid, isovalue);
        ASSERT_THAT(fresh, IsOk());
        for (const test::Way& way : ways) {
            SCOPED_TRACE(way.name);
            ASSERT_THAT(way.engine->slideTo(isovalue), IsOk());
            ASSERT_TRUE(test::isSameSurface(way.engine->mesh().value(), fresh.value()));
        }
    };
    for (std::size_t i = 0; i < values.size() && !testing::Test::HasFatalFailure(); ++i)
        visit(values[i]);
    for (std::size_t i = values.size(); i-- > 0 && !testing::Test::HasFatalFailure();)
        visit(values[i]);
}

TEST(SlideEveryValue, OfNoiseInBricksWithOneMorePoint) {
    stepThroughEveryValue({"noise 17^3", test::noiseVolume({17, 17, 17}, 7, 120)});
}
TEST(SlideEveryValue, OfNoiseInUnevenBricks) {
    stepThroughEveryValue({"noise 25 x 18 x 33", test::noiseVolume({25, 18, 33}, 8, 24)});
}
TEST(SlideEveryValue, OfSmoothIntegers) {
    stepThroughEveryValue({"waves u16 33^3", waves<std::uint16_t>(ScalarType::U16, {33, 33, 33}, 14.0)});
}
TEST(SlideEveryValue, OfSmoothReals) {
    stepThroughEveryValue({"waves f32 17 x 33 x 24", waves<float>(ScalarType::F32, {17, 33, 24}, 20.0)});
}
TEST(SlideEveryValue, OfSmoothDoubles) {
    stepThroughEveryValue({"waves f64 18^3", waves<double>(ScalarType::F64, {18, 18, 18}, 20.0)});
}
TEST(SlideEveryValue, OfNoiseWithMissingValues) {
    stepThroughEveryValue({"noise with holes 18 x 17 x 20", noiseWithHoles({18, 17, 20}, 9)});
}

// An oriented 2-manifold at every value, open only at the box and at what is missing.
TEST(SlideEveryValue, IsAManifoldBesideMissingValues) {
    const auto grid = noiseWithHoles({18, 17, 20}, 9);
    std::size_t split = 0;
    for (const double isovalue : valuesOf(*grid)) {
        const auto surface = extractFull(*grid, isovalue);
        ASSERT_THAT(surface, IsOk());
        split += surface.value().edgeIds.size() - surface.value().activeEdgeCount();
        const auto certificate = mesh::certify(surface.value(), {"noise", {}, ""});
        ASSERT_TRUE(mesh::isValid(certificate)) << mesh::faultsOf(certificate).front() << " at " << isovalue;
    }
    EXPECT_GT(split, 100u) << "or this volume tests nothing";
}

} // namespace
} // namespace isoslider::extract
