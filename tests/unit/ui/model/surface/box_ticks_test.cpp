#include "ui/model/surface/box_ticks.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/matrix.hpp>

#include <gtest/gtest.h>

#include "ui/model/surface/camera.h"

namespace isoslider::model {
namespace {

constexpr double kSceneReach = 30.0;
const glm::dvec2 kViewPixels(900.0, 600.0);

GridGeometry volumeOf(const glm::dvec3& origin) {
    GridGeometry volume;
    volume.dims = {41, 31, 21};
    volume.spacing = {0.5, 1.0, 2.0};
    volume.origin = origin;
    return volume;
}

glm::dmat4 toScreen(const GridGeometry& volume, const Camera& camera) {
    const glm::dvec3 last(volume.dims[0] - 1, volume.dims[1] - 1, volume.dims[2] - 1);
    glm::dmat4 centred(glm::dmat3(volume.indexToWorld()));
    centred[3] = glm::dvec4(-(glm::dmat3(centred) * (0.5 * last)), 1.0);
    return camera.projectionMatrix(kViewPixels.x / kViewPixels.y) * camera.viewMatrix() * centred;
}

Camera cameraFrom(double right, double up) {
    Camera camera;
    camera.reset(kSceneReach);
    camera.orbit(right, up);
    return camera;
}

TEST(BoxTicks, StandWhereTheirValuesSay) {
    const GridGeometry volume = volumeOf({-3.25, 1000.0, 7.0});
    const auto edges = tickedEdges(volume, toScreen(volume, cameraFrom(0.0, 0.0)), kViewPixels);
    ASSERT_EQ(edges.size(), 3u);
    for (const TickedEdge& edge : edges) {
        EXPECT_TRUE(edge.isOfWorld);
        ASSERT_GE(edge.ticks.size(), 2u);
        const double step = edge.ticks[1].value - edge.ticks[0].value;
        for (std::size_t i = 0; i < edge.ticks.size(); ++i) {
            const glm::dvec3 world = volume.indexToWorld() * glm::dvec4(edge.ticks[i].place, 1.0);
            EXPECT_NEAR(world[edge.axis], edge.ticks[i].value, 1e-9);
            EXPECT_NEAR(edge.ticks[i].value / step, std::round(edge.ticks[i].value / step), 1e-9);
            if (i > 0) {
                EXPECT_NEAR(edge.ticks[i].value - edge.ticks[i - 1].value, step, 1e-9);
            }
        }
        const double digit = step / std::pow(10.0, std::floor(std::log10(step) + 1e-9));
        EXPECT_TRUE(std::abs(digit - 1.0) < 1e-9 || std::abs(digit - 2.0) < 1e-9 || std::abs(digit - 5.0) < 1e-9);
    }
}

TEST(BoxTicks, AnEdgeIsOnTheOutlineFromEveryDirection) {
    const GridGeometry volume = volumeOf({0.0, 0.0, 0.0});
    for (int turn = 0; turn < 24; ++turn) {
        const glm::dmat4 screen = toScreen(volume, cameraFrom(0.27 * turn, 0.11 * turn));
        const auto place = [&](const glm::dvec3& index) {
            const glm::dvec4 clip = screen * glm::dvec4(index, 1.0);
            return glm::dvec2(clip) / clip.w;
        };
        for (const TickedEdge& edge : tickedEdges(volume, screen, kViewPixels)) {
            const glm::dvec2 from = place(edge.from), along = place(edge.to) - from;
            int left = 0, right = 0;
            for (int corner = 0; corner < 8; ++corner) {
                const glm::dvec2 away =
                    place({(corner & 1) * 40.0, (corner >> 1 & 1) * 30.0, (corner >> 2) * 20.0}) - from;
                const double side = along.x * away.y - along.y * away.x;
                left += side > 1e-9;
                right += side < -1e-9;
            }
            EXPECT_TRUE(left == 0 || right == 0) << turn;
            EXPECT_EQ(std::max(left, right), 6) << turn;
        }
    }
}

TEST(BoxTicks, OfATurnedGridAreLengthsFromItsFirstPoint) {
    GridGeometry volume = volumeOf({50.0, 60.0, 70.0});
    volume.direction = glm::dmat3(glm::rotate(glm::dmat4(1.0), 0.4, glm::dvec3(0.0, 0.0, 1.0)));
    for (const TickedEdge& edge : tickedEdges(volume, toScreen(volume, cameraFrom(0.0, 0.0)), kViewPixels)) {
        EXPECT_EQ(edge.isOfWorld, edge.axis == 2);
        if (!edge.isOfWorld) {
            EXPECT_EQ(edge.ticks.front().value, 0.0);
        }
    }
    // Axes that change places, one of them backwards, are still those of the world.
    volume.direction = glm::dmat3(glm::dvec3(0, -1, 0), glm::dvec3(1, 0, 0), glm::dvec3(0, 0, 1));
    for (const TickedEdge& edge : tickedEdges(volume, toScreen(volume, cameraFrom(0.0, 0.0)), kViewPixels)) {
        EXPECT_TRUE(edge.isOfWorld);
        for (const auto& tick : edge.ticks)
            EXPECT_NEAR(glm::dvec3(volume.indexToWorld() * glm::dvec4(tick.place, 1.0))[edge.axis], tick.value, 1e-9);
    }
}

TEST(BoxTicks, AreNoneWhereTheyCannotBeRead) {
    const GridGeometry volume = volumeOf({1e18, 0.0, 0.0});
    for (const TickedEdge& edge : tickedEdges(volume, toScreen(volume, cameraFrom(0.0, 0.0)), kViewPixels))
        if (edge.axis == 0) {
            EXPECT_TRUE(edge.ticks.empty()) << "all digits are the origin's";
        }
    Camera inside = cameraFrom(0.0, 0.0);
    inside.zoom(1e3, {0.0, 0.0}, 1.5);
    EXPECT_TRUE(tickedEdges(volume, toScreen(volume, inside), kViewPixels).empty()) << "the viewer is in the box";
    Camera front = cameraFrom(0.0, 0.0);
    front.setStandardView(StandardView::Front);
    front.setPerspective(false);
    EXPECT_EQ(tickedEdges(volumeOf({0, 0, 0}), toScreen(volumeOf({0, 0, 0}), front), kViewPixels).size(), 2u)
        << "none along the line of sight";
}

} // namespace
} // namespace isoslider::model
