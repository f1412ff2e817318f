#include "core/volume_io/sources/sample_volumes.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "core/volume_io/resampling/curvilinear_resampler.h"
#include "core/volume_io/volume_reader.h"
#include "core/volume_io/volume_writer.h"
#include "tests/support/faulty_file_system.h"
#include "tests/support/result_matchers.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_paths.h"

namespace isoslider::io {
namespace {

const std::filesystem::path kResources = std::filesystem::path(test::sourceFolder()) / "resources";

TEST(SphericalShell, IsTheDistanceFromASphere) {
    const auto grid = makeSphericalShell({64, 64, 64});
    ASSERT_THAT(grid, test::IsOk());
    ASSERT_EQ(grid.value().type(), ScalarType::U16);
    const double radius = 79.1 * 64 / 256, top = std::sqrt(3.0) * 32 - radius;
    EXPECT_EQ(grid.value().valueAt(0, 0, 0), 65535); // the farthest corner
    EXPECT_EQ(grid.value().valueAt(32, 32, 32), std::lround(65535 * radius / top));
    EXPECT_EQ(grid.value().valueAt(32 + 20, 32, 32), std::lround(65535 * (20 - radius) / top));
    EXPECT_EQ(grid.value().valueAt(10, 20, 30), grid.value().valueAt(54, 44, 34));
}

TEST(SphericalShell, TakesAnyDims) {
    for (const GridDims dims : {GridDims{1, 1, 1}, {2, 2, 2}, {10, 20, 30}}) {
        const auto grid = makeSphericalShell(dims);
        ASSERT_THAT(grid, test::IsOk());
        EXPECT_EQ(grid.value().dims(), dims);
    }
    EXPECT_THAT(makeSphericalShell({-1, 2, 2}), test::HasError(ErrorCode::InvalidArgument));
}

class SampleVolumes : public testing::Test {
protected:
    SampleVolumes() { ::setenv("XDG_CACHE_HOME", cache.path().c_str(), 1); }
    ~SampleVolumes() override { ::unsetenv("XDG_CACHE_HOME"); }
    test::TemporaryFolder cache;
};

TEST_F(SampleVolumes, AllLoad) {
    ASSERT_EQ(sampleVolumes().size(), 2u);
    for (const SampleVolume& sample : sampleVolumes()) {
        const auto grid = loadSample(sample.name, {24, 16, 20}, kResources);
        ASSERT_THAT(grid, test::IsOk());
        EXPECT_EQ(grid.value()->dims(), (GridDims{24, 16, 20}));
    }
    EXPECT_THAT(loadSample("nothing", {}, kResources), test::HasError(ErrorCode::InvalidArgument));
    EXPECT_THAT(loadSample("bluntfin", {2, 2, 2}, "/none"), test::HasError(ErrorCode::NotFound));
}

TEST_F(SampleVolumes, BluntFinIsKeptInTheCache) {
    const GridDims dims{24, 16, 20};
    const auto first = loadSample("bluntfin", dims, kResources);
    ASSERT_THAT(first, test::IsOk());
    const auto second = loadSample("bluntfin", dims, "/none"); // from the cache alone
    ASSERT_THAT(second, test::IsOk());
    EXPECT_TRUE(std::ranges::equal(first.value()->bytes(), second.value()->bytes()));
    EXPECT_EQ(first.value()->geometry(), second.value()->geometry());
}

TEST_F(SampleVolumes, BrokenCacheIsNoObstacle) {
    const GridDims dims{8, 8, 8};
    ASSERT_THAT(loadSample("bluntfin", dims, kResources), test::IsOk());
    for (const auto& entry : std::filesystem::recursive_directory_iterator(cache.path()))
        if (entry.is_regular_file())
            std::filesystem::resize_file(entry.path(), 100);
    EXPECT_THAT(loadSample("bluntfin", dims, kResources), test::IsOk());
    ::setenv("XDG_CACHE_HOME", "/proc/none", 1);
    EXPECT_THAT(loadSample("bluntfin", dims, kResources), test::IsOk());
}

TEST_F(SampleVolumes, StopOnRequest) {
    std::stop_source stop;
    stop.request_stop();
    EXPECT_TRUE(loadSample("bluntfin", {8, 8, 8}, kResources, {stop.get_token(), {}}).isCancelled());
    EXPECT_TRUE(loadSample("shell", {8, 8, 8}, kResources, {stop.get_token(), {}}).isCancelled());
}

// A sheared and stretched lattice with a value that is linear in space: resampling must be exact.
CurvilinearGrid linearField(double wobble) {
    CurvilinearGrid grid;
    grid.dims = {7, 6, 5};
    for (int k = 0; k < 5; ++k)
        for (int j = 0; j < 6; ++j)
            for (int i = 0; i < 7; ++i) {
                const bool isInner = i > 0 && j > 0 && k > 0 && i < 6 && j < 5 && k < 4;
                const double push = isInner ? wobble * std::sin(1.0 + i + 3 * j + 7 * k) : 0.0;
                const glm::dvec3 p(i + push, j - push, k + 0.5 * push);
                grid.points.push_back(p);
                grid.values.push_back(static_cast<float>(2 * p.x - p.y + 3 * p.z));
            }
    return grid;
}

TEST(CurvilinearResampler, ReproducesALinearField) {
    const CurvilinearGrid grid = linearField(0.2);
    const GridGeometry geometry = boundingGeometry(grid.points, {25, 21, 17});
    EXPECT_EQ(geometry.spacing, glm::dvec3(0.25));
    const auto made = resampleCurvilinear(grid, geometry);
    ASSERT_THAT(made, test::IsOk());
    for (int z = 0; z < 17; ++z)
        for (int y = 0; y < 21; ++y)
            for (int x = 0; x < 25; ++x)
                EXPECT_NEAR(made.value().valueAt(x, y, z), 0.25 * (2 * x - y + 3 * z), 1e-5);
}

TEST(CurvilinearResampler, LeavesOutsideMissing) {
    CurvilinearGrid grid = linearField(0.0);
    for (glm::dvec3& p : grid.points) // lean over: two wedges of the box stay empty
        p.x += p.z;
    const auto made = resampleCurvilinear(grid, boundingGeometry(grid.points, {11, 6, 5}));
    ASSERT_THAT(made, test::IsOk());
    for (int z = 0; z < 5; ++z)
        for (int x = 0; x < 11; ++x)
            EXPECT_EQ(std::isnan(made.value().valueAt(x, 2, z)), x < z || x > z + 6) << x << " " << z;
}

TEST(CurvilinearResampler, KeepsMissingValuesMissing) {
    CurvilinearGrid grid = linearField(0.0);
    grid.values[0] = std::numeric_limits<float>::quiet_NaN();
    const auto made = resampleCurvilinear(grid, boundingGeometry(grid.points, {13, 11, 9}));
    ASSERT_THAT(made, test::IsOk());
    EXPECT_TRUE(std::isnan(made.value().valueAt(1, 1, 1)));
    EXPECT_FALSE(std::isnan(made.value().valueAt(3, 3, 3)));
}

TEST(VolumeWriter, ComesBackTheSame) {
    const test::TemporaryFolder folder;
    GridGeometry geometry;
    geometry.dims = {3, 2, 2};
    geometry.spacing = {0.1, 1.0 / 3.0, 1e-7};
    geometry.origin = {-1.5, 1e6, 0};
    geometry.direction = glm::dmat3(0, 1, 0, 1, 0, 0, 0, 0, 1); // left-handed
    const std::vector<double> values{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 0.1};
    const auto grid = ScalarGrid::fromValues<double>(geometry, ScalarType::F64, values);
    ASSERT_THAT(writeVolume(grid, folder / "a.mha", "µm"), test::IsOk());
    EXPECT_EQ(openVolume(folder / "a.mha").value()->info().lengthUnit, "µm");
    const auto read = readVolume(folder / "a.mha");
    ASSERT_THAT(read, test::IsOk());
    EXPECT_EQ(read.value()->geometry(), geometry);
    EXPECT_TRUE(std::ranges::equal(read.value()->bytes(), grid.bytes()));
    EXPECT_THAT(writeVolume(grid, folder / "a.raw"), test::HasError(ErrorCode::InvalidArgument));
    EXPECT_THAT(writeVolume(grid, folder / "none/a.mha"), test::HasError(ErrorCode::NotFound));
}

TEST(VolumeWriter, LeavesNothingWhenTheDiskIsFull) {
    const auto grid = makeSphericalShell({8, 8, 8});
    for (int failing = 0; failing < 4; ++failing) {
        const test::TemporaryFolder folder;
        test::FaultyFileSystem faulty(failing, ENOSPC);
        EXPECT_THAT(writeVolume(grid.value(), folder / "a.mha", {}, {}, faulty), test::HasError(ErrorCode::OutOfSpace));
        EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
    }
}

} // namespace
} // namespace isoslider::io
