#include "core/volume_io/resampling/resampled_source.h"

#include <cmath>
#include <limits>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/volume_io/resampling/rectilinear_resampler.h"
#include "tests/support/result_matchers.h"

namespace isoslider::io {
namespace {

const float kMissing = std::numeric_limits<float>::quiet_NaN();

std::unique_ptr<VolumeSource> sourceOf(const GridDims& dims, const std::vector<float>& values) {
    GridGeometry geometry;
    geometry.dims = dims;
    return makeMemorySource(
        std::make_shared<const ScalarGrid>(ScalarGrid::fromValues<float>(geometry, ScalarType::F32, values)));
}

GridAxis axisOf(std::vector<double> at) { return makeAxis(std::move(at), "x", "file").value(); }

std::vector<float> slabOf(VolumeSource& source) {
    const GridDims dims = source.info().geometry.dims;
    std::vector<float> values(static_cast<std::size_t>(pointCount(dims)));
    EXPECT_THAT(source.readSlab(0, dims[2], std::as_writable_bytes(std::span(values))), test::IsOk());
    return values;
}

TEST(GridAxis, KnowsWhetherItIsEven) {
    EXPECT_TRUE(axisOf({0, 1, 2}).isEven);
    EXPECT_TRUE(axisOf({0, 1.00009, 2}).isEven);
    EXPECT_FALSE(axisOf({0, 1.00011, 2}).isEven);
    EXPECT_TRUE(axisOf({7}).isEven);
    EXPECT_EQ(axisOf({7}).spacing(1), 1.0);
    const GridAxis down = axisOf({9, 5, 1});
    EXPECT_TRUE(down.isDescending);
    EXPECT_EQ(down.at, (std::vector<double>{1, 5, 9}));
}

TEST(GridAxis, RefusesWhatIsNoAxis) {
    const double inf = std::numeric_limits<double>::infinity();
    for (const std::vector<double>& at :
         {std::vector<double>{0, 1, 1}, {0, 1, 0.5}, {2, 1, 1}, {0, std::nan("")}, {-inf, 0}})
        EXPECT_THAT(makeAxis(at, "lat", "file"), test::HasError(ErrorCode::InvalidArgument));
    EXPECT_THAT(makeAxis({-1.7e308, 1.7e308}, "lat", "file"), test::HasError(ErrorCode::InvalidArgument));
    EXPECT_THAT(makeAxis({0, 0}, "lat", "file").error().line(), testing::HasSubstr("lat"));
}

TEST(PlaceOnAxes, KeepsTheSamplesOfEvenAxes) {
    auto placed = placeOnAxes(sourceOf({2, 2, 2}, {1, 2, 3, 4, 5, 6, 7, kMissing}),
                              {axisOf({-1, 1}), axisOf({10, 13}), axisOf({5, 5.5})}, {}, "file");
    ASSERT_THAT(placed, test::IsOk());
    EXPECT_EQ(placed.value()->info().geometry.origin, glm::dvec3(-1, 10, 5));
    EXPECT_EQ(placed.value()->info().geometry.spacing, glm::dvec3(2, 3, 0.5));
    EXPECT_EQ(slabOf(*placed.value())[6], 7.0f);
    EXPECT_FALSE(placed.value()->info().resampling.has_value());
}

/// f = 2x - y + 3z at uneven places.
std::unique_ptr<VolumeSource> unevenLinear(const ReadOptions& options, bool isHoled = false) {
    const std::array axes{axisOf({0, 1, 4}), axisOf({0, 1, 2}), axisOf({0, 3, 4, 8})};
    std::vector<float> values;
    for (const double z : axes[2].at)
        for (const double y : axes[1].at)
            for (const double x : axes[0].at)
                values.push_back(static_cast<float>(2 * x - y + 3 * z));
    if (isHoled)
        values[0] = kMissing;
    auto placed = placeOnAxes(sourceOf({3, 3, 4}, values), axes, options, "file");
    EXPECT_THAT(placed, test::IsOk());
    return std::move(placed).value();
}

TEST(PlaceOnAxes, ResamplesUnevenAxes) {
    ReadOptions options;
    options.resampleDims = {9, 5, 17};
    const auto source = unevenLinear(options);
    const auto values = slabOf(*source);
    const GridGeometry geometry = source->info().geometry;
    EXPECT_EQ(geometry.spacing, glm::dvec3(0.5));
    for (int z = 0, i = 0; z < 17; ++z)
        for (int y = 0; y < 5; ++y)
            for (int x = 0; x < 9; ++x, ++i)
                ASSERT_NEAR(values[static_cast<std::size_t>(i)], 0.5 * (2 * x - y + 3 * z), 1e-5);
    const auto report = source->info().resampling;
    ASSERT_TRUE(report.has_value());
    EXPECT_EQ(report->sourcePoints, 36);
    EXPECT_EQ(report->comparedPoints, 36);
    EXPECT_EQ(report->outsidePoints, 0);
    EXPECT_NEAR(report->maxDifference, 0.0, 1e-5);
}

TEST(PlaceOnAxes, HasPointsAsNearAsTheNearestTwoByDefault) {
    const auto source = unevenLinear({});
    const GridGeometry geometry = source->info().geometry;
    EXPECT_EQ(geometry.dims, (GridDims{5, 3, 9})) << "y is even";
    EXPECT_EQ(geometry.spacing, glm::dvec3(1));
    EXPECT_FALSE(source->info().resampling.has_value()) << "before anything is read";
}

TEST(DefaultDims, HaveAPointAtEachPlaceWhereTheStepsAreMultiples) {
    const GridAxis depth = axisOf({0, 10, 20, 30, 50, 100, 500, 1500});
    EXPECT_EQ(defaultDims({axisOf({0, 1, 2}), indexAxis(1), depth}, 0), (GridDims{3, 1, 151}));
    EXPECT_EQ(defaultDims({axisOf({0, 0.3, 1}), depth, indexAxis(5)}, 0), (GridDims{5, 151, 5}))
        << "rounded up where they are none";
}

TEST(DefaultDims, AreBounded) {
    const GridAxis even = indexAxis(1000), close = axisOf({0, 1e-9, 1, 2});
    EXPECT_EQ(defaultDims({close, close, close}, 0), (GridDims{12, 12, 12})) << "32 times 64, as near as that goes";
    EXPECT_EQ(defaultDims({indexAxis(5), close, indexAxis(3)}, 0), (GridDims{5, 128, 3})) << "32 times 4";
    const GridDims dims = defaultDims({even, even, close}, 0); // 128 million
    EXPECT_EQ(dims, (GridDims{1000, 1000, 67}));
    EXPECT_EQ(defaultDims({even, even, close}, std::uint64_t{1} << 28), (GridDims{1000, 1000, 16}));
    EXPECT_EQ(defaultDims({even, even, close}, std::uint64_t{1} << 20), (GridDims{1000, 1000, 4})) << "their own";
    const GridDims both = defaultDims({even, axisOf({0, 0.001, 3, 5}), axisOf({0, 0.001, 3, 5, 9, 10, 20, 22})}, 0);
    EXPECT_LE(pointCount(both), 32 * 32'000);
    EXPECT_GT(pointCount(both), 28 * 32'000);
}

TEST(PlaceOnAxes, LeavesMissingWhatDependsOnMissingValues) {
    ReadOptions options;
    options.resampleDims = {9, 5, 17};
    const auto source = unevenLinear(options, true);
    const auto values = slabOf(*source);
    EXPECT_TRUE(std::isnan(values[0]));
    EXPECT_TRUE(std::isnan(values[1])); // between the hole and its neighbour
    EXPECT_FALSE(std::isnan(values[2])); // the neighbour itself
    const auto report = *source->info().resampling;
    EXPECT_EQ(report.comparedPoints, 35);
    EXPECT_EQ(report.outsidePoints, 2 * 2 * 6);
}

TEST(PlaceOnAxes, RefusesSizesThatAreNone) {
    const std::array axes{axisOf({0, 1, 4}), axisOf({0, 1, 2}), axisOf({0})};
    for (const GridDims& dims : {GridDims{1, 3, 1}, {3, 3, 2}, {-1, 3, 1}, {1 << 20, 1 << 20, 1}}) {
        ReadOptions options;
        options.resampleDims = dims;
        EXPECT_FALSE(placeOnAxes(sourceOf({3, 3, 1}, std::vector<float>(9)), axes, options, "file").isOk()) << dims[0];
    }
}

TEST(PlaceOnAxes, StopsOnRequest) {
    const auto source = unevenLinear({});
    std::stop_source stop;
    stop.request_stop();
    auto* whole = dynamic_cast<WholeGridSource*>(source.get());
    ASSERT_NE(whole, nullptr);
    EXPECT_TRUE(whole->grid({stop.get_token(), {}}).isCancelled());
    double last = 0.0;
    EXPECT_THAT(whole->grid({{}, [&](double fraction, std::string_view) { last = fraction; }}), test::IsOk());
    EXPECT_EQ(last, 1.0);
}

TEST(ResampleReport, MeasuresWhatIsLost) {
    // x^2 at 0, 1, 4 on a grid of three points, 0, 2, 4: there 0, 6, 16; back at 1 that gives 3 instead of 1.
    const std::array axes{axisOf({0, 1, 4}), indexAxis(2), indexAxis(2)};
    ReadOptions options;
    options.resampleDims = {3, 2, 2};
    const auto source =
        placeOnAxes(sourceOf({3, 2, 2}, {0, 1, 16, 0, 1, 16, 0, 1, 16, 0, 1, 16}), axes, options, "file");
    ASSERT_THAT(source, test::IsOk());
    EXPECT_EQ(slabOf(*source.value())[1], 6.0f);
    const auto report = *source.value()->info().resampling;
    EXPECT_DOUBLE_EQ(report.maxDifference, 2.0);
    EXPECT_DOUBLE_EQ(report.rmsDifference, std::sqrt(4.0 / 3));
    EXPECT_DOUBLE_EQ(report.rangeFraction, 2.0 / 16);
}

TEST(ResampleReport, CountsWhatLiesOutsideACurvilinearGrid) {
    CurvilinearGrid grid;
    grid.dims = {3, 2, 2};
    for (int k = 0; k < 2; ++k)
        for (int j = 0; j < 2; ++j)
            for (int i = 0; i < 3; ++i) {
                grid.points.emplace_back(i + k, j, k); // leans over: two corners of the box stay empty
                grid.values.push_back(static_cast<float>(i));
            }
    VolumeInfo info;
    info.geometry = boundingGeometry(grid.points, {4, 2, 2});
    const auto source = makeResampledSource(info, makeCurvilinearMesh(grid));
    const auto values = slabOf(*source);
    EXPECT_TRUE(std::isnan(values[3]));
    const auto report = *source->info().resampling;
    EXPECT_EQ(report.outsidePoints, 4);
    EXPECT_EQ(report.sourcePoints, 12);
    EXPECT_EQ(report.comparedPoints, 12);
    EXPECT_NEAR(report.maxDifference, 0.0, 1e-6);
}

TEST(EvenDims, FillTheBoxWithAboutAsManyPoints) {
    EXPECT_EQ(evenDims({0, 0, 0}, {1, 1, 1}, 1000), (GridDims{10, 10, 10}));
    const GridDims flat = evenDims({0, 0, 0}, {4, 2, 0}, 1000);
    EXPECT_EQ(flat[2], 2);
    EXPECT_NEAR(static_cast<double>(pointCount(flat)), 1000, 100);
    const GridDims least = evenDims({0, 0, 0}, {1, 1, 1}, 1);
    EXPECT_EQ(least, (GridDims{2, 2, 2}));
    EXPECT_LE(evenDims({0, 0, 0}, {1e300, 1e-300, 1}, 1'000'000)[0], kMaxDim);
    EXPECT_EQ(evenDims({0, 0, 0}, {0, 0, 0}, 1000)[0] >= 2, true);
}

} // namespace
} // namespace isoslider::io
