// Who asks for pictures never waits for them: a draft comes first, the newest view wins, and at rest it is whole.
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <QElapsedTimer>
#include <QPainter>
#include <QThread>

#include <gtest/gtest.h>

#include "preprocess/metacells/brick_list.h"
#include "tests/image/ball_frame.h"
#include "tests/support/result_matchers.h"
#include "ui/render/gl_support.h"
#include "ui/render/scene_renderer.h"
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

    /// What changes with an option in pictures of 300 x 240 times a scale: of pixels that lines touch in part, a part.
    double coverOf(bool& option, int scale, float lineWidth) {
        view_.pixels = glm::ivec2(300, 240) * scale;
        view_.lineWidth = lineWidth;
        std::array<QImage, 2> pictures;
        for (const bool isOn : {false, true}) {
            option = isOn;
            const auto order = std::make_shared<render::PictureOrder>(view_);
            scene_->order(order);
            pictures[isOn] = order->waitFor(std::chrono::seconds(20)).value_or(QImage());
        }
        double cover = 0.0;
        for (int y = 0; y < pictures[0].height(); ++y)
            for (int x = 0; x < pictures[0].width(); ++x)
                cover += std::abs(qGreen(pictures[0].pixel(x, y)) - qGreen(pictures[1].pixel(x, y)));
        return cover;
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

// Laid over any background, it is the picture with that background.
TEST_F(SceneThreadTest, AnOrderedPictureCanHaveNoBackground) {
    view_.pixels = {300, 240};
    view_.frame = sphereFrame(cubeGeometry(20), 7.0);
    view_.camera.reset(render::sceneRadius(view_.frame->geometry));
    view_.look.opacity = 0.5F; // part of what is behind comes through
    const auto ordered = [this](const render::SceneView& view, bool isTransparent) {
        const auto order = std::make_shared<render::PictureOrder>(view, isTransparent);
        scene_->order(order);
        return order->waitFor(std::chrono::seconds(20)).value_or(QImage());
    };
    const QImage transparent = ordered(view_, true);
    ASSERT_EQ(transparent.format(), QImage::Format_ARGB32_Premultiplied);
    EXPECT_EQ(qAlpha(transparent.pixel(2, 2)), 0);
    int partly = 0, most = 0;
    for (int y = 0; y < transparent.height(); ++y)
        for (int x = 0; x < transparent.width(); ++x) {
            partly += qAlpha(transparent.pixel(x, y)) > 90 && qAlpha(transparent.pixel(x, y)) < 230;
            most = std::max(most, qAlpha(transparent.pixel(x, y)));
        }
    EXPECT_GT(partly, 1000);
    EXPECT_GT(most, 120);
    for (const QColor& behind : {QColor(0, 0, 0), QColor(255, 255, 255), QColor(40, 160, 220)}) {
        QImage laid(transparent.size(), QImage::Format_RGB32);
        laid.fill(behind);
        QPainter(&laid).drawImage(0, 0, transparent);
        render::SceneView view = view_;
        view.plainBackground = glm::vec3(behind.redF(), behind.greenF(), behind.blueF());
        const QImage expected = ordered(view, false);
        ASSERT_EQ(expected.size(), laid.size());
        int largest = 0;
        for (int y = 0; y < laid.height(); ++y)
            for (int x = 0; x < laid.width(); ++x)
                largest = std::max({largest, std::abs(qRed(laid.pixel(x, y)) - qRed(expected.pixel(x, y))),
                                    std::abs(qGreen(laid.pixel(x, y)) - qGreen(expected.pixel(x, y))),
                                    std::abs(qBlue(laid.pixel(x, y)) - qBlue(expected.pixel(x, y)))});
        EXPECT_LE(largest, 4) << behind.name().toStdString();
    }
}

// A picture four times as large has lines four times as wide, before the surface, behind it and seen through it.
TEST_F(SceneThreadTest, LinesOfAnOrderedPictureAreAsWideAsAskedFor) {
    view_.frame = sphereFrame(cubeGeometry(20), 7.0);
    view_.camera.reset(render::sceneRadius(view_.frame->geometry));
    for (const float opacity : {1.0F, 0.5F}) {
        SCOPED_TRACE(opacity);
        view_.look.opacity = opacity;
        bool& lines = view_.options.showsBox;
        const double once = coverOf(lines, 1, 1.0F), thin = coverOf(lines, 4, 1.0F), wide = coverOf(lines, 4, 4.0F);
        EXPECT_GT(once, 10'000.0);
        EXPECT_NEAR(thin / once, 4.0, 0.4);
        EXPECT_NEAR(wide / thin, 4.0, 0.4);
    }
}

// So has triangles' edges, whether the surface comes as arrays or as bricks; those behind stay hidden.
TEST_F(SceneThreadTest, TriangleEdgesOfAnOrderedPictureAreAsWideAsAskedFor) {
    const GridGeometry plain = cubeGeometry(20);
    GridGeometry mirrored = plain;
    mirrored.direction[0] = {-1.0, 0.0, 0.0};
    const auto engine = preprocess::makeMemoryEngine(std::make_shared<const ScalarGrid>(ballGrid(plain)));
    ASSERT_THAT(engine, IsOk());
    ASSERT_THAT(engine.value()->slideTo(-7.0), IsOk());
    const auto ofBricks = std::make_shared<extract::SurfaceFrame>();
    engine.value()->copyFrame(*ofBricks);
    view_.camera.reset(render::sceneRadius(plain));
    bool& edges = view_.options.showsEdges;
    for (const auto& frame : {sphereFrame(plain, 7.0), sphereFrame(mirrored, 7.0), ofBricks}) {
        view_.frame = frame;
        const double once = coverOf(edges, 1, 1.0F), thin = coverOf(edges, 4, 1.0F), wide = coverOf(edges, 4, 4.0F);
        EXPECT_GT(once, 100'000.0);
        EXPECT_LT(thin / once, 6.5) << "at once many lie beside each other";
        EXPECT_NEAR(wide / once, 16.0, 2.0);
    }
}

TEST_F(SceneThreadTest, WhatIsLargerThanTheCardDrawsIsNotDrawn) {
    view_.pixels = {1'000'000, 8};
    const auto order = std::make_shared<render::PictureOrder>(view_);
    scene_->order(order);
    const auto picture = order->waitFor(std::chrono::seconds(20));
    ASSERT_TRUE(picture);
    EXPECT_TRUE(picture->isNull());
    view_.pixels = {300, 240};
    const auto next = std::make_shared<render::PictureOrder>(view_);
    scene_->order(next);
    EXPECT_EQ(next->waitFor(std::chrono::seconds(20)).value_or(QImage()).size(), QSize(300, 240));
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
