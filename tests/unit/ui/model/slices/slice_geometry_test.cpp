#include "ui/model/slices/slice_geometry.h"

#include <cmath>

#include <gtest/gtest.h>

#include <glm/gtc/quaternion.hpp>

#include "ui/model/slices/slice_picture.h"

namespace isoslider::model {
namespace {

GridGeometry geometryOf(const GridDims& dims, const glm::dvec3& spacing = glm::dvec3(1.0)) {
    GridGeometry geometry;
    geometry.dims = dims;
    geometry.spacing = spacing;
    return geometry;
}

/// Grid axes along world axes: axis i of the grid along `ways[i]`.
GridGeometry along(const std::array<glm::dvec3, 3>& ways) {
    GridGeometry geometry = geometryOf({20, 30, 40}, {1.0, 2.0, 3.0});
    for (int i = 0; i < 3; ++i)
        geometry.direction[i] = ways[static_cast<std::size_t>(i)];
    return geometry;
}

SliceOptions at(const glm::dvec3& position) {
    SliceOptions options;
    options.position = position;
    return options;
}

TEST(SliceGeometry, OfAPlainGridLaysXRightYDownAndZUp) {
    const GridGeometry geometry = geometryOf({20, 30, 40});
    const auto z = planeOf(SliceKind::Z, at({1.0, 2.0, 3.0}), geometry);
    EXPECT_EQ(z, (extract::SlicePlane{{0.0, 0.0, 3.0}, {1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, 20, 30}));
    const auto y = planeOf(SliceKind::Y, at({1.0, 2.0, 3.0}), geometry);
    EXPECT_EQ(y, (extract::SlicePlane{{0.0, 2.0, 39.0}, {1.0, 0.0, 0.0}, {0.0, 0.0, -1.0}, 20, 40}));
    const auto x = planeOf(SliceKind::X, at({1.0, 2.0, 3.0}), geometry);
    EXPECT_EQ(x, (extract::SlicePlane{{1.0, 0.0, 39.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, -1.0}, 30, 40}));
}

// However the samples are stored, a world axis runs the same way on the screen.
TEST(SliceGeometry, LaysSlicesByTheWorldWhateverTheOrderOfTheSamples) {
    const glm::dvec3 x(1.0, 0.0, 0.0), y(0.0, 1.0, 0.0), z(0.0, 0.0, 1.0);
    const glm::dmat3 tilt = glm::mat3_cast(glm::angleAxis(0.3, glm::normalize(glm::dvec3(1.0, 2.0, -1.0))));
    for (const auto& ways : {std::array{x, y, z}, std::array{-x, -y, z}, std::array{y, -z, x}, std::array{-z, x, -y},
                             std::array{tilt * y, tilt * z, -(tilt * x)}}) {
        const GridGeometry geometry = along(ways);
        const glm::dmat3 toWorld(geometry.indexToWorld());
        for (const SliceKind kind : {SliceKind::X, SliceKind::Y, SliceKind::Z}) {
            const auto plane = planeOf(kind, at({9.0, 9.0, 9.0}), geometry);
            const glm::dvec3 right = toWorld * plane.right, down = toWorld * plane.down;
            const int across = worldAxisOf(kind);
            const int axis = gridAxisOf(kind, geometry);
            EXPECT_GT(std::abs(geometry.direction[axis][across]), 0.8);
            EXPECT_GT(right[across == 0 ? 1 : 0], 0.8 * glm::length(right));
            EXPECT_GT(down[across == 2 ? 1 : 2] * (across == 2 ? 1.0 : -1.0), 0.8 * glm::length(down));
            for (const auto& [column, row] :
                 {std::pair(0, 0), std::pair(plane.width - 1, 0), std::pair(plane.width - 1, plane.height - 1)}) {
                const glm::dvec3 corner = plane.at(column, row);
                EXPECT_EQ(clampedPlace(corner, geometry), corner);
                EXPECT_EQ(corner[axis], 9.0);
                const glm::dvec2 pixel = pixelOf(plane, corner, geometry);
                EXPECT_NEAR(pixel.x, column, 1e-9);
                EXPECT_NEAR(pixel.y, row, 1e-9);
            }
        }
    }
}

TEST(SliceGeometry, PatientsHaveTheirRightOnTheLeftAndFaceUpwards) {
    const GridGeometry geometry = along({glm::dvec3(-1, 0, 0), glm::dvec3(0, -1, 0), glm::dvec3(0, 0, 1)});
    const auto axial = sliceLabels(SliceKind::Z, at({}), geometry, true);
    EXPECT_EQ(axial.left + axial.right + axial.top + axial.bottom, "RLAP");
    const auto coronal = sliceLabels(SliceKind::Y, at({}), geometry, true);
    EXPECT_EQ(coronal.left + coronal.right + coronal.top + coronal.bottom, "RLSI");
    const auto sagittal = sliceLabels(SliceKind::X, at({}), geometry, true);
    EXPECT_EQ(sagittal.left + sagittal.right + sagittal.top + sagittal.bottom, "APSI");
    const auto plain = sliceLabels(SliceKind::Z, at({}), geometry, false);
    EXPECT_EQ(plain.right, "X") << "the world's, where it grows";
    EXPECT_EQ(plain.bottom, "Y");
    EXPECT_EQ(plain.left + plain.top, "");
    const auto upright = sliceLabels(SliceKind::X, at({}), geometry, false);
    EXPECT_EQ(upright.right + upright.top, "YZ");
    EXPECT_EQ(upright.left + upright.bottom, "");
}

TEST(SliceGeometry, LabelsHaveTheNamesOfTheAxesThatAreSeen) {
    const glm::dvec3 x(1.0, 0.0, 0.0), y(0.0, 1.0, 0.0), z(0.0, 0.0, 1.0);
    const auto permuted = sliceLabels(SliceKind::Z, at({}), along({z, x, -y}), false);
    EXPECT_EQ(permuted.right + permuted.bottom, "XY");
    const glm::dmat3 tilt = glm::mat3_cast(glm::angleAxis(0.3, x));
    const auto turned = sliceLabels(SliceKind::Z, at({}), along({tilt * z, tilt * x, -(tilt * y)}), false);
    EXPECT_EQ(turned.right + turned.top, "jk") << "the grid's own, where they grow";
}

TEST(SliceGeometry, OfLargeVolumesAndPreviewsTakesEveryNthSample) {
    const auto large = planeOf(SliceKind::Z, at({}), geometryOf({10'001, 5'000, 3}));
    EXPECT_EQ(large.right.x, 5.0);
    EXPECT_EQ(large.width, 2001);
    EXPECT_EQ(large.height, 1000);
    const auto preview = planeOf(SliceKind::Y, at({}), geometryOf({33, 33, 33}), 4);
    EXPECT_EQ(preview.width, 9);
    EXPECT_EQ(preview.origin.z, 32.0);
    EXPECT_EQ(preview.onEvery(4.0).origin.z, 8.0);
    EXPECT_EQ(preview.onEvery(4.0).down.z, -1.0);
}

TEST(SliceGeometry, AnObliqueSliceCoversTheVolumeAtEveryDepth) {
    const GridGeometry geometry = geometryOf({20, 30, 10}, {1.0, 1.0, 4.0});
    SliceOptions options = at({5.0, 6.0, 7.0});
    options.orientation = glm::normalize(glm::dquat(0.8, 0.3, -0.2, 0.4));
    const glm::dmat3 toWorld(geometry.indexToWorld());
    const auto plane = planeOf(SliceKind::Oblique, options, geometry);
    const glm::dvec3 normal = options.orientation * glm::dvec3(0.0, 0.0, 1.0);
    EXPECT_NEAR(glm::length(toWorld * plane.right), 1.0, 1e-9);
    EXPECT_NEAR(glm::dot(toWorld * plane.right, toWorld * plane.down), 0.0, 1e-9);
    EXPECT_NEAR(glm::dot(toWorld * (plane.origin - options.position), normal), 0.0, 1e-9);
    for (int corner = 0; corner < 8; ++corner) {
        const glm::dvec2 pixel = pixelOf(
            plane, glm::dvec3(19.0, 29.0, 9.0) * glm::dvec3(corner & 1, corner >> 1 & 1, corner >> 2), geometry);
        EXPECT_GT(pixel.x, -1e-6);
        EXPECT_LT(pixel.x, plane.width);
        EXPECT_GT(pixel.y, -1e-6);
        EXPECT_LT(pixel.y, plane.height);
    }
    // Pushed along its normal it moves by the smallest spacing and shows the same rectangle; it stops at the box.
    const glm::dvec3 pushed = steppedPlace(SliceKind::Oblique, 2.0, options, geometry);
    EXPECT_LT(glm::distance(toWorld * (pushed - options.position), 2.0 * normal), 1e-9);
    const glm::dvec3 end = steppedPlace(SliceKind::Oblique, 1e6, options, geometry);
    EXPECT_EQ(clampedPlace(end, geometry), end);
    EXPECT_LT(glm::length(glm::cross(toWorld * (end - options.position), normal)), 1e-6) << "it left the way";
}

TEST(SliceGeometry, CutsThePreviewsSurfaceWhereItCutsTheVolume) {
    const GridGeometry volume = geometryOf({33, 33, 33}, {1.0, 2.0, 3.0});
    GridGeometry preview = geometryOf({9, 9, 9}, {4.0, 8.0, 12.0});
    const auto cut = cutPlaneOf(planeOf(SliceKind::Z, at({0.0, 0.0, 10.0}), volume), volume, preview);
    EXPECT_NEAR(glm::dot(cut.normal, glm::dvec3(3.0, 1.0, 2.5)) - cut.offset, 0.0, 1e-9);
    EXPECT_GT(std::abs(glm::dot(cut.normal, glm::dvec3(3.0, 1.0, 2.6)) - cut.offset), 0.1);
}

TEST(SliceGeometry, TheWindowLeavesOutTheFewAtBothEnds) {
    ValueDistribution values;
    values.min = -5000.0;
    values.max = 9000.0;
    values.cells = {{-5000.0, -5000.0, 3}, {0.0, 0.0, 500}, {50.0, 100.0, 490}, {9000.0, 9000.0, 2}};
    EXPECT_EQ(automaticWindow(values), (ValueWindow{0.0, 100.0}));
    values.cells = {{7.0, 7.0, 1000}};
    values.min = values.max = 7.0;
    EXPECT_GT(automaticWindow(values).width(), 0.0);
    values.cells = {{7.0, 7.0, 1000}, {8.0, 8.0, 1}};
    values.max = 8.0;
    EXPECT_EQ(automaticWindow(values), (ValueWindow{7.0, 8.0}));
}

TEST(SlicePicture, IsGreyInTheWindowAndNeitherGreyNorClearWhereSamplesAreMissing) {
    extract::SliceSamples samples;
    samples.plane = {{-1.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, 5, 1};
    const float nan = std::numeric_limits<float>::quiet_NaN();
    samples.values = {nan, -50.0f, 15.0f, 1e9f, nan};
    const auto shades = shadesOf(samples, samples.plane, {10.0, 20.0}, {4, 2, 2});
    EXPECT_EQ(shades.pixels[0], 0u) << "outside";
    EXPECT_EQ(shades.pixels[1], 0xff000000u);
    EXPECT_EQ(shades.pixels[2], 0xff808080u);
    EXPECT_EQ(shades.pixels[3], 0xffffffffu);
    EXPECT_EQ(shades.pixels[4], kMissingColour);
}

} // namespace
} // namespace isoslider::model
