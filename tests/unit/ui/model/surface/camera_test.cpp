#include "ui/model/surface/camera.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include <glm/geometric.hpp>
#include <glm/vec4.hpp>

namespace isoslider::model {
namespace {

constexpr double kAspect = 1.6;

/// Place in [-1, 1]^3 of a world point.
glm::dvec3 project(const Camera& camera, glm::dvec3 point) {
    const glm::dvec4 clip = camera.projectionMatrix(kAspect) * camera.viewMatrix() * glm::dvec4(point, 1.0);
    return glm::dvec3(clip) / clip.w;
}

void expectNear(glm::dvec3 a, glm::dvec3 b, double tolerance = 1e-9) {
    EXPECT_LE(glm::length(a - b), tolerance)
        << a.x << ' ' << a.y << ' ' << a.z << " against " << b.x << ' ' << b.y << ' ' << b.z;
}

class CameraTest : public ::testing::TestWithParam<bool> {
protected:
    CameraTest() {
        camera_.reset(10.0);
        camera_.setPerspective(GetParam());
    }
    Camera camera_;
};

TEST_P(CameraTest, APatientIsSeenFromTheFrontHeadUp) {
    camera_.reset(10.0, true);
    expectNear(camera_.backward(), {0.0, -1.0, 0.0});
    expectNear(camera_.up(), {0.0, 0.0, 1.0});
    EXPECT_EQ(camera_.target(), glm::dvec3(0.0));
}

TEST_P(CameraTest, ResetShowsTheWholeSphere) {
    for (const glm::dvec3 direction : {camera_.right(), camera_.up(), -camera_.right(), -camera_.up()}) {
        const auto place = project(camera_, direction * 9.0);
        EXPECT_LT(std::abs(place.x), 1.0);
        EXPECT_LT(std::abs(place.y), 1.0);
    }
    expectNear(project(camera_, {0, 0, 0}) * glm::dvec3(1, 1, 0), {0, 0, 0});
}

TEST_P(CameraTest, ABallIsShownWholeInAViewOfAnyAspect) {
    const glm::dvec3 middle(2.0, -3.0, 1.0);
    for (const double aspect : {0.3, 1.0, 2.5}) {
        const auto before = camera_.orientation();
        ASSERT_TRUE(camera_.setPose(camera_.poseAround(middle, 2.0, aspect)));
        EXPECT_EQ(camera_.orientation(), before);
        double farthest = 0.0;
        for (int step = 0; step < 360; ++step) {
            const double angle = step * 0.017453292519943295;
            // The ball's outline as an eye sees it lies before its middle, and is smaller than its equator.
            const double lift = camera_.isPerspective() ? 2.0 / camera_.distance() : 0.0;
            const auto rim = camera_.right() * std::cos(angle) + camera_.up() * std::sin(angle);
            const auto point = middle + 2.0 * (std::sqrt(1.0 - lift * lift) * rim + lift * camera_.backward());
            const glm::dvec4 clip = camera_.projectionMatrix(aspect) * camera_.viewMatrix() * glm::dvec4(point, 1.0);
            farthest = std::max({farthest, std::abs(clip.x / clip.w), std::abs(clip.y / clip.w)});
        }
        EXPECT_LT(farthest, 1.0) << aspect;
        EXPECT_GT(farthest, 0.9) << aspect << ": as large as it fits";
    }
}

TEST_P(CameraTest, OrbitTurnsAboutWhatWasFitted) {
    const glm::dvec3 middle(2.0, -3.0, 1.0);
    ASSERT_TRUE(camera_.setPose(camera_.poseAround(middle, 2.0, kAspect)));
    camera_.orbit(0.7, -0.4);
    expectNear(camera_.target(), middle);
    camera_.pan({0.2, 0.1}, kAspect); // aside, and it still is what stays in place
    const glm::dvec3 onScreen(1.0, 1.0, 0.0);
    const auto before = onScreen * project(camera_, middle);
    camera_.orbit(-0.3, 0.5);
    expectNear(onScreen * project(camera_, middle), before);
    ASSERT_TRUE(camera_.setPose(camera_.pose()));
    camera_.orbit(0.2, 0.2);
    expectNear(onScreen * project(camera_, middle), before);
    camera_.fit();
    camera_.orbit(0.7, -0.4);
    expectNear(camera_.target(), {0, 0, 0});
}

TEST_P(CameraTest, DepthOfTheSceneIsInRange) {
    for (const double along : {-1.0, 0.0, 1.0}) {
        const auto place = project(camera_, camera_.backward() * (10.0 * along));
        EXPECT_GT(place.z, -1.0);
        EXPECT_LT(place.z, 1.0);
    }
}

TEST_P(CameraTest, OrbitKeepsTheVolumeCentreInPlace) {
    camera_.pan({0.3, -0.2}, kAspect);
    const auto before = project(camera_, {0, 0, 0});
    camera_.orbit(0.7, -0.4);
    expectNear(project(camera_, {0, 0, 0}), before);
}

TEST_P(CameraTest, OrbitToTheRightTurnsTheNearSideToTheRight) {
    const glm::dvec3 near = camera_.backward() * 5.0;
    camera_.orbit(0.2, 0.0);
    EXPECT_GT(project(camera_, near).x, 0.0);
    const glm::dvec3 nearNow = camera_.backward() * 5.0;
    camera_.orbit(0.0, 0.2);
    EXPECT_GT(project(camera_, nearNow).y, 0.0);
}

TEST_P(CameraTest, PanMovesTheSceneWithThePointer) {
    const auto before = project(camera_, camera_.target());
    const auto point = camera_.target();
    camera_.pan({0.25, 0.1}, kAspect);
    expectNear(project(camera_, point) * glm::dvec3(1, 1, 0),
               (before + glm::dvec3(0.25, 0.1, 0)) * glm::dvec3(1, 1, 0));
}

TEST_P(CameraTest, ZoomKeepsThePointUnderThePointer) {
    const glm::dvec2 pointer(0.4, -0.3);
    const auto point =
        camera_.target() + (camera_.right() * (pointer.x * kAspect) + camera_.up() * pointer.y) * camera_.halfHeight();
    camera_.zoom(1.7, pointer, kAspect);
    const auto place = project(camera_, point);
    EXPECT_NEAR(place.x, pointer.x, 1e-9);
    EXPECT_NEAR(place.y, pointer.y, 1e-9);
}

TEST_P(CameraTest, ZoomStopsBeforeItBreaks) {
    for (int i = 0; i < 2000; ++i)
        camera_.zoom(1.5, {0, 0}, kAspect);
    EXPECT_GT(camera_.distance(), 0.0);
    for (int i = 0; i < 4000; ++i)
        camera_.zoom(1.0 / 1.5, {0, 0}, kAspect);
    EXPECT_TRUE(std::isfinite(project(camera_, {1, 1, 1}).x));
    const double distance = camera_.distance();
    camera_.zoom(-1.0, {0, 0}, kAspect);
    EXPECT_EQ(camera_.distance(), distance);
}

TEST_P(CameraTest, StandardViewsLookAlongTheAxes) {
    camera_.setStandardView(StandardView::Front);
    expectNear(camera_.backward(), {0, -1, 0});
    expectNear(camera_.right(), {1, 0, 0});
    expectNear(camera_.up(), {0, 0, 1});
    camera_.setStandardView(StandardView::Right);
    expectNear(camera_.backward(), {1, 0, 0});
    expectNear(camera_.up(), {0, 0, 1});
    camera_.setStandardView(StandardView::Top);
    expectNear(camera_.backward(), {0, 0, 1});
    expectNear(camera_.right(), {1, 0, 0});
    camera_.setStandardView(StandardView::Bottom);
    expectNear(camera_.backward(), {0, 0, -1});
}

TEST_P(CameraTest, NeverMirrors) {
    for (int i = 0; i < 100; ++i)
        camera_.orbit(0.37 * i, -0.21 * i);
    expectNear(glm::cross(camera_.right(), camera_.up()), camera_.backward());
}

TEST_P(CameraTest, B112_AViewWithoutWidthOrHeightHasAFiniteProjection) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    const auto expectFinite = [this](double aspect) {
        const glm::dmat4 all = camera_.projectionMatrix(aspect) * camera_.viewMatrix();
        for (int column = 0; column < 4; ++column)
            for (int row = 0; row < 4; ++row)
                EXPECT_TRUE(std::isfinite(static_cast<float>(all[column][row])))
                    << aspect << ' ' << column << ' ' << row;
    };
    for (const double aspect :
         {0.0, -0.0, -1.0, kInfinity, -kInfinity, std::nan(""), 5e-324, 1e300, 1.0 / 4320, 7680.0}) {
        expectFinite(aspect);
        camera_.pan({0.1, 0.1}, 1.0);
        camera_.orbit(0.1, 0.1);
        camera_.zoom(1.1, {0.5, 0.5}, 1.0);
        expectFinite(aspect);
    }
}

INSTANTIATE_TEST_SUITE_P(Projections, CameraTest, ::testing::Bool(),
                         [](const auto& projection) { return projection.param ? "Perspective" : "Orthographic"; });

TEST(Camera, ARadiusThatIsNoneStillGivesAPicture) {
    Camera camera;
    camera.reset(0.0);
    EXPECT_EQ(camera.sceneRadius(), 1.0);
}

TEST(Camera, TakesAPoseAgain) {
    Camera camera, other;
    camera.reset(10.0);
    camera.orbit(0.3, -0.8);
    camera.pan({0.2, 0.1}, 1.5);
    camera.setPerspective(false);
    other.reset(10.0);
    ASSERT_TRUE(other.setPose(camera.pose()));
    EXPECT_EQ(other.viewMatrix(), camera.viewMatrix());
    EXPECT_EQ(other.projectionMatrix(1.5), camera.projectionMatrix(1.5));
}

TEST(Camera, RefusesAPoseThatIsNone) {
    Camera camera;
    camera.reset(10.0);
    const auto before = camera.pose();
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (const auto& pose : {CameraPose{{0.0, 0.0, 0.0, 0.0}, {}, 1.0}, CameraPose{{1.0, nan, 0.0, 0.0}, {}, 1.0},
                             CameraPose{{1.0, 0.0, 0.0, 0.0}, {0.0, 1e308 * 10, 0.0}, 1.0},
                             CameraPose{{1.0, 0.0, 0.0, 0.0}, {}, 0.0}, CameraPose{{1.0, 0.0, 0.0, 0.0}, {}, nan}})
        EXPECT_FALSE(camera.setPose(pose));
    EXPECT_EQ(camera.pose().distance, before.distance);
    EXPECT_EQ(camera.pose().orientation, before.orientation);
    ASSERT_TRUE(camera.setPose({{2.0, 0.0, 0.0, 0.0}, {1e300, 0.0, 0.0}, 1e300}));
    EXPECT_EQ(camera.distance(), 1e4);
    EXPECT_EQ(camera.target().x, 1e4);
    EXPECT_NEAR(glm::length(camera.orientation()), 1.0, 1e-12);
}

TEST(Camera, GoesFromPoseToPoseWithoutAJump) {
    CameraPose from, to;
    from.target = {1.0, 2.0, 3.0};
    from.distance = 100.0;
    to.target = {5.0, 2.0, 3.0};
    to.distance = 1.0;
    to.orientation = glm::angleAxis(1.0, glm::dvec3(0.0, 0.0, 1.0));
    EXPECT_EQ(poseBetween(from, to, 0.0).target, from.target);
    EXPECT_NEAR(poseBetween(from, to, 0.0).distance, 100.0, 1e-9);
    EXPECT_EQ(poseBetween(from, to, 1.0).target, to.target);
    EXPECT_NEAR(poseBetween(from, to, 2.0).distance, 1.0, 1e-12) << "no farther than the end";
    const CameraPose middle = poseBetween(from, to, 0.5);
    EXPECT_EQ(middle.target.x, 3.0);
    EXPECT_NEAR(middle.distance, 10.0, 1e-9);
    EXPECT_NEAR(glm::angle(middle.orientation), 0.5, 1e-9);
}

} // namespace
} // namespace isoslider::model
