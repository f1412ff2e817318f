#include "ui/model/slices/cap_samples.h"

#include <cmath>
#include <limits>
#include <memory>

#include <gtest/gtest.h>

#include <glm/geometric.hpp>

#include "core/extract/slices/slice_sampler.h"
#include "ui/model/slices/slice_geometry.h"

namespace isoslider::model {
namespace {

constexpr GridDims kCapDims{9, 13, 7};
const float kNone = std::numeric_limits<float>::quiet_NaN();

GridGeometry volume() {
    GridGeometry geometry;
    geometry.dims = kCapDims;
    geometry.spacing = {0.5, 0.25, 1.0};
    geometry.origin = {10.0, 20.0, 30.0};
    return geometry;
}

CapSamples sampled(const ClipPlane& plane, const std::vector<float>& values) {
    const auto grid =
        std::make_shared<const ScalarGrid>(ScalarGrid::fromValues<float>(volume(), ScalarType::F32, values));
    const auto pixels = capPlaneOf(plane, volume(), 1);
    return capSamplesOf(plane, pixels, extract::makeSliceSampler(grid)->sample(pixels, {}).value(), kCapDims);
}

TEST(CapSamples, PixelsLieOnThePlaneAndCoverTheVolume) {
    for (const glm::dvec3& normal : {glm::dvec3(1, 0, 0), glm::dvec3(0, 0, 1), glm::dvec3(0, 0, -1),
                                     glm::dvec3(0.6, 0.0, -0.8), glm::normalize(glm::dvec3(1, 2, 3))}) {
        const ClipPlane plane{true, normal, 0.3, Cap::Colour};
        const auto pixels = capPlaneOf(plane, volume(), 1);
        const double right = pixels.width - 1, down = pixels.height - 1;
        for (const auto& place : {pixels.at(0, 0), pixels.at(right, 0), pixels.at(0, down), pixels.at(right, down)})
            EXPECT_NEAR(glm::dot(normal, centredWorldOf(place, volume(), volume())), 0.3, 1e-9);
        // Seen along the normal, every corner of the volume lies among the pixels.
        for (int corner = 0; corner < 8; ++corner) {
            const glm::dvec3 place((kCapDims[0] - 1) * (corner & 1), (kCapDims[1] - 1) * (corner >> 1 & 1),
                                   (kCapDims[2] - 1) * (corner >> 2));
            const glm::dvec2 pixel = pixelOf(pixels, place, volume());
            EXPECT_GE(pixel.x, -1e-9);
            EXPECT_GE(pixel.y, -1e-9);
            EXPECT_LE(pixel.x, right + 1e-9);
            EXPECT_LE(pixel.y, down + 1e-9);
        }
        EXPECT_GE(pixels.width * pixels.height, 100) << "several to a cell";
        EXPECT_LE(std::max(pixels.width, pixels.height), kMostObliqueSide + 4);
    }
}

TEST(CapSamples, HoldTheInterpolantAndContinueBeyondTheSides) {
    // Linear in the world, so that the interpolant is known everywhere.
    std::vector<float> values;
    for (int z = 0; z < kCapDims[2]; ++z)
        for (int y = 0; y < kCapDims[1]; ++y)
            for (int x = 0; x < kCapDims[0]; ++x)
                values.push_back(static_cast<float>(x + 10 * y + 100 * z));
    const CapSamples cap = sampled({true, glm::normalize(glm::dvec3(1, 2, 3)), 0.1, Cap::Colour}, values);
    int inside = 0, beyond = 0;
    for (int row = 0; row < cap.plane.height; ++row)
        for (int column = 0; column < cap.plane.width; ++column) {
            const glm::dvec3 place = cap.plane.at(column, row);
            const glm::vec2 pixel = cap.pixels[static_cast<std::size_t>(row * cap.plane.width + column)];
            if (glm::distance(place, clampedPlace(place, volume())) < 1e-9) {
                EXPECT_EQ(pixel.y, 1.0f);
                EXPECT_NEAR(pixel.x, place.x + 10 * place.y + 100 * place.z, 1e-3);
                ++inside;
            } else {
                beyond += pixel.y > 0.0f;
            }
        }
    EXPECT_GT(inside, 500);
    EXPECT_GT(beyond, 50);
    EXPECT_LT(beyond, inside / 2) << "one pixel only";
}

TEST(CapSamples, MissingSamplesStayUnknown) {
    std::vector<float> values(static_cast<std::size_t>(pointCount(kCapDims)), 5.0f);
    values[static_cast<std::size_t>(4 + 9 * (6 + 13 * 3))] = kNone;
    const CapSamples cap = sampled({true, {0.0, 0.0, 1.0}, 0.0, Cap::Colour}, values); // through that point
    int unknown = 0;
    for (int row = 0; row < cap.plane.height; ++row)
        for (int column = 0; column < cap.plane.width; ++column) {
            const glm::dvec3 place = cap.plane.at(column, row);
            const glm::vec2 pixel = cap.pixels[static_cast<std::size_t>(row * cap.plane.width + column)];
            if (place != clampedPlace(place, volume()))
                continue; // continued by a pixel
            const bool isBeside = std::abs(place.x - 4.0) < 0.999 && std::abs(place.y - 6.0) < 0.999;
            if (isBeside) {
                EXPECT_EQ(pixel, glm::vec2(0.0f)) << place.x << " " << place.y;
                ++unknown;
            } else if (std::abs(place.x - 4.0) > 1.001 || std::abs(place.y - 6.0) > 1.001) {
                EXPECT_EQ(pixel, glm::vec2(5.0f, 1.0f)) << place.x << " " << place.y;
            }
        }
    EXPECT_GT(unknown, 0);
}

} // namespace
} // namespace isoslider::model
