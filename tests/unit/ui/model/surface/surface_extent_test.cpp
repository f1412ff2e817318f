#include "ui/model/surface/surface_extent.h"

#include <array>

#include <gtest/gtest.h>

#include <glm/geometric.hpp>

#include "core/extract/live/brick_picture.h"
#include "preprocess/metacells/brick_list.h"
#include "tests/support/result_matchers.h"

namespace isoslider::model {
namespace {

using test::HasError;
using test::IsOk;

constexpr glm::dvec3 kLarge(12.0, 20.0, 16.0), kSmall(33.0, 20.0, 16.0);

/// Distances from two balls: at 0 their radii are 7 and 3 cells. Spacing is not the same along all axes.
std::shared_ptr<const ScalarGrid> twoBalls() {
    GridGeometry geometry;
    geometry.dims = {42, 36, 34};
    geometry.spacing = {1.0, 2.0, 0.5};
    std::vector<float> values;
    for (int z = 0; z < 34; ++z)
        for (int y = 0; y < 36; ++y)
            for (int x = 0; x < 42; ++x) {
                const glm::dvec3 place(x, y, z);
                values.push_back(
                    static_cast<float>(std::max(7.0 - glm::length(place - kLarge), 3.0 - glm::length(place - kSmall))));
            }
    return std::make_shared<const ScalarGrid>(ScalarGrid::fromValues<float>(geometry, ScalarType::F32, values));
}

class SurfaceExtentTest : public ::testing::Test {
protected:
    SurfaceExtentTest() : engine_(preprocess::makeMemoryEngine(twoBalls()).value()) {}
    extract::SurfaceFrame frameAt(double isovalue) {
        EXPECT_THAT(engine_->slideTo(isovalue), IsOk());
        extract::SurfaceFrame frame;
        engine_->copyFrame(frame, {.pieces = true});
        return frame;
    }
    std::unique_ptr<extract::SlideEngine> engine_;
};

void expectExtent(const SurfaceExtent& found, glm::dvec3 middle, double radius, double tolerance) {
    EXPECT_LE(glm::length(found.middle - middle), tolerance)
        << found.middle.x << ' ' << found.middle.y << ' ' << found.middle.z;
    EXPECT_NEAR(found.radius, radius, tolerance);
}

TEST_F(SurfaceExtentTest, HoldsBothBalls) {
    const auto frame = frameAt(0.0);
    ASSERT_NE(frame.bricks, nullptr);
    const auto found = extentOf(frame).value();
    ASSERT_TRUE(found);
    // From 5 to 36 along x; the farthest vertex is one of the large ball, nearly 2 * 7 away along y.
    EXPECT_NEAR(found->middle.x, 20.5, 0.05);
    EXPECT_NEAR(found->middle.y, 20.0, 0.05);
    EXPECT_GT(found->radius, 15.5);
    EXPECT_LT(found->radius, 18.0);

    auto arrays = frame;
    extract::expandPicture(arrays);
    ASSERT_EQ(arrays.bricks, nullptr);
    const auto same = extentOf(arrays).value();
    ASSERT_TRUE(same);
    expectExtent(*same, found->middle, found->radius, 1e-5);
}

TEST_F(SurfaceExtentTest, LeavesOutWhatIsClipped) {
    const auto frame = frameAt(0.0);
    const std::array<glm::dvec4, 1> right{glm::dvec4(1.0, 0.0, 0.0, -25.0)}, nothing{glm::dvec4(1.0, 0.0, 0.0, -41.0)};
    const auto small = extentOf(frame, {}, right).value();
    ASSERT_TRUE(small);
    expectExtent(*small, kSmall, 6.0, 0.1);
    EXPECT_FALSE(extentOf(frame, {}, nothing).value());
    PieceOptions largest;
    largest.largest = 1; // the ball that is clipped away
    EXPECT_FALSE(extentOf(frame, largest, right).value());
}

TEST_F(SurfaceExtentTest, FollowsTheSurfaceRatherThanTheVolume) {
    const auto found = extentOf(frameAt(4.0)).value(); // the large ball alone, of 3 cells
    ASSERT_TRUE(found);
    expectExtent(*found, kLarge, 6.0, 0.15);
}

TEST_F(SurfaceExtentTest, LeavesHiddenPiecesOut) {
    const auto frame = frameAt(0.0);
    ASSERT_NE(frame.pieces, nullptr);
    ASSERT_EQ(frame.pieces->pieces().size(), 2u);
    PieceOptions options;
    options.hidden = {frame.pieces->pieces()[0].id};
    const auto small = extentOf(frame, options).value();
    ASSERT_TRUE(small);
    expectExtent(*small, kSmall, 6.0, 0.6);
    options.hidden.push_back(frame.pieces->pieces()[1].id);
    EXPECT_FALSE(extentOf(frame, options).value());
}

TEST_F(SurfaceExtentTest, ThereIsNoneWithoutATriangleAndItCanBeStopped) {
    EXPECT_FALSE(extentOf(frameAt(50.0)).value());
    std::stop_source stop;
    stop.request_stop();
    JobControl job;
    job.stop = stop.get_token();
    EXPECT_THAT(extentOf(frameAt(0.0), {}, {}, job), HasError(ErrorCode::Cancelled));
}

} // namespace
} // namespace isoslider::model
