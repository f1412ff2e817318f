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

} // namespace
} // namespace isoslider::test
