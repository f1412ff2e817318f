// What is drawn stretched: which stretch is suggested, and what the camera makes of it.
#include "ui/model/surface/stage.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/vec4.hpp>

#include "ui/model/surface/camera.h"

namespace isoslider::model {
namespace {

GridGeometry gridOf(const GridDims& dims, const glm::dvec3& spacing) {
    GridGeometry geometry;
    geometry.dims = dims;
    geometry.spacing = spacing;
    return geometry;
}

glm::dmat3 turned() { return glm::mat3_cast(glm::angleAxis(0.7, glm::normalize(glm::dvec3(1.0, 2.0, -0.5)))); }

void expectSamePlace(const glm::dvec3& a, const glm::dvec3& b) {
    EXPECT_LT(glm::length(a - b), 1e-9) << a.x << ' ' << a.y << ' ' << a.z << " against " << b.x << ' ' << b.y << ' '
                                        << b.z;
}

TEST(StretchTest, IsSuggestedWhereAxesHaveOtherUnits) {
    // Degrees by metres.
    const auto ocean = suggestedStretch(gridOf({121, 81, 41}, {3.0, 1.5, 125.0}));
    ASSERT_TRUE(ocean);
    EXPECT_EQ(*ocean, glm::dvec3(1.0, 1.0, 0.1)); // 360 by 120 by 500
    const auto plate = suggestedStretch(gridOf({201, 201, 31}, {1000.0, 1000.0, 10.0}));
    ASSERT_TRUE(plate);
    EXPECT_EQ(*plate, glm::dvec3(1.0, 1.0, 500.0)); // 200 km by 200 km by 150 km
    const auto shallow = suggestedStretch(gridOf({180, 90, 19}, {2.0, 2.0, 1000.0 / 18.0}));
    ASSERT_TRUE(shallow) << "358 by 178 by 1000 m";
    EXPECT_EQ(*shallow, glm::dvec3(1.0, 1.0, 0.5));
    for (int axis = 0; axis < 3; ++axis) { // wherever the long side is
        GridDims dims{100, 100, 100};
        glm::dvec3 spacing(1.0);
        spacing[axis] = 50.0;
        const auto stretch = suggestedStretch(gridOf(dims, spacing));
        ASSERT_TRUE(stretch);
        EXPECT_EQ((*stretch)[axis], 0.02);
    }
}

TEST(StretchTest, IsNotSuggestedWhereTheBoxIsAsItIsMeant) {
    EXPECT_FALSE(suggestedStretch(gridOf({256, 256, 256}, {1.0, 1.0, 1.0})));
    EXPECT_FALSE(suggestedStretch(gridOf({512, 512, 60}, {0.5, 0.5, 5.0}))) << "thick slices of a body";
    EXPECT_FALSE(suggestedStretch(gridOf({512, 512, 300}, {0.5, 0.5, 5.0}))) << "a whole body"
                                                                                " in thick slices";
    EXPECT_FALSE(suggestedStretch(gridOf({2000, 2000, 20}, {1.0, 1.0, 1.0}))) << "a plate of equal cells";
    EXPECT_FALSE(suggestedStretch(gridOf({100, 100, 1}, {1.0, 1.0, 1000.0}))) << "no third side";
    const double endless = std::numeric_limits<double>::infinity();
    EXPECT_FALSE(suggestedStretch(gridOf({100, 100, 100}, {1.0, 1.0, endless})));
    const auto extreme = suggestedStretch(gridOf({100, 100, 100}, {1.0, 1.0, 1e9}));
    ASSERT_TRUE(extreme);
    EXPECT_EQ(extreme->z, 1.0 / kMostStretch) << "within the bounds";
}

TEST(StretchTest, IsBroughtWithinItsBounds) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(stretchWithin({2.0, 1e9, 1e-9}), glm::dvec3(2.0, kMostStretch, 1.0 / kMostStretch));
    EXPECT_EQ(stretchWithin({nan, -1.0, 0.0}), glm::dvec3(1.0));
}

TEST(StretchTest, IsToldInWords) {
    EXPECT_EQ(stretchText(glm::dvec3(1.0)), "");
    EXPECT_EQ(stretchText({20.0, 1.0, 0.5}), "X × 20, Z × 0.5");
}

TEST(StretchTest, GoesAlongTheAxesOfTheGrid) {
    GridGeometry geometry = gridOf({10, 20, 30}, {1.0, 2.0, 3.0});
    geometry.direction = turned();
    const glm::dvec3 stretch(2.0, 1.0, 0.25);
    const glm::dmat3 toShown = stretchMatrix(stretch, geometry);
    const glm::dmat3 shown(stretched(geometry, stretch).indexToWorld()), world(geometry.indexToWorld());
    for (int axis = 0; axis < 3; ++axis)
        expectSamePlace(toShown * world[axis], shown[axis]);
}

TEST(StretchedCameraTest, ShowsPlacesWhereTheStretchPutsThem) {
    GridGeometry geometry = gridOf({10, 20, 30}, {1.0, 2.0, 3.0});
    geometry.direction = turned();
    Camera plain, camera;
    plain.reset(40.0);
    camera.reset(40.0);
    const glm::dmat3 toShown = stretchMatrix({1.0, 3.0, 0.5}, geometry);
    camera.setStretch(toShown, 40.0);
    for (const glm::dvec3& place : {glm::dvec3(1.0, 2.0, 3.0), glm::dvec3(-5.0, 0.5, 9.0)})
        expectSamePlace(glm::dvec3(camera.viewMatrix() * glm::dvec4(place, 1.0)),
                        glm::dvec3(plain.viewMatrix() * glm::dvec4(toShown * place, 1.0)));
    // A normal stays perpendicular to the plane that it is of.
    const glm::dvec3 along(1.0, 2.0, 0.0), across(0.0, 1.0, 5.0), normal = glm::cross(along, across);
    const glm::dmat3 view(camera.viewMatrix());
    const glm::dvec3 seen = glm::normalize(camera.normalMatrix() * normal);
    EXPECT_NEAR(glm::dot(seen, glm::normalize(view * along)), 0.0, 1e-12);
    EXPECT_NEAR(glm::dot(seen, glm::normalize(view * across)), 0.0, 1e-12);
    expectSamePlace(glm::normalize(camera.normalMatrix() * camera.facingNormal()), {0.0, 0.0, 1.0});
    EXPECT_GT(glm::length(camera.facingNormal() - camera.backward()), 0.1);
}

TEST(StretchedCameraTest, KeepsWhatIsInTheMiddleAndHowMuchIsSeen) {
    Camera camera;
    camera.reset(10.0);
    camera.pan({0.3, -0.2}, 1.0);
    const glm::dvec3 middle = camera.target();
    const double distance = camera.distance();
    camera.setStretch(glm::dmat3(2.0), 20.0);
    expectSamePlace(camera.target(), 2.0 * middle);
    EXPECT_DOUBLE_EQ(camera.distance(), 2.0 * distance);
    camera.setStretch(glm::dmat3(1.0), 10.0);
    expectSamePlace(camera.target(), middle);
    EXPECT_DOUBLE_EQ(camera.distance(), distance);
    EXPECT_DOUBLE_EQ(camera.sceneRadius(), 10.0);
}

} // namespace
} // namespace isoslider::model
