#include "ui/model/colouring/colour_field.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "tests/support/result_matchers.h"
#include "ui/model/colouring/colour_map.h"
#include "ui/model/colouring/surface_range.h"

namespace isoslider::model {
namespace {

using test::HasError;
using test::IsOk;

GridGeometry geometryOf(const GridDims& dims, const glm::dvec3& spacing = glm::dvec3(1.0)) {
    GridGeometry geometry;
    geometry.dims = dims;
    geometry.spacing = spacing;
    return geometry;
}

template <class Value>
std::shared_ptr<const ScalarGrid> gridOf(const GridGeometry& geometry, const Value& value) {
    std::vector<float> values;
    for (std::int64_t z = 0; z < geometry.dims[2]; ++z)
        for (std::int64_t y = 0; y < geometry.dims[1]; ++y)
            for (std::int64_t x = 0; x < geometry.dims[0]; ++x)
                values.push_back(
                    static_cast<float>(value(static_cast<double>(x), static_cast<double>(y), static_cast<double>(z))));
    return std::make_shared<const ScalarGrid>(ScalarGrid::fromValues<float>(geometry, ScalarType::F32, values));
}

SurfaceColours coloursOf(ColourField field) {
    SurfaceColours colours;
    colours.by = ColourBy::Field;
    colours.field = std::make_shared<const ColourField>(std::move(field));
    return colours;
}

TEST(ColourField, HasTheLengthsOfGradientsPerUnitOfLength) {
    const GridGeometry geometry = geometryOf({9, 7, 6}, {0.5, 2.0, 4.0});
    // 3 per cell along x is 6 per unit, -4 along y is -2, 12 along z is 3.
    const auto grid = gridOf(geometry, [](double x, double y, double z) { return 3 * x - 4 * y + 12 * z; });
    const auto field = makeColourField(geometry, planesOf(grid), true, {});
    ASSERT_THAT(field, IsOk());
    EXPECT_EQ(field.value().step, 1);
    EXPECT_NEAR(field.value().min, 7.0, 1e-5); // at the sides, too
    EXPECT_NEAR(field.value().max, 7.0, 1e-5);
}

TEST(ColourField, FollowsAGradientThatChanges) {
    const GridGeometry geometry = geometryOf({17, 5, 5}, {2.0, 1.0, 1.0});
    const auto grid = gridOf(geometry, [](double x, double, double) { return x * x; });
    const auto field = makeColourField(geometry, planesOf(grid), true, {});
    ASSERT_THAT(field, IsOk());
    const SurfaceColours colours = coloursOf(field.value());
    for (const double x : {1.0, 4.0, 6.5, 15.0})
        EXPECT_NEAR(scalarAt(colours, geometry, {x, 2.0, 3.0}), x, 1e-4); // 2 x per cell, cells of 2
}

TEST(ColourField, OfALargeVolumeHasMeansOfBlocks) {
    const GridGeometry geometry = geometryOf({12, 10, 7});
    const auto value = [](double x, double y, double z) { return x + 100 * y + 10000 * z; };
    EXPECT_EQ(colourBlockSide(geometry.dims, 840), 1);
    EXPECT_EQ(colourBlockSide(geometry.dims, 839), 2);
    EXPECT_EQ(colourBlockSide({kMostTexelsASide + 1, 2, 2}), 2);
    const auto field = makeColourField(geometry, planesOf(gridOf(geometry, value)), false, {}, 200);
    ASSERT_THAT(field, IsOk());
    EXPECT_EQ(field.value().step, 2);
    EXPECT_EQ(field.value().dims, (GridDims{6, 5, 4}));
    const SurfaceColours colours = coloursOf(field.value());
    // Means of linear values are those of the middles of blocks; between them they are linear again.
    for (const glm::dvec3 place : {glm::dvec3(0.5, 0.5, 0.5), glm::dvec3(6.0, 3.25, 4.1)})
        EXPECT_NEAR(scalarAt(colours, geometry, place), value(place.x, place.y, place.z), 0.05);
    // The last block has one layer only, and stands where the middle of a whole one would be.
    EXPECT_NEAR(scalarAt(colours, geometry, {0.5, 0.5, 6.0}), value(0.5, 0.5, 6.0), 10000 * 0.5);
}

TEST(ColourField, HasNoValueBesideWhatIsMissing) {
    const GridGeometry geometry = geometryOf({8, 8, 8});
    const auto grid = gridOf(geometry, [](double x, double y, double z) {
        return x == 3 && y == 3 && z == 3 ? std::numeric_limits<double>::quiet_NaN() : x;
    });
    const auto field = makeColourField(geometry, planesOf(grid), false, {});
    ASSERT_THAT(field, IsOk());
    EXPECT_TRUE(field.value().hasMissing);
    const SurfaceColours colours = coloursOf(field.value());
    EXPECT_TRUE(std::isnan(scalarAt(colours, geometry, {2.5, 3.2, 2.9})));
    EXPECT_NEAR(scalarAt(colours, geometry, {4.5, 3.2, 2.9}), 4.5, 1e-5);
    const auto nothing = gridOf(geometry, [](double, double, double) { return std::nan(""); });
    EXPECT_THAT(makeColourField(geometry, planesOf(nothing), false, {}), HasError(ErrorCode::InvalidArgument));
}

TEST(ColourField, StopsWhenAsked) {
    const GridGeometry geometry = geometryOf({8, 8, 8});
    const auto grid = gridOf(geometry, [](double x, double, double) { return x; });
    std::stop_source stop;
    int planes = 0;
    const auto field = makeColourField(geometry,
                                       [&](std::int64_t, std::span<float>) -> Status {
                                           if (++planes == 3)
                                               stop.request_stop();
                                           return {};
                                       },
                                       true, {stop.get_token(), {}});
    EXPECT_TRUE(field.isCancelled());
    EXPECT_EQ(planes, 3);
}

TEST(ColourField, OfAnotherGridIsRefusedByWhatDiffers) {
    GridGeometry volume = geometryOf({24, 24, 24}, {1.0, 1.0, 2.5});
    volume.origin = {100.0, -50.0, 7.0};
    GridGeometry field = volume;
    EXPECT_EQ(latticeDifference(field, volume, true), "");
    field.spacing.z = 2.5001;
    field.origin.x += 0.01;
    EXPECT_EQ(latticeDifference(field, volume, true), "") << "headers round";
    field.spacing.z = 2.6;
    EXPECT_EQ(latticeDifference(field, volume, true), "its spacing is (1, 1, 2.6) instead of (1, 1, 2.5)");
    EXPECT_EQ(latticeDifference(field, volume, false), "") << "a raw file states no spacing";
    field = volume;
    field.origin.y = -48.0;
    EXPECT_EQ(latticeDifference(field, volume, true), "its origin is (100, -48, 7) instead of (100, -50, 7)");
    field = volume;
    field.direction[0] = {0.0, 1.0, 0.0};
    EXPECT_EQ(latticeDifference(field, volume, true), "its axes are turned against the volume's");
    field.dims = {24, 24, 20};
    EXPECT_EQ(latticeDifference(field, volume, false), "24 × 24 × 20 points instead of 24 × 24 × 24");
}

TEST(SurfaceRange, IsThatOfPlacesInTheFilesUnits) {
    GridGeometry volume = geometryOf({11, 11, 21}, {2.0, 1.0, 0.5});
    volume.origin = {-10.0, 5.0, 100.0};
    EXPECT_EQ(rangeOfVolume(ColourBy::X, volume), (ColourRange{-10.0, 10.0}));
    EXPECT_EQ(rangeOfVolume(ColourBy::Z, volume), (ColourRange{100.0, 110.0}));
    EXPECT_EQ(rangeOfVolume(ColourBy::Middle, volume), (ColourRange{0.0, std::sqrt(100.0 + 25.0 + 25.0)}));
    extract::SurfaceFrame frame;
    frame.geometry = volume;
    frame.positions = {{2, 3, 4}, {6, 3, 8}, {1, 9, 2}, {0, 0, 0}};
    frame.indices = {0, 1, 2};
    SurfaceColours colours;
    colours.by = ColourBy::X;
    const auto range = rangeOnSurface(frame, colours, volume, {}, {});
    ASSERT_THAT(range, IsOk());
    EXPECT_EQ(range.value(), (ColourRange{-8.0, 2.0})) << "the last vertex is of no triangle";
    EXPECT_TRUE(isUsable(usableRange({5.0, 5.0})));
    EXPECT_TRUE(isUsable(usableRange({1e300, 1e300})));
}

TEST(ColourMap, EndsWhereItShouldAndRunsBackwards) {
    const auto hex = [](const SeenColour& colour) {
        return static_cast<int>(std::lround(colour[0] * 255)) << 16 |
               static_cast<int>(std::lround(colour[1] * 255)) << 8 | static_cast<int>(std::lround(colour[2] * 255));
    };
    EXPECT_EQ(hex(colourAt(ColourMap::Viridis, false, 0.0)), 0x440154);
    EXPECT_EQ(hex(colourAt(ColourMap::Viridis, false, 1.0)), 0xfde725);
    EXPECT_EQ(hex(colourAt(ColourMap::BlueWhiteRed, false, 0.5)), 0xf7f7f7);
    EXPECT_EQ(hex(colourAt(ColourMap::Magma, true, 1.0)), 0x000004);
    EXPECT_EQ(hex(colourAt(ColourMap::Cividis, false, 7.0)), 0xfee838);
    EXPECT_EQ(hex(colourAt(ColourMap::Cividis, false, std::nan(""))), 0x00224e);
    // Ever lighter: what a map that is read without hues must be.
    for (const ColourMap map : {ColourMap::Viridis, ColourMap::Magma, ColourMap::Cividis, ColourMap::Grey}) {
        double before = -1.0;
        for (const SeenColour& colour : coloursOf(map, false, 100)) {
            const auto linear = [](float seen) { return std::pow(static_cast<double>(seen), 2.2); };
            const double light = 0.2126 * linear(colour[0]) + 0.7152 * linear(colour[1]) + 0.0722 * linear(colour[2]);
            EXPECT_GT(light, before) << colourMapName(map);
            before = light;
        }
    }
}

} // namespace
} // namespace isoslider::model
