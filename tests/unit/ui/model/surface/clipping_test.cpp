#include "ui/model/surface/clipping.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/matrix.hpp>

namespace isoslider::model {
namespace {

constexpr GridDims kDims{11, 21, 31};

/// Turned, mirrored, stretched and far from the origin.
GridGeometry awkwardVolume() {
    GridGeometry volume;
    volume.dims = kDims;
    volume.spacing = {0.5, 1.0, 2.5};
    volume.origin = {1e3, -2e3, 3e3};
    volume.direction = glm::dmat3(glm::rotate(glm::dmat4(1.0), 0.7, glm::normalize(glm::dvec3(1.0, 2.0, -1.0))));
    volume.direction[2] = -volume.direction[2];
    return volume;
}

GridGeometry previewOf(GridGeometry volume, std::int64_t step) {
    for (auto& dim : volume.dims)
        dim = (dim - 1) / step + 1;
    volume.spacing *= static_cast<double>(step);
    return volume;
}

glm::dmat4 toCentredWorld(const GridGeometry& volume) {
    glm::dmat4 map = volume.indexToWorld();
    const glm::dvec3 last(volume.dims[0] - 1, volume.dims[1] - 1, volume.dims[2] - 1);
    map[3] = glm::dvec4(-(glm::dmat3(map) * (0.5 * last)), 1.0);
    return map;
}

TEST(Clipping, ABoxIsBroughtWithinTheVolumeWithACellAtLeast) {
    EXPECT_EQ(cropWithin(std::nullopt, kDims), wholeBox(kDims));
    EXPECT_EQ(cropWithin(CropBox{{2, 3, 4}, {5, 6, 7}}, kDims), (CropBox{{2, 3, 4}, {5, 6, 7}}));
    EXPECT_EQ(cropWithin(CropBox{{-7, 99, 5}, {99, 99, 5}}, kDims), (CropBox{{0, 19, 5}, {10, 20, 6}}));
    constexpr auto kLeast = std::numeric_limits<std::int64_t>::min(), kMost = std::numeric_limits<std::int64_t>::max();
    EXPECT_EQ(cropWithin(CropBox{{kMost, kLeast, 0}, {kLeast, kMost, 0}}, kDims), (CropBox{{9, 0, 0}, {10, 20, 1}}));
}

TEST(Clipping, AFaceSnapsToGridPointsAndStopsBeforeTheOneOpposite) {
    const CropBox box{{2, 3, 4}, {8, 9, 10}};
    EXPECT_EQ(withFace(box, 0, false, 4.4, kDims).low[0], 4);
    EXPECT_EQ(withFace(box, 0, false, 4.6, kDims).low[0], 5);
    EXPECT_EQ(withFace(box, 0, false, 99.0, kDims).low[0], 7);
    EXPECT_EQ(withFace(box, 0, false, -99.0, kDims).low[0], 0);
    EXPECT_EQ(withFace(box, 2, true, 1e300, kDims).high[2], 30);
    EXPECT_EQ(withFace(box, 2, true, -1.0, kDims).high[2], 5);
    EXPECT_EQ(withFace(box, 1, true, std::nan(""), kDims), box);
    EXPECT_EQ(withFace(box, 1, true, 12.0, kDims), (CropBox{{2, 3, 4}, {8, 12, 10}})) << "the other faces stay";
}

TEST(Clipping, CutsAreNoneWhileNothingIsClipped) {
    Clipping clipping;
    clipping.crop = CropBox{{1, 1, 1}, {2, 2, 2}};
    EXPECT_TRUE(cutsOf(clipping, awkwardVolume(), awkwardVolume()).empty());
}

TEST(Clipping, CutsHoldExactlyWhatLiesInTheBoxAndBehindThePlanes) {
    const GridGeometry volume = awkwardVolume();
    Clipping clipping;
    clipping.isCropped = true;
    clipping.crop = CropBox{{2, 3, 4}, {8, 19, 25}};
    clipping.plane() = {true, glm::normalize(glm::dvec3(1.0, -2.0, 0.5)), 0.75, Cap::None};
    clipping.planes[1] = {true, glm::normalize(glm::dvec3(-1.0, 1.0, 3.0)), 4.0, Cap::Colour};
    const glm::dmat4 toWorld = toCentredWorld(volume);
    std::mt19937 random(3);
    std::uniform_real_distribution<double> share(-0.1, 1.1);
    for (const std::int64_t step : {1, 3}) {
        const auto cuts = cutsOf(clipping, previewOf(volume, step), volume);
        ASSERT_EQ(cuts.size(), kMostCuts);
        int within = 0;
        for (int i = 0; i < 4000; ++i) {
            const glm::dvec3 place(10.0 * share(random), 20.0 * share(random), 30.0 * share(random));
            const bool isInBox =
                place.x >= 2 && place.x <= 8 && place.y >= 3 && place.y <= 19 && place.z >= 4 && place.z <= 25;
            const glm::dvec3 world(toWorld * glm::dvec4(place, 1.0));
            const bool isKept = isInBox && std::ranges::all_of(clipping.planes, [&](const ClipPlane& plane) {
                                    return glm::dot(plane.normal, world) <= plane.offset;
                                });
            EXPECT_EQ(isWithin(cuts, place / static_cast<double>(step)), isKept);
            within += isKept;
        }
        EXPECT_GT(within, 200) << "the test shows something";
        EXPECT_LT(within, 3000);
    }
}

TEST(Clipping, CutsOfAnotherVolumeInTheSameSpaceAreAtTheSamePlaces) {
    const GridGeometry volume = awkwardVolume();
    GridGeometry other = volume;
    other.dims = {7, 9, 5};
    other.spacing = {2.0, 0.5, 1.25};
    other.origin += glm::dvec3(3.0, -1.0, 2.0);
    std::swap(other.direction[0], other.direction[2]);
    Clipping clipping;
    clipping.isCropped = true;
    clipping.crop = CropBox{{2, 3, 4}, {8, 19, 25}};
    clipping.plane() = {true, glm::normalize(glm::dvec3(1.0, -2.0, 0.5)), 0.75, Cap::None};
    clipping.planes[1] = {true, {0.0, 0.6, 0.8}, 3.0, Cap::None};
    const auto cuts = cutsOf(clipping, volume, volume), ofOther = cutsOf(clipping, other, volume);
    ASSERT_EQ(ofOther.size(), kMostCuts);
    const glm::dmat4 toOther = glm::inverse(other.indexToWorld()) * volume.indexToWorld();
    std::mt19937 random(4);
    std::uniform_real_distribution<double> share(-0.1, 1.1);
    int within = 0;
    for (int i = 0; i < 4000; ++i) {
        const glm::dvec3 place(10.0 * share(random), 20.0 * share(random), 30.0 * share(random));
        const bool isKept = isWithin(cuts, place);
        EXPECT_EQ(isWithin(ofOther, glm::dvec3(toOther * glm::dvec4(place, 1.0))), isKept);
        within += isKept;
    }
    EXPECT_GT(within, 300);
    EXPECT_LT(within, 3000);
}

TEST(Clipping, PlacesOnTheFacesAreWithin) {
    Clipping clipping;
    clipping.isCropped = true;
    clipping.crop = CropBox{{2, 3, 4}, {8, 19, 25}};
    const auto cuts = cutsOf(clipping, awkwardVolume(), awkwardVolume());
    EXPECT_TRUE(isWithin(cuts, {2, 3, 4}));
    EXPECT_TRUE(isWithin(cuts, {8, 19, 25}));
    EXPECT_FALSE(isWithin(cuts, {std::nextafter(2.0, 0.0), 3, 4}));
    EXPECT_TRUE(isWithin({}, {1e300, 0, 0}));
}

TEST(Clipping, OfALineOfSightIsLeftWhatLiesWithin) {
    const std::vector<glm::dvec4> cuts{{1, 0, 0, -2}, {-1, 0, 0, 5}};
    const auto part = partWithin(cuts, {0, 1, 1}, {10, 1, 1});
    ASSERT_TRUE(part);
    EXPECT_NEAR(part->first.x, 2.0, 1e-12);
    EXPECT_NEAR(part->second.x, 5.0, 1e-12);
    const auto back = partWithin(cuts, {10, 1, 1}, {0, 1, 1});
    ASSERT_TRUE(back);
    EXPECT_NEAR(back->first.x, 5.0, 1e-12);
    EXPECT_NEAR(back->second.x, 2.0, 1e-12);
    EXPECT_FALSE(partWithin(cuts, {6, 0, 0}, {10, 0, 0}));
    EXPECT_FALSE(partWithin(cuts, {0, 0, 0}, {1, 9, 9}));
    EXPECT_EQ(partWithin({}, {0, 0, 0}, {1, 9, 9})->second, glm::dvec3(1, 9, 9));
}

TEST(Clipping, APlaneStaysOnTheVolumeAndHasAUnitNormal) {
    const GridGeometry volume = awkwardVolume();
    const ClipPlane plane = planeWithin({true, {3.0, 4.0, 0.0}, 1e9, Cap::Values}, volume);
    EXPECT_NEAR(glm::length(plane.normal), 1.0, 1e-12);
    EXPECT_NEAR(plane.offset, reachAlong(plane.normal, volume), 1e-12);
    EXPECT_EQ(planeWithin(plane, volume), plane) << "again and again";
    const double infinity = std::numeric_limits<double>::infinity();
    for (const glm::dvec3& normal : {glm::dvec3(0.0), glm::dvec3(infinity, 0.0, 0.0), glm::dvec3(std::nan(""))}) {
        const ClipPlane found = planeWithin({true, normal, std::nan(""), Cap::None}, volume);
        EXPECT_NEAR(glm::length(found.normal), 1.0, 1e-12);
        EXPECT_EQ(found.offset, 0.0);
    }
    // The farthest corner is as far as the reach, no farther.
    const glm::dmat4 toWorld = toCentredWorld(volume);
    double farthest = 0.0;
    for (int corner = 0; corner < 8; ++corner)
        farthest = std::max(farthest,
                            glm::dot(plane.normal, glm::dvec3(toWorld * glm::dvec4(10 * (corner & 1), 10 * (corner & 2),
                                                                                   30 * (corner >> 2), 1.0))));
    EXPECT_NEAR(farthest, reachAlong(plane.normal, volume), 1e-9);
}

TEST(Clipping, TurningKeepsAPlaceOnThePlaneAndFlippingThePlane) {
    const ClipPlane plane{true, {0.0, 0.0, 1.0}, 2.0, Cap::None};
    const ClipPlane turned = turnedTo(plane, {1.0, 1.0, 0.0}, {5.0, 6.0, 2.0});
    EXPECT_NEAR(glm::dot(turned.normal, glm::dvec3(5.0, 6.0, 2.0)), turned.offset, 1e-12);
    EXPECT_EQ(turnedTo(plane, glm::dvec3(0.0), glm::dvec3(0.0)).normal, plane.normal) << "no direction";
    const ClipPlane back = flipped(plane);
    EXPECT_EQ(back.normal, glm::dvec3(0.0, 0.0, -1.0));
    EXPECT_EQ(back.offset, -2.0);
    EXPECT_EQ(flipped(back), plane);
}

} // namespace
} // namespace isoslider::model
