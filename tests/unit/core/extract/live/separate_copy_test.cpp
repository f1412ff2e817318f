#include <gtest/gtest.h>

#include "core/extract/live/brick_picture.h"
#include "core/extract/slide_engine.h"
#include "preprocess/metacells/brick_list.h"
#include "tests/property/test_volumes.h"
#include "tests/support/result_matchers.h"

namespace isoslider::extract {
namespace {

using test::IsOk;

SurfaceFrame arraysOf(std::shared_ptr<const BrickPicture<float>> picture, double isovalue) {
    SurfaceFrame frame;
    frame.bricks = std::move(picture);
    frame.isovalue = isovalue;
    expandPicture(frame);
    return frame;
}

TEST(SeparateCopy, IsTheSameSurfaceAndStaysWhileTheLiveOneMovesOn) {
    const auto engine = preprocess::makeMemoryEngine(test::hillsVolume({48, 40, 44})).value();
    ASSERT_THAT(engine->slideTo(300.0), IsOk());
    SurfaceFrame frame;
    engine->copyFrame(frame);
    const SurfaceFrame before = arraysOf(frame.bricks, 300.0);
    ASSERT_GT(before.indices.size(), 300u);
    const auto copy = separateCopy(*frame.bricks);
    EXPECT_NE(copy->series(), frame.bricks->series());
    frame.bricks.reset(); // its memory is used again from here on
    for (const double isovalue : {320.0, 500.0, 310.0, 100.0})
        ASSERT_THAT(engine->slideTo(isovalue), IsOk());
    const SurfaceFrame after = arraysOf(copy, 300.0);
    EXPECT_EQ(after.positions, before.positions);
    EXPECT_EQ(after.normals, before.normals);
    EXPECT_EQ(after.indices, before.indices);
}

TEST(SeparateCopy, TakesNoMoreThanTheSurface) {
    const auto engine = preprocess::makeMemoryEngine(test::hillsVolume({48, 40, 44})).value();
    ASSERT_THAT(engine->slideTo(300.0), IsOk());
    SurfaceFrame frame;
    engine->copyFrame(frame);
    std::uint64_t bytes = 0;
    for (const PictureBrick& brick : frame.bricks->bricks())
        bytes += frame.bricks->bytesOf(brick, true, true);
    frame.bricks = separateCopy(*frame.bricks);
    EXPECT_LT(pictureBytes(frame), bytes + bytes / 4) << "runs are a little larger than what they hold";
}

} // namespace
} // namespace isoslider::extract
