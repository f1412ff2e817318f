// Who asks for pictures never waits for them: a draft comes first, the newest view wins, and at rest it is whole.
#include <QElapsedTimer>
#include <QThread>

#include <gtest/gtest.h>

#include "ui/render/gl_support.h"
#include "ui/render/scene_thread.h"

namespace isoslider::test {
namespace {

using render::SceneThread;

class SceneThreadTest : public ::testing::Test {
protected:
    void SetUp() override {
        if (!render::isOpenGlUsable() || !render::isOpenGlSoftware())
            GTEST_SKIP() << "only the processor takes long enough for a picture without a surface";
        view_.pixels = {3000, 2400}; // some 100 ms
        scene_ = std::make_unique<SceneThread>(nullptr, std::make_shared<render::GlDriver>(), [] {});
        scene_->waitFor(scene_->ask(view_));
        ASSERT_TRUE(scene_->isWorking());
    }
    /// The first picture of this view, or of a newer one, that comes.
    SceneThread::Picture firstOf(std::uint64_t serial) {
        QElapsedTimer clock;
        clock.start();
        SceneThread::Picture picture;
        while ((picture = scene_->take()).serial < serial && clock.elapsed() < 20'000)
            QThread::msleep(1);
        return picture;
    }

    render::SceneView view_;
    std::unique_ptr<SceneThread> scene_;
};

TEST_F(SceneThreadTest, ADraftComesFirstAndThenAllOfIt) {
    const std::uint64_t serial = scene_->ask(view_);
    EXPECT_TRUE(scene_->isBehind());
    const auto draft = firstOf(serial);
    EXPECT_EQ(draft.serial, serial);
    EXPECT_TRUE(draft.isDraft);
    EXPECT_EQ(draft.image.size(), QSize(3000, 2400)) << "drawn smaller, and stretched";
    EXPECT_FALSE(scene_->isBehind()) << "what follows gives way";
    scene_->waitFor(serial);
    EXPECT_EQ(scene_->take().serial, serial);
    EXPECT_FALSE(scene_->take().isDraft);
}

TEST_F(SceneThreadTest, OfManyViewsTheNewestIsDrawnAndAskingTakesNoTime) {
    QElapsedTimer clock;
    clock.start();
    std::uint64_t last = 0;
    for (int i = 0; i < 200; ++i)
        last = scene_->ask(view_);
    EXPECT_LT(clock.elapsed(), 2000) << "200 pictures take longer than that";
    scene_->waitFor(last);
    EXPECT_EQ(scene_->take().serial, last);
    EXPECT_LT(clock.elapsed(), 10'000);
}

TEST_F(SceneThreadTest, WhatMustBeWholeHasNoDraft) {
    const std::uint64_t serial = scene_->ask(view_, {.mustBeWhole = true});
    EXPECT_FALSE(firstOf(serial).isDraft);
}

TEST_F(SceneThreadTest, AnOrderedPictureIsThatOfItsView) {
    view_.pixels = {300, 240};
    const auto shown = scene_->ask(view_, {.mustBeWhole = true, .asImage = true});
    scene_->waitFor(shown);
    const QImage expected = scene_->take().image;
    const auto order = std::make_shared<render::PictureOrder>(view_);
    scene_->order(order);
    const auto picture = order->waitFor(std::chrono::seconds(20));
    ASSERT_TRUE(picture);
    EXPECT_EQ(*picture, expected);
    EXPECT_EQ(scene_->take().serial, shown) << "nobody is shown it";
}

TEST_F(SceneThreadTest, AnOrderedPictureGivesWayButIsDrawnInTheEnd) {
    const auto order = std::make_shared<render::PictureOrder>(view_);
    scene_->order(order);
    QElapsedTimer clock;
    clock.start();
    std::optional<QImage> picture;
    std::uint64_t last = 0;
    while (!picture && clock.elapsed() < 20'000) { // as while the handle is dragged
        last = scene_->ask(view_);
        picture = order->waitFor(std::chrono::milliseconds(20));
    }
    ASSERT_TRUE(picture);
    EXPECT_FALSE(picture->isNull());
    EXPECT_GE(order->fraction(), 0.0);
    scene_->waitFor(last);
    EXPECT_EQ(scene_->take().serial, last);
}

TEST_F(SceneThreadTest, AnOrderedPictureCanBeCancelled) {
    const auto order = std::make_shared<render::PictureOrder>(view_);
    order->cancel();
    scene_->order(order);
    const auto picture = order->waitFor(std::chrono::seconds(20));
    ASSERT_TRUE(picture);
    EXPECT_TRUE(picture->isNull());
}

TEST_F(SceneThreadTest, WhatWasOrderedIsDrawnBeforeTheEnd) {
    const auto order = std::make_shared<render::PictureOrder>(view_);
    scene_->order(order);
    scene_.reset();
    const auto picture = order->waitFor(std::chrono::milliseconds(0));
    ASSERT_TRUE(picture);
    EXPECT_EQ(picture->size(), QSize(3000, 2400));
}

} // namespace
} // namespace isoslider::test
