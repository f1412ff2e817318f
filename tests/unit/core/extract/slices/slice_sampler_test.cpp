#include "core/extract/slices/slice_sampler.h"

#include <cmath>
#include <cstring>
#include <fstream>
#include <random>

#include <gtest/gtest.h>

#include "core/extract/slices/trilinear_value.h"
#include "core/index/format/chunk_grid.h"
#include "tests/property/test_volumes.h"
#include "tests/support/result_matchers.h"
#include "tests/support/temporary_folder.h"

namespace isoslider::extract {
namespace {

using test::HasError;
using test::IsOk;

const float kNaN = std::numeric_limits<float>::quiet_NaN();

GridGeometry geometryOf(const GridDims& dims) {
    GridGeometry geometry;
    geometry.dims = dims;
    return geometry;
}

std::shared_ptr<const ScalarGrid> floatNoise(const GridDims& dims, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> values(-3.0f, 5.0f);
    return test::makeVolume<float>(ScalarType::F32, geometryOf(dims), [&](auto, auto, auto) { return values(random); });
}

/// All grid points z = `at`, y downwards.
SlicePlane acrossZ(const GridDims& dims, double at) {
    return {{0.0, 0.0, at}, {1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, static_cast<int>(dims[0]), static_cast<int>(dims[1])};
}

SlicePlane oblique(const GridDims& dims) {
    return {{-2.0, -1.5, static_cast<double>(dims[2]) * 0.2},
            {0.71, 0.13, 0.21},
            {-0.11, 0.83, 0.33},
            static_cast<int>(dims[0] * 3 / 2),
            static_cast<int>(dims[1] * 3 / 2)};
}

bool isSame(const std::vector<float>& a, const std::vector<float>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0;
}

std::vector<float> valuesOf(SliceSampler& sampler, const SlicePlane& plane) {
    auto slice = sampler.sample(plane, {});
    EXPECT_THAT(slice, IsOk());
    EXPECT_EQ(slice.value().plane, plane);
    return std::move(slice.value().values);
}

TEST(SliceSampler, AtGridPointsGivesTheSamplesWhateverLiesBesideThem) {
    const auto grid = test::makeVolume<float>(ScalarType::F32, geometryOf({5, 4, 3}), [](auto x, auto y, auto z) {
        return z == 1 ? static_cast<float>(x + 10 * y) : kNaN; // the planes beside it are missing
    });
    const auto sampler = makeSliceSampler(grid);
    const auto values = valuesOf(*sampler, acrossZ({5, 4, 3}, 1.0));
    for (int y = 0; y < 4; ++y)
        for (int x = 0; x < 5; ++x)
            EXPECT_EQ(values[static_cast<std::size_t>(x + 5 * y)], static_cast<float>(x + 10 * y));
    for (const float value : valuesOf(*sampler, acrossZ({5, 4, 3}, 1.25)))
        EXPECT_TRUE(std::isnan(value));
}

TEST(SliceSampler, IsTheTrilinearInterpolantBetweenSamples) {
    const auto grid = floatNoise({9, 8, 7}, 3);
    const auto sampler = makeSliceSampler(grid);
    const SlicePlane plane = oblique({9, 8, 7});
    const auto values = valuesOf(*sampler, plane);
    int inside = 0;
    for (int row = 0; row < plane.height; ++row)
        for (int column = 0; column < plane.width; ++column) {
            const glm::dvec3 p = plane.at(column, row);
            const float value = values[static_cast<std::size_t>(row * plane.width + column)];
            if (p.x < 0.0 || p.y < 0.0 || p.z < 0.0 || p.x > 8.0 || p.y > 7.0 || p.z > 6.0) {
                EXPECT_TRUE(std::isnan(value));
                continue;
            }
            ++inside;
            // One axis after the other: another way to the same number.
            const auto lerp = [](double a, double b, double t) { return a + t * (b - a); };
            const auto x = std::min<std::int64_t>(7, static_cast<std::int64_t>(p.x));
            const auto y = std::min<std::int64_t>(6, static_cast<std::int64_t>(p.y));
            const auto z = std::min<std::int64_t>(5, static_cast<std::int64_t>(p.z));
            const double u = p.x - static_cast<double>(x), v = p.y - static_cast<double>(y);
            const auto onPlane = [&](std::int64_t k) {
                return lerp(lerp(grid->valueAt(x, y, k), grid->valueAt(x + 1, y, k), u),
                            lerp(grid->valueAt(x, y + 1, k), grid->valueAt(x + 1, y + 1, k), u), v);
            };
            EXPECT_NEAR(value, lerp(onPlane(z), onPlane(z + 1), p.z - static_cast<double>(z)), 1e-5);
        }
    EXPECT_GT(inside, 30);
}

TEST(SliceSampler, TreatsTheLastPlaneAndRoundingAsInside) {
    const auto grid = floatNoise({6, 5, 4}, 5);
    const auto sampler = makeSliceSampler(grid);
    const auto last = valuesOf(*sampler, acrossZ({6, 5, 4}, 3.0));
    EXPECT_EQ(last[7], static_cast<float>(grid->valueAt(1, 1, 3)));
    EXPECT_TRUE(isSame(last, valuesOf(*sampler, acrossZ({6, 5, 4}, 3.0 + 1e-9))));
    for (const float value : valuesOf(*sampler, acrossZ({6, 5, 4}, 3.01)))
        EXPECT_TRUE(std::isnan(value));
    EXPECT_FALSE(cellOf({0.0, 0.0, std::numeric_limits<double>::quiet_NaN()}, {6, 5, 4}).isInside);
    EXPECT_FALSE(cellOf({0.0, 0.0, std::numeric_limits<double>::infinity()}, {6, 5, 4}).isInside);
}

TEST(SliceSampler, OfAGridOnePointThickWorks) {
    const auto grid = floatNoise({6, 5, 1}, 5);
    EXPECT_EQ(valuesOf(*makeSliceSampler(grid), acrossZ({6, 5, 1}, 0.0))[8],
              static_cast<float>(grid->valueAt(2, 1, 0)));
}

class StoredSliceTest : public testing::Test {
protected:
    std::filesystem::path build(const std::shared_ptr<const ScalarGrid>& grid,
                                index::IndexKind kind = index::IndexKind::Metacells) {
        preprocess::BuildOptions options;
        options.kind = kind;
        EXPECT_THAT(test::buildIndexOf(grid, folder_ / "volume.isx", options), IsOk());
        return folder_ / "volume.isx";
    }
    test::TemporaryFolder folder_;
};

TEST_F(StoredSliceTest, EqualsTheVolumeToTheLastBit) {
    const GridDims dims{41, 37, 52};
    auto noise = floatNoise(dims, 11);
    const auto grid = test::makeVolume<float>(ScalarType::F32, geometryOf(dims), [&](auto x, auto y, auto z) {
        return x == 20 && y == 15 ? kNaN : static_cast<float>(noise->valueAt(x, y, z));
    });
    const auto memory = makeSliceSampler(grid);
    auto opened = openSliceSampler(build(grid));
    ASSERT_THAT(opened, IsOk());
    EXPECT_EQ(opened.value()->geometry(), grid->geometry());
    for (const double z : {0.0, 15.0, 16.0, 15.5, 51.0, 60.0})
        EXPECT_TRUE(isSame(valuesOf(*memory, acrossZ(dims, z)), valuesOf(*opened.value(), acrossZ(dims, z)))) << z;
    EXPECT_TRUE(isSame(valuesOf(*memory, oblique(dims)), valuesOf(*opened.value(), oblique(dims))));
}

// More chunks than the cache may hold: batches follow each other, and what was kept makes room.
TEST_F(StoredSliceTest, EqualsItBeyondTheCache) {
    const GridDims dims{240, 232, 176}; // 15 * 15 * 11 chunks
    std::uint32_t state = 1;
    const auto grid = test::makeVolume<std::uint8_t>(ScalarType::U8, geometryOf(dims), [&](auto x, auto, auto z) {
        state = state * 1664525u + 1013904223u;
        return (x + z) / 2 + (state >> 28);
    });
    const auto memory = makeSliceSampler(grid);
    auto opened = openSliceSampler(build(grid), 0);
    ASSERT_THAT(opened, IsOk());
    for (int round = 0; round < 2; ++round)
        for (std::int64_t z = 5; z < dims[2]; z += 34)
            EXPECT_TRUE(isSame(valuesOf(*memory, acrossZ(dims, static_cast<double>(z))),
                               valuesOf(*opened.value(), acrossZ(dims, static_cast<double>(z)))));
    // Pixels several chunks apart, with the depth in turns: every tile has other chunks.
    const SlicePlane sparse{{0.5, 0.5, 0.5}, {7.3, 0.0, 5.1}, {0.0, 6.9, 0.0}, 33, 33};
    EXPECT_TRUE(isSame(valuesOf(*memory, sparse), valuesOf(*opened.value(), sparse)));
    EXPECT_TRUE(isSame(valuesOf(*memory, oblique(dims)), valuesOf(*opened.value(), oblique(dims))));
}

TEST_F(StoredSliceTest, IsOfAnIndexOfEdgesToo) {
    const GridDims dims{20, 12, 33};
    const auto grid = floatNoise(dims, 1);
    const auto opened = openSliceSampler(build(grid, index::IndexKind::Edges));
    ASSERT_THAT(opened, IsOk());
    EXPECT_TRUE(isSame(valuesOf(*makeSliceSampler(grid), oblique(dims)), valuesOf(*opened.value(), oblique(dims))));
}

TEST_F(StoredSliceTest, RefusesWhatIsNoIndex) {
    EXPECT_THAT(openSliceSampler(folder_ / "none.isx"), HasError(ErrorCode::NotFound));
}

TEST_F(StoredSliceTest, StopsWhenAskedAndGoesOnAfterwards) {
    const GridDims dims{40, 40, 40};
    const auto grid = floatNoise(dims, 2);
    auto opened = openSliceSampler(build(grid));
    ASSERT_THAT(opened, IsOk());
    const auto memory = makeSliceSampler(grid);
    std::stop_source stop;
    stop.request_stop();
    JobControl job;
    job.stop = stop.get_token();
    EXPECT_THAT(opened.value()->sample(acrossZ(dims, 3.0), job), HasError(ErrorCode::Cancelled));
    EXPECT_THAT(memory->sample(acrossZ(dims, 3.0), job), HasError(ErrorCode::Cancelled));
    EXPECT_TRUE(isSame(valuesOf(*memory, acrossZ(dims, 3.0)), valuesOf(*opened.value(), acrossZ(dims, 3.0))));
}

TEST_F(StoredSliceTest, ReportsADamagedChunk) {
    const GridDims dims{40, 40, 40};
    const auto path = build(floatNoise(dims, 2));
    const auto size = std::filesystem::file_size(path);
    bool isReported = false;
    for (std::uintmax_t place = 0; place < 64 && !isReported; ++place) {
        const auto offset = static_cast<std::streamoff>(size / 3 + place * size / 128);
        std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
        file.seekg(offset);
        const int byte = file.get();
        file.seekp(offset);
        file.put(static_cast<char>(byte ^ 0xff));
        file.flush();
        auto opened = openSliceSampler(path);
        if (opened.isOk())
            for (const double z : {3.0, 20.0, 36.0})
                if (const auto slice = opened.value()->sample(acrossZ(dims, z), {}); !slice.isOk()) {
                    EXPECT_THAT(slice, HasError(ErrorCode::Corruption));
                    isReported = true;
                }
        file.seekp(offset);
        file.put(static_cast<char>(byte));
    }
    EXPECT_TRUE(isReported) << "no byte of the samples was damaged";
}

} // namespace
} // namespace isoslider::extract
