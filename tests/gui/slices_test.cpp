// Slices in the window: panes beside the 3-D view and planes in it, used with mouse, wheel and keys.
#include <cmath>
#include <filesystem>
#include <string>

#include <QAction>
#include <QMenu>
#include <QTest>
#include <QWheelEvent>

#include "core/volume_io/volume_reader.h"
#include "preprocess/build_index.h"
#include "tests/gui/faulty_driver.h"
#include "tests/gui/float_volume.h"
#include "tests/gui/window_fixture.h"
#include "tests/support/result_matchers.h"
#include "ui/model/slices/slice_model.h"
#include "ui/widgets/slices/slice_pane.h"
#include "ui/widgets/slices/slice_workspace.h"
#include "ui/widgets/viewport/viewport_host.h"
#include "ui/widgets/viewport/viewport_widget.h"
#include "ui/widgets/window/action_registry.h"
#include "ui/widgets/window/session_keeper.h"

namespace isoslider::test {
namespace {

using model::SliceKind;
using model::SliceLayout;

/// Every value states its place: x + 100 y + 10000 z. 20 x 16 x 12 samples, twice as far apart along z.
std::filesystem::path writeRamp(const TemporaryFolder& folder, const char* name = "ramp.mha") {
    return writeFloats(
        folder, name, {20, 16, 12}, [](int x, int y, int z) { return x + 100 * y + 10000 * z; },
        "ElementSpacing = 1 1 2\nDistanceUnits = mm\n");
}

class SlicesTest : public WindowTest {
protected:
    void open(const std::filesystem::path& path) {
        window_->openFile(QString::fromStdString(path.string()));
        ASSERT_TRUE(waitUntil([this] { return session_->frame() != nullptr; }));
        if (!builder_->holds) {
            ASSERT_TRUE(waitUntilSettled());
        }
    }
    void openRamp() { open(writeRamp(folder_)); }
    model::SliceModel& slices() { return window_->slices(); }
    const model::SliceOptions& options() { return slices().options(); }
    widgets::SlicePane& pane(SliceKind kind) { return window_->sliceWorkspace().pane(kind); }
    bool waitForSlices() {
        return waitUntil([this] { return session_->isSettled() && slices().isSettled(); });
    }
    void press(Qt::Key key, Qt::KeyboardModifiers modifiers = {}) { QTest::keyClick(window_.get(), key, modifiers); }
    QPoint at(SliceKind kind, const glm::dvec3& place) { return pane(kind).pointOf(place).toPoint(); }
    void wheel(QWidget& widget, QPoint point, int angle, Qt::KeyboardModifiers modifiers = {}) {
        QWheelEvent event(point, widget.mapToGlobal(QPointF(point)), {}, {0, angle}, Qt::NoButton, modifiers,
                          Qt::NoScrollPhase, false);
        QApplication::sendEvent(&widget, &event);
    }
    void drag(QWidget& widget, Qt::MouseButton button, QPoint from, QPoint to, Qt::KeyboardModifiers modifiers = {}) {
        QTest::mousePress(&widget, button, modifiers, from);
        for (int i = 1; i <= 4; ++i) {
            const QPointF point = from + (to - from) * (0.25 * i);
            QMouseEvent move(QEvent::MouseMove, point, widget.mapToGlobal(point), Qt::NoButton, button, modifiers);
            QApplication::sendEvent(&widget, &move);
        }
        QTest::mouseRelease(&widget, button, modifiers, to);
    }
    QString readingAt(SliceKind kind, const glm::dvec3& place) {
        const QPointF point = at(kind, place);
        QMouseEvent move(QEvent::MouseMove, point, pane(kind).mapToGlobal(point), Qt::NoButton, Qt::NoButton, {});
        QApplication::sendEvent(&pane(kind), &move);
        return pane(kind).readout();
    }
    bool isSeen(SliceKind kind) { return pane(kind).isVisible(); }
};

TEST_F(SlicesTest, LayoutsAreChosenByKey) {
    openRamp();
    EXPECT_EQ(options().layout, SliceLayout::None);
    for (const SliceKind kind : model::kSliceKinds)
        EXPECT_FALSE(isSeen(kind));
    press(Qt::Key_F6);
    EXPECT_TRUE(isSeen(SliceKind::Z));
    EXPECT_FALSE(isSeen(SliceKind::X) || isSeen(SliceKind::Y) || isSeen(SliceKind::Oblique));
    press(Qt::Key_X);
    EXPECT_TRUE(isSeen(SliceKind::X));
    EXPECT_FALSE(isSeen(SliceKind::Z));
    press(Qt::Key_O);
    EXPECT_TRUE(isSeen(SliceKind::Oblique));
    press(Qt::Key_F7);
    EXPECT_TRUE(isSeen(SliceKind::X) && isSeen(SliceKind::Y) && isSeen(SliceKind::Z));
    EXPECT_FALSE(isSeen(SliceKind::Oblique));
    press(Qt::Key_F8);
    QTest::qWait(20);
    const QSize view = window_->viewportHost().size();
    for (const SliceKind kind : {SliceKind::X, SliceKind::Y, SliceKind::Z}) {
        EXPECT_NEAR(pane(kind).width(), view.width(), 3);
        EXPECT_NEAR(pane(kind).height(), view.height(), 3);
    }
    EXPECT_TRUE(window_->actions().action("slices.four")->isChecked());
    EXPECT_TRUE(window_->viewportHost().isVisible());
    makeWindow(); // the next start
    EXPECT_EQ(options().layout, SliceLayout::Four);
    press(Qt::Key_F5);
    EXPECT_EQ(options().layout, SliceLayout::None);
}

TEST_F(SlicesTest, TheValueUnderThePointerIsThatOfTheSample) {
    openRamp();
    press(Qt::Key_F8);
    EXPECT_EQ(options().position, glm::dvec3(10.0, 8.0, 6.0)) << "the middle";
    ASSERT_TRUE(waitForSlices());
    EXPECT_EQ(readingAt(SliceKind::Z, {5.0, 7.0, 6.0}), QStringLiteral("60705   at (5, 7, 6)\n5, 7, 12 mm"));
    EXPECT_EQ(readingAt(SliceKind::Y, {19.0, 8.0, 11.0}), QStringLiteral("110819   at (19, 8, 11)\n19, 8, 22 mm"));
    EXPECT_EQ(readingAt(SliceKind::X, {10.0, 0.0, 0.0}), QStringLiteral("10   at (10, 0, 0)\n10, 0, 0 mm"));
    EXPECT_EQ(readingAt(SliceKind::X, {10.0, -4.0, 0.0}), QString()) << "outside";
    QEvent leave(QEvent::Leave);
    QApplication::sendEvent(&pane(SliceKind::X), &leave);
    EXPECT_EQ(pane(SliceKind::X).readout(), QString());
    EXPECT_EQ(pane(SliceKind::Z).caption(), QStringLiteral("Z = 12 mm (6 of 11)"));
}

TEST_F(SlicesTest, PixelsAreAsHighAndWideAsTheSpacingSays) {
    openRamp();
    press(Qt::Key_F8);
    const QPointF origin = pane(SliceKind::X).pointOf({10.0, 0.0, 0.0});
    const QPointF right = pane(SliceKind::X).pointOf({10.0, 1.0, 0.0}) - origin;
    const QPointF up = pane(SliceKind::X).pointOf({10.0, 0.0, 1.0}) - origin;
    EXPECT_GT(right.x(), 1.0);
    EXPECT_NEAR(up.y(), -2.0 * right.x(), 1e-6);
    EXPECT_NEAR(up.x(), 0.0, 1e-6);
    const QPointF down = pane(SliceKind::Z).pointOf({0.0, 1.0, 6.0}) - pane(SliceKind::Z).pointOf({0.0, 0.0, 6.0});
    EXPECT_GT(down.y(), 1.0);
}

TEST_F(SlicesTest, AClickMovesTheOtherSlices) {
    openRamp();
    press(Qt::Key_F8);
    ASSERT_TRUE(waitForSlices());
    QTest::mouseClick(&pane(SliceKind::Z), Qt::LeftButton, {}, at(SliceKind::Z, {3.2, 12.7, 6.0}));
    EXPECT_EQ(options().position, glm::dvec3(3.0, 13.0, 6.0)) << "at the nearest sample";
    drag(pane(SliceKind::X), Qt::LeftButton, at(SliceKind::X, {3.0, 5.0, 5.0}), at(SliceKind::X, {3.0, 9.0, 2.0}));
    EXPECT_EQ(options().position, glm::dvec3(3.0, 9.0, 2.0));
    ASSERT_TRUE(waitForSlices());
    EXPECT_EQ(readingAt(SliceKind::Y, {4.0, 9.0, 1.0}), QStringLiteral("10904   at (4, 9, 1)\n4, 9, 2 mm"));
    QTest::mouseClick(&pane(SliceKind::Z), Qt::LeftButton, {}, QPoint(2, 2));
    EXPECT_EQ(options().position.x, 0.0) << "a click outside stays within the volume";
    press(Qt::Key_C, Qt::ShiftModifier);
    EXPECT_EQ(options().position, glm::dvec3(10.0, 8.0, 6.0));
}

TEST_F(SlicesTest, TheWheelAndKeysGoThroughSlices) {
    openRamp();
    press(Qt::Key_F8);
    auto& z = pane(SliceKind::Z);
    wheel(z, z.rect().center(), 120);
    EXPECT_EQ(options().position.z, 7.0);
    wheel(z, z.rect().center(), -60);
    EXPECT_EQ(options().position.z, 7.0) << "half a notch of a touch pad";
    wheel(z, z.rect().center(), -60);
    EXPECT_EQ(options().position.z, 6.0);
    z.setFocus();
    QTest::keyClick(&z, Qt::Key_PageUp);
    EXPECT_EQ(options().position.z, 7.0);
    QTest::keyClick(&z, Qt::Key_PageDown, Qt::ShiftModifier);
    EXPECT_EQ(options().position.z, 0.0) << "ten back, but not past the end";
    QTest::keyClick(&z, Qt::Key_End);
    EXPECT_EQ(options().position.z, 11.0);
    QTest::keyClick(&z, Qt::Key_Home);
    EXPECT_EQ(options().position.z, 0.0);
    QTest::keyClick(&z, Qt::Key_Right);
    QTest::keyClick(&z, Qt::Key_Down);
    QTest::keyClick(&z, Qt::Key_Down);
    EXPECT_EQ(options().position, glm::dvec3(11.0, 10.0, 0.0));
    press(Qt::Key_Period);
    EXPECT_EQ(options().position.z, 1.0) << "the pane used last";
    pane(SliceKind::X).setFocus();
    press(Qt::Key_Comma);
    EXPECT_EQ(options().position.x, 10.0);
    ASSERT_TRUE(waitForSlices());
    EXPECT_EQ(slices().shades(SliceKind::Z)->plane.origin.z, 1.0);
}

TEST_F(SlicesTest, ManyStepsEndAtTheNewest) {
    openRamp();
    press(Qt::Key_F8);
    auto& z = pane(SliceKind::Z);
    for (int i = 0; i < 40; ++i)
        wheel(z, z.rect().center(), i % 8 < 4 ? 120 : -120);
    wheel(z, z.rect().center(), 120);
    EXPECT_EQ(options().position.z, 7.0);
    ASSERT_TRUE(waitForSlices());
    EXPECT_EQ(readingAt(SliceKind::Z, {5.0, 7.0, 7.0}), QStringLiteral("70705   at (5, 7, 7)\n5, 7, 14 mm"));
}

TEST_F(SlicesTest, ARightDragChangesTheWindowAndADoubleClickTakesItBack) {
    openRamp();
    press(Qt::Key_F6);
    ASSERT_TRUE(waitForSlices());
    auto& z = pane(SliceKind::Z);
    const auto before = slices().window();
    const QPoint middle = z.rect().center();
    drag(z, Qt::RightButton, middle, middle + QPoint(60, 0));
    ASSERT_TRUE(options().window);
    EXPECT_GT(options().window->width(), 1.1 * before.width());
    EXPECT_NEAR(options().window->level(), before.level(), 1e-6 * before.width());
    const auto wide = *options().window;
    drag(z, Qt::RightButton, middle, middle + QPoint(0, -60));
    EXPECT_LT(options().window->level(), wide.level()) << "upwards brighter";
    EXPECT_EQ(slices().shades(SliceKind::Z)->plane.width, 20);
    doubleClick(z, Qt::LeftButton, {}, middle);
    EXPECT_FALSE(options().window);
    EXPECT_EQ(slices().window(), before);
    trigger("slices.wholeWindow");
    EXPECT_EQ(slices().window(), (model::ValueWindow{0.0, 111519.0}));
    const auto shades = slices().shades(SliceKind::Z);
    EXPECT_EQ(shades->pixels[0] & 0xff, static_cast<unsigned>(60000.0 / 111519.0 * 255.0 + 0.5));
}

TEST_F(SlicesTest, TheContourFollowsTheHandle) {
    openRamp();
    press(Qt::Key_F8);
    for (const double isovalue : {60750.0, 61020.0}) {
        ASSERT_TRUE(session_->isovalue().request(isovalue));
        ASSERT_TRUE(waitForSlices());
        const auto contour = slices().contour(SliceKind::Z);
        ASSERT_NE(contour, nullptr);
        EXPECT_GE(contour->points.size(), 38u);
        for (const auto& p : contour->points)
            EXPECT_NEAR(p.x + 100.0f * p.y + 10000.0f * p.z, isovalue, 0.1);
    }
    trigger("slices.contour");
    EXPECT_EQ(slices().contour(SliceKind::Z), nullptr);
    EXPECT_FALSE(settings_->boolean("slices/contour"));
}

TEST_F(SlicesTest, TheContourIsDrawnWhereTheSurfaceIs) {
    openBall(32);
    ASSERT_TRUE(session_->isovalue().request(-9.0));
    press(Qt::Key_F6);
    trigger("slices.crosshair");
    ASSERT_TRUE(waitForSlices());
    QTest::qWait(30);
    const QImage image = pane(SliceKind::Z).grab().toImage();
    const double ratio = image.devicePixelRatio();
    const auto reddest = [&](double x) { // of the pixels around a place
        int most = -255;
        const QPointF place = pane(SliceKind::Z).pointOf({x, 15.5, 16.0}) * ratio;
        for (int dx = -3; dx <= 3; ++dx) {
            const QColor colour = image.pixelColor(static_cast<int>(place.x()) + dx, static_cast<int>(place.y()));
            most = std::max(most, colour.red() - colour.blue());
        }
        return most;
    };
    const double radius = std::sqrt(81.0 - 0.25); // at z = 16, half a sample from the middle
    EXPECT_GT(reddest(15.5 + radius), 80);
    EXPECT_GT(reddest(15.5 - radius), 80);
    EXPECT_LT(reddest(15.5 + radius - 3.0), 20);
    EXPECT_LT(reddest(15.5), 20);
}

TEST_F(SlicesTest, TheMenuTakesTheIsovalueHere) {
    openRamp();
    press(Qt::Key_F6);
    ASSERT_TRUE(waitForSlices());
    auto& z = pane(SliceKind::Z);
    QTest::mouseClick(&z, Qt::RightButton, {}, at(SliceKind::Z, {5.0, 7.0, 6.0}));
    auto* menu = z.findChild<QMenu*>(QStringLiteral("sliceMenu"));
    ASSERT_NE(menu, nullptr);
    auto* take = menu->findChild<QAction*>(QStringLiteral("isovalueHere"));
    ASSERT_NE(take, nullptr);
    EXPECT_TRUE(take->text().contains(QStringLiteral("60705"))) << take->text().toStdString();
    take->trigger();
    EXPECT_EQ(session_->isovalue().requested(), 60705.0);
    menu->close();
    press(Qt::Key_I);
    EXPECT_EQ(session_->isovalue().requested(), 60810.0) << "at the crosshair";
    wheel(z, z.rect().center(), 120, Qt::ControlModifier);
    EXPECT_GT(session_->isovalue().requested(), 60810.0) << "Ctrl+wheel slides, as in the 3-D view";
    EXPECT_EQ(options().position.z, 6.0);
}

TEST_F(SlicesTest, ZoomsAboutThePointerAndPans) {
    openRamp();
    press(Qt::Key_F6);
    auto& z = pane(SliceKind::Z);
    const QPoint point = at(SliceKind::Z, {4.0, 4.0, 6.0});
    const glm::dvec2 pixel = z.pixelAt(point);
    const double wide = (z.pointOf({1.0, 0.0, 6.0}) - z.pointOf({0.0, 0.0, 6.0})).x();
    wheel(z, point, 120, Qt::ShiftModifier);
    wheel(z, point, 120, Qt::ShiftModifier);
    EXPECT_NEAR((z.pointOf({1.0, 0.0, 6.0}) - z.pointOf({0.0, 0.0, 6.0})).x(), 1.44 * wide, 1e-6);
    EXPECT_LT(glm::distance(z.pixelAt(point), pixel), 1e-6);
    drag(z, Qt::MiddleButton, point, point + QPoint(20, 12));
    EXPECT_LT(glm::distance(z.pixelAt(point + QPoint(20, 12)), pixel), 1e-6);
    drag(z, Qt::LeftButton, point, point - QPoint(20, 12), Qt::ShiftModifier);
    EXPECT_LT(glm::distance(z.pixelAt(point), pixel + 0.0), 1e-6);
    EXPECT_EQ(options().position, glm::dvec3(10.0, 8.0, 6.0)) << "the crosshair stays";
    QTest::keyClick(&z, Qt::Key_0);
    EXPECT_EQ(options().views[2], model::PaneView());
}

TEST_F(SlicesTest, StandInTheSession) {
    openRamp();
    press(Qt::Key_F7);
    trigger("slices.crosshair");
    slices().change([](model::SliceOptions& wanted) {
        wanted.position = {3.0, 4.0, 5.0};
        wanted.window = model::ValueWindow{10.0, 5000.0};
        wanted.orientation = glm::normalize(glm::dquat(0.9, 0.1, -0.2, 0.3));
        wanted.inScene = {true, false, false, true};
        wanted.views[0] = {2.0, {0.4, 0.6}};
    });
    const auto kept = options();
    const std::string file = (folder_ / "kept.isosession").string();
    dialogs_.answers.push_back(QString::fromStdString(file));
    trigger("file.saveSession");
    ASSERT_TRUE(waitUntil([&] { return std::filesystem::exists(file); }));
    trigger("file.close");
    press(Qt::Key_F5);
    window_->openFile(QString::fromStdString(file));
    ASSERT_TRUE(waitUntil([&] { return session_->frame() != nullptr; }));
    ASSERT_TRUE(waitForSlices());
    EXPECT_EQ(options(), kept);
    EXPECT_TRUE(isSeen(SliceKind::Y));
    EXPECT_EQ(slices().shades(SliceKind::Z)->plane.origin.z, 5.0);
}

TEST_F(SlicesTest, AreThereBeforeTheIndexAndTheSameAfterwards) {
    builder_->holds = true;
    openRamp();
    press(Qt::Key_F8);
    ASSERT_TRUE(waitUntil([this] { return slices().isSettled(); }));
    const auto before = readingAt(SliceKind::Z, {5.0, 7.0, 6.0});
    EXPECT_TRUE(before.startsWith(QStringLiteral("60705"))) << before.toStdString();
    ASSERT_EQ(session_->indexState(), model::IndexState::Building);
    builder_->holds = false;
    ASSERT_TRUE(waitForSlices());
    ASSERT_EQ(session_->indexState(), model::IndexState::Ready);
    EXPECT_EQ(session_->samples(), nullptr);
    wheel(pane(SliceKind::Z), pane(SliceKind::Z).rect().center(), 120);
    ASSERT_TRUE(waitForSlices());
    EXPECT_TRUE(readingAt(SliceKind::Z, {5.0, 7.0, 7.0}).startsWith(QStringLiteral("70705")));
}

TEST_F(SlicesTest, OfAPreviewShowItsSamplesUntilTheIndexIsThere) {
    wholeVolumeBytes_ = 8000; // of 15,360
    makeWindow();
    builder_->holds = true;
    openRamp();
    ASSERT_TRUE(session_->isPreview());
    press(Qt::Key_F8);
    ASSERT_TRUE(waitUntil([this] { return slices().isSettled(); }));
    EXPECT_EQ(slices().shades(SliceKind::Z)->plane.width, 10);
    EXPECT_EQ(slices().shownStep(SliceKind::Z), 2);
    EXPECT_EQ(readingAt(SliceKind::Z, {4.0, 6.0, 6.0}), QStringLiteral("60604   at (4, 6, 6)\n4, 6, 12 mm"));
    QTest::keyClick(&pane(SliceKind::Z), Qt::Key_End); // beyond the last plane that is known
    ASSERT_TRUE(waitUntil([this] { return slices().isSettled(); }));
    EXPECT_NE(slices().shades(SliceKind::Z)->pixels[0] >> 24, 0u);
    builder_->holds = false;
    ASSERT_TRUE(waitForSlices());
    EXPECT_EQ(slices().shades(SliceKind::Z)->plane.width, 20);
    EXPECT_EQ(slices().shownStep(SliceKind::Z), 1);
    EXPECT_EQ(readingAt(SliceKind::Z, {5.0, 7.0, 11.0}), QStringLiteral("110705   at (5, 7, 11)\n5, 7, 22 mm"));
}

TEST_F(SlicesTest, OfAnIndexOfEdgesAreOfItsSamples) {
    const auto volume = writeRamp(folder_);
    const auto index = folder_ / "ramp.isx";
    preprocess::BuildOptions build;
    build.kind = index::IndexKind::Edges;
    build.sourceName = "ramp.mha";
    {
        const auto source = io::openVolume(volume);
        ASSERT_THAT(source, IsOk());
        ASSERT_THAT(preprocess::buildIndex(*source.value(), index, build), IsOk());
    }
    std::filesystem::remove(volume);
    open(index);
    press(Qt::Key_F8);
    ASSERT_TRUE(waitForSlices());
    EXPECT_EQ(slices().problem(SliceKind::Z), "");
    EXPECT_TRUE(readingAt(SliceKind::Z, {5.0, 7.0, 6.0}).startsWith(QStringLiteral("60705")));
    ASSERT_TRUE(session_->isovalue().request(60750.0));
    ASSERT_TRUE(waitForSlices());
    EXPECT_GE(slices().contour(SliceKind::Z)->points.size(), 38u);
}

TEST_F(SlicesTest, AnotherVolumeHasItsOwnMiddleAndWindow) {
    openRamp();
    press(Qt::Key_F8);
    trigger("slices.wholeWindow");
    openBall(24);
    ASSERT_TRUE(waitForSlices());
    EXPECT_EQ(options().layout, SliceLayout::Four);
    EXPECT_EQ(options().position, glm::dvec3(12.0));
    EXPECT_FALSE(options().window);
    EXPECT_EQ(slices().shades(SliceKind::Z)->plane.width, 24);
    trigger("file.close");
    EXPECT_EQ(slices().shades(SliceKind::Z), nullptr);
    EXPECT_EQ(readingAt(SliceKind::Z, {5.0, 7.0, 6.0}), QString());
    QTest::keyClick(&pane(SliceKind::Z), Qt::Key_PageUp); // nothing to go through
    QTest::mouseClick(&pane(SliceKind::Z), Qt::LeftButton);
    pane(SliceKind::Z).grab();
}

TEST_F(SlicesTest, FitIntoASmallWindow) {
    openRamp();
    press(Qt::Key_F8);
    window_->resize(420, 320);
    QTest::qWait(150);
    ASSERT_TRUE(waitForSlices());
    EXPECT_LE(window_->width(), 420);
    for (const SliceKind kind : {SliceKind::X, SliceKind::Y, SliceKind::Z})
        EXPECT_TRUE(window_->rect().contains(QRect(pane(kind).mapTo(window_.get(), QPoint(0, 0)), pane(kind).size())));
}

class SliceSceneTest : public SlicesTest {
protected:
    void SetUp() override {
        if (window_->viewportHost().viewport() == nullptr)
            GTEST_SKIP() << "no OpenGL on this display";
    }
    widgets::ViewportWidget& view() { return *window_->viewportHost().viewport(); }
    QImage picture() {
        view().update();
        const auto painted = view().paintedFrames();
        EXPECT_TRUE(waitUntil([&] { return view().paintedFrames() > painted; }));
        return view().grabFramebuffer();
    }
    /// Pixels that differ by more than a rounding.
    static int difference(const QImage& a, const QImage& b) {
        int count = 0;
        for (int y = 0; y < a.height(); ++y)
            for (int x = 0; x < a.width(); ++x)
                count += std::abs(qGray(a.pixel(x, y)) - qGray(b.pixel(x, y))) > 8 ? 1 : 0;
        return count;
    }
};

TEST_F(SliceSceneTest, ASliceStandsInTheViewAndMovesWithTheCrosshair) {
    openBall(24);
    ASSERT_TRUE(session_->isovalue().request(-6.0));
    trigger("slices.crosshair");
    ASSERT_TRUE(waitForSlices());
    trigger("view.top");
    const QImage without = picture();
    press(Qt::Key_Z, Qt::ShiftModifier);
    EXPECT_TRUE(options().inScene[2]);
    ASSERT_TRUE(waitForSlices());
    const QImage with = picture();
    EXPECT_GT(difference(without, with), with.width() * with.height() / 20);
    // From above the plane through the middle hides nothing of the upper half, and all of the lower.
    slices().moveTo({12.0, 12.0, 23.0});
    ASSERT_TRUE(waitForSlices());
    EXPECT_GT(difference(with, picture()), with.width() * with.height() / 50);
    press(Qt::Key_Z, Qt::ShiftModifier);
    EXPECT_EQ(difference(without, picture()), 0);
}

TEST_F(SliceSceneTest, ItsSamplesLieWhereTheVolumeHasThem) {
    openRamp();
    trigger("slices.crosshair");
    ASSERT_TRUE(session_->isovalue().request(500.0)); // the surface is below the slice
    press(Qt::Key_Z, Qt::ShiftModifier);
    slices().change([](model::SliceOptions& wanted) { wanted.window = model::ValueWindow{60000.0, 61520.0}; });
    ASSERT_TRUE(waitForSlices());
    const auto greyAt = [this](const QImage& image, double down) {
        const QPointF middle(0.5 * image.width(), down * image.height());
        return qGray(image.pixel(middle.toPoint()));
    };
    trigger("view.top"); // y upwards, and grey grows with y
    const QImage top = picture();
    EXPECT_GT(greyAt(top, 0.42), greyAt(top, 0.5) + 15);
    EXPECT_GT(greyAt(top, 0.5), greyAt(top, 0.58) + 15);
    EXPECT_NEAR(greyAt(top, 0.5), 750.0 / 1520.0 * 255.0, 12.0);
    trigger("view.bottom");
    const QImage bottom = picture();
    EXPECT_NEAR(greyAt(bottom, 0.42) - greyAt(bottom, 0.58), greyAt(top, 0.58) - greyAt(top, 0.42), 6);
}

TEST_F(SliceSceneTest, TheWheelWithAltPushesTheSliceAwayFromTheViewer) {
    openBall(24);
    press(Qt::Key_Z, Qt::ShiftModifier);
    ASSERT_TRUE(waitForSlices());
    trigger("view.top"); // along -z
    wheel(view(), view().rect().center(), 120, Qt::AltModifier);
    EXPECT_EQ(options().position, glm::dvec3(12.0, 12.0, 11.0));
    trigger("view.bottom");
    wheel(view(), view().rect().center(), 240, Qt::AltModifier);
    EXPECT_EQ(options().position, glm::dvec3(12.0, 12.0, 13.0));
}

TEST_F(SliceSceneTest, TheObliqueSliceFacesTheViewAndIsPushedAlongIt) {
    openBall(24);
    view().changeCamera([](model::Camera& camera) { camera.orbit(0.6, 0.3); });
    press(Qt::Key_F, Qt::ShiftModifier);
    EXPECT_TRUE(options().inScene[3]);
    ASSERT_TRUE(waitForSlices());
    const glm::dvec3 normal = options().orientation * glm::dvec3(0.0, 0.0, 1.0);
    EXPECT_LT(glm::distance(normal, view().camera().backward()), 1e-9);
    const glm::dvec3 before = options().position;
    wheel(view(), view().rect().center(), 240, Qt::AltModifier);
    EXPECT_LT(glm::distance(options().position, before - 2.0 * normal), 1e-9);
    ASSERT_TRUE(waitForSlices());
    const auto shades = slices().shades(SliceKind::Oblique);
    ASSERT_NE(shades, nullptr);
    EXPECT_LT(std::abs(glm::dot(normal, shades->plane.origin - options().position)), 1e-9);
    press(Qt::Key_O); // in a pane, too: the wheel there does the same
    wheel(pane(SliceKind::Oblique), pane(SliceKind::Oblique).rect().center(), 120);
    EXPECT_LT(glm::distance(options().position, before - normal), 1e-9);
}

TEST_F(SliceSceneTest, ComesBackWithTheCardAndWithItsMemory) {
    const auto driver = std::make_shared<FaultyDriver>();
    view().setDriver(driver);
    openBall(24);
    ASSERT_TRUE(session_->isovalue().request(-6.0));
    ASSERT_TRUE(waitForSlices());
    const QImage without = picture();
    const auto buffers = driver->buffers();
    press(Qt::Key_Z, Qt::ShiftModifier);
    press(Qt::Key_X, Qt::ShiftModifier);
    ASSERT_TRUE(waitForSlices());
    const QImage with = picture();
    EXPECT_GT(difference(without, with), 1000);
    driver->lostContexts = 1;
    EXPECT_EQ(difference(with, picture()), 0) << "after a reset";
    press(Qt::Key_Z, Qt::ShiftModifier);
    press(Qt::Key_X, Qt::ShiftModifier);
    EXPECT_EQ(difference(without, picture()), 0);
    EXPECT_EQ(driver->buffers(), buffers) << "nothing stays on the card";

    driver->memoryBytes = driver->usedBytes();
    press(Qt::Key_Z, Qt::ShiftModifier);
    press(Qt::Key_X, Qt::ShiftModifier);
    ASSERT_TRUE(waitForSlices());
    EXPECT_EQ(difference(without, picture()), 0) << "the surface is drawn all the same";
    EXPECT_GT(driver->refusals(), 0);
    driver->memoryBytes = std::numeric_limits<std::size_t>::max();
    trigger("slices.contour");
    EXPECT_GT(difference(without, picture()), 1000) << "with the next change there is room again";
    trigger("slices.contour");
    ASSERT_TRUE(waitForSlices());
    EXPECT_EQ(difference(with, picture()), 0);
}

TEST_F(SliceSceneTest, AClickInTheViewMovesTheCrosshairToTheSurfaceOrTheSlice) {
    openBall(25);
    ASSERT_TRUE(session_->isovalue().request(-6.0));
    press(Qt::Key_F6);
    ASSERT_TRUE(waitForSlices());
    trigger("view.top");
    picture();
    QTest::mouseClick(&view(), Qt::LeftButton, {}, view().rect().center());
    EXPECT_EQ(options().position, glm::dvec3(12.0, 12.0, 18.0)) << "the top of the ball";
    press(Qt::Key_Z, Qt::ShiftModifier);
    slices().moveTo({3.0, 3.0, 20.0});
    ASSERT_TRUE(waitForSlices());
    QTest::mouseClick(&view(), Qt::LeftButton, {}, view().rect().center());
    EXPECT_EQ(options().position, glm::dvec3(12.0, 12.0, 20.0)) << "the slice is in front of it";
    drag(view(), Qt::LeftButton, view().rect().center(), view().rect().center() + QPoint(60, 10));
    EXPECT_EQ(options().position, glm::dvec3(12.0, 12.0, 20.0)) << "a drag turns the view";
}

} // namespace
} // namespace isoslider::test
