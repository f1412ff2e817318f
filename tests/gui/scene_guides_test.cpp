// The orientation cube, the scale bar and the way to the surface: what the pointer and the keys do, and what is kept.
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <string>

#include <QAction>
#include <QApplication>
#include <QFileInfo>
#include <QToolBar>
#include <QtTest>

#include <glm/geometric.hpp>

#include "tests/gui/window_fixture.h"
#include "ui/model/surface/orientation_cube.h"
#include "ui/widgets/panels/fact_texts.h"
#include "ui/widgets/viewport/box_ticks_view.h"
#include "ui/widgets/viewport/camera_flight.h"
#include "ui/widgets/viewport/orientation_cube.h"
#include "ui/widgets/viewport/scale_bar_view.h"
#include "ui/widgets/viewport/viewport_host.h"
#include "ui/widgets/viewport/viewport_overlay.h"
#include "ui/widgets/viewport/viewport_widget.h"
#include "ui/widgets/window/action_registry.h"
#include "ui/widgets/window/message_bar.h"

namespace isoslider::test {
namespace {

using model::StandardView;

class SceneGuidesTest : public WindowTest {
protected:
    void SetUp() override {
        if (window_->viewportHost().viewport() == nullptr)
            GTEST_SKIP() << "no OpenGL 3.3 here";
        openBall();
        ASSERT_TRUE(waitUntil([this] { return cube().isVisible() && scaleBar().isVisible(); }));
    }
    widgets::ViewportWidget& viewport() { return *window_->viewportHost().viewport(); }
    const model::Camera& camera() { return viewport().camera(); }
    widgets::OrientationCube& cube() { return *child<widgets::OrientationCube>("orientationCube"); }
    widgets::ScaleBarView& scaleBar() { return *child<widgets::ScaleBarView>("scaleBar"); }
    /// The middle of a side of the cube that can be seen.
    QPoint pointOf(StandardView side) {
        for (const auto& seen : model::visibleSides(camera().orientation()))
            if (seen.side == side)
                return cube().pointOf(seen.middle).toPoint();
        ADD_FAILURE() << "cannot be seen";
        return {};
    }
    void moveTo(QPointF point, Qt::MouseButtons buttons = Qt::NoButton) {
        QMouseEvent move(QEvent::MouseMove, point, cube().mapToGlobal(point), Qt::NoButton, buttons, Qt::NoModifier);
        QApplication::sendEvent(&cube(), &move);
    }
    bool waitForFlight() {
        return waitUntil([this] { return !window_->viewportHost().flight()->isFlying(); });
    }
    bool isChecked(const char* action) { return window_->actions().action(action)->isChecked(); }
    QImage savedPicture() {
        const auto path = folder_ / "view.png";
        const QSize size = viewport().size();
        dialogs_.answers.push_back(QString::fromStdString(path.string()));
        trigger("file.saveImage");
        EXPECT_TRUE(waitUntil([this] { return window_->messageBar().isVisible(); }));
        window_->messageBar().hide();
        EXPECT_TRUE(waitUntil([&] { return viewport().size() == size; })) << "it makes room";
        return QImage(QString::fromStdString(path.string())).convertToFormat(QImage::Format_RGB32);
    }
    /// Of the pixels below a widget of the view.
    int differences(const QImage& a, const QImage& b, const QWidget& widget) {
        EXPECT_EQ(a.size(), b.size());
        const QRect place(viewport().mapFromGlobal(widget.mapToGlobal(QPoint())), widget.size());
        const double ratio = static_cast<double>(a.width()) / viewport().width();
        int count = 0;
        for (int y = 0; y < a.height(); ++y)
            for (int x = 0; x < a.width(); ++x)
                count += place.contains(QPointF(x / ratio, y / ratio).toPoint()) && a.pixel(x, y) != b.pixel(x, y);
        return count;
    }
};

TEST_F(SceneGuidesTest, AClickOnASideOfTheCubeShowsItStraightOn) {
    viewport().changeCamera([](model::Camera& camera) { camera.zoom(1.3, {0.2, 0.1}, 1.5); });
    const auto before = camera().pose();
    for (const auto side : {StandardView::Right, StandardView::Front, StandardView::Top}) {
        viewport().changeCamera([&](model::Camera& camera) { camera.setPose(before); });
        if (side == StandardView::Right)
            viewport().changeCamera([](model::Camera& camera) { camera.orbit(-0.9, 0.0); });
        const auto start = camera().pose();
        QTest::mouseClick(&cube(), Qt::LeftButton, {}, pointOf(side));
        EXPECT_EQ(camera().orientation(), start.orientation) << "it takes a while to turn";
        ASSERT_TRUE(waitForFlight());
        const glm::dvec3 outwards = model::standardOrientation(side) * glm::dvec3(0.0, 0.0, 1.0);
        EXPECT_NEAR(glm::dot(camera().backward(), outwards), 1.0, 1e-9) << model::sideName(side, false);
        EXPECT_EQ(camera().target(), start.target) << "what is in the middle stays there";
        EXPECT_NEAR(camera().distance(), start.distance, 1e-9);
        EXPECT_EQ(model::visibleSides(camera().orientation()).size(), 1u);
    }
    keepPicture(*window_, "guides_top");
}

TEST_F(SceneGuidesTest, TheSideBelowThePointerIsHighlightedAndNamed) {
    const QImage plain = cube().grab().toImage();
    moveTo(pointOf(StandardView::Front));
    EXPECT_EQ(cube().hovered(), StandardView::Front);
    EXPECT_EQ(cube().toolTip(), QStringLiteral("Look at −Y"));
    const QImage first = cube().grab().toImage();
    EXPECT_NE(first, plain);
    keepPicture(*window_, "guides_hover");
    moveTo(pointOf(StandardView::Top));
    EXPECT_EQ(cube().hovered(), StandardView::Top);
    EXPECT_EQ(cube().toolTip(), QStringLiteral("Look at +Z"));
    EXPECT_NE(cube().grab().toImage(), first);
    moveTo(QPointF(1, 1));
    EXPECT_FALSE(cube().hovered());
    EXPECT_EQ(cube().grab().toImage(), plain);
    moveTo(pointOf(StandardView::Top));
    QEvent leave(QEvent::Leave);
    QApplication::sendEvent(&cube(), &leave);
    EXPECT_FALSE(cube().hovered());
}

TEST_F(SceneGuidesTest, WhatIsNoClickOnASideIsForTheView) {
    int clicks = 0, picks = 0;
    QObject::connect(&viewport(), &widgets::ViewportWidget::clicked, &viewport(), [&clicks] { ++clicks; });
    QObject::connect(&viewport(), &widgets::ViewportWidget::picked, &viewport(), [&picks] { ++picks; });
    const auto before = camera().orientation();
    const QPoint from = pointOf(StandardView::Front);
    QTest::mousePress(&cube(), Qt::LeftButton, {}, from);
    moveTo(from + QPoint(60, 10), Qt::LeftButton);
    EXPECT_GT(glm::length(camera().orientation() - before), 0.05) << "a drag orbits";
    const auto orbited = camera().orientation();
    QTest::mouseRelease(&cube(), Qt::LeftButton, {}, from + QPoint(60, 10));
    EXPECT_FALSE(window_->viewportHost().flight()->isFlying()) << "and is no click";
    EXPECT_EQ(camera().orientation(), orbited);
    EXPECT_EQ(clicks, 0);

    QTest::mouseClick(&cube(), Qt::LeftButton, {}, QPoint(1, 1)); // beside the cube
    EXPECT_FALSE(window_->viewportHost().flight()->isFlying());
    EXPECT_EQ(clicks, 1);
    doubleClick(cube(), Qt::LeftButton, {}, pointOf(StandardView::Top));
    EXPECT_EQ(clicks, 1) << "nothing behind the cube is picked";
    EXPECT_EQ(picks, 0);
    ASSERT_TRUE(waitForFlight());

    const double distance = camera().distance();
    QWheelEvent wheel(QPointF(46, 46), cube().mapToGlobal(QPointF(46, 46)), {}, QPoint(0, 120), Qt::NoButton,
                      Qt::NoModifier, Qt::NoScrollPhase, false);
    QSpontaneKeyEvent::setSpontaneous(&wheel); // only such ones are passed on
    qApp->notify(&cube(), &wheel);
    EXPECT_LT(camera().distance(), distance);
}

TEST_F(SceneGuidesTest, TheScaleBarIsAsLongAsItSays) {
    for (const double zoom : {1.0, 1.7, 40.0, 0.01}) {
        viewport().changeCamera([zoom](model::Camera& camera) { camera.zoom(zoom, {0.0, 0.0}, 1.5); });
        for (const bool isPerspective : {true, false}) {
            viewport().changeCamera([&](model::Camera& camera) { camera.setPerspective(isPerspective); });
            ASSERT_TRUE(scaleBar().isVisible());
            const double length = scaleBar().bar().length;
            EXPECT_EQ(scaleBar().text(), QStringLiteral("%1%2units").arg(length).arg(QChar(QChar::Nbsp)))
                << "the file states no unit";
            // A stretch of that length across the middle of the view, as it is drawn.
            const double aspect = static_cast<double>(viewport().width()) / viewport().height();
            const glm::dmat4 toClip = camera().projectionMatrix(aspect) * camera().viewMatrix();
            const auto pixelOf = [&](const glm::dvec3& place) {
                const glm::dvec4 clip = toClip * glm::dvec4(place, 1.0);
                return clip.x / clip.w / 2.0 * viewport().width();
            };
            const double drawn = pixelOf(camera().target() + camera().right() * length) - pixelOf(camera().target());
            EXPECT_NEAR(scaleBar().bar().pixels, drawn, 1e-6 * drawn);
            EXPECT_LE(scaleBar().bar().pixels, widgets::ScaleBarView::kMostPixels);
            EXPECT_TRUE(viewport().rect().contains(scaleBar().geometry()));
        }
    }
}

TEST_F(SceneGuidesTest, TheScaleBarIsTrueAlongItsWayWhereLengthsAreStretched) {
    const auto worldPerPixel = [this] { return scaleBar().bar().length / scaleBar().bar().pixels; };
    QTest::keyClick(window_.get(), Qt::Key_1); // X to the right, Z upwards
    ASSERT_TRUE(waitUntil([this] { return std::abs(camera().right().x) > 0.999; }));
    const auto stretch = [this](const glm::dvec3& by) {
        auto options = window_->viewportHost().viewState().options();
        options.stage.stretch = by;
        window_->viewportHost().viewState().setOptions(options);
    };
    const double plain = worldPerPixel() / camera().halfHeight();
    stretch({20.0, 1.0, 1.0});
    ASSERT_TRUE(scaleBar().isVisible());
    EXPECT_NEAR(20.0 * worldPerPixel() / camera().halfHeight(), plain, 1e-6 * plain);
    stretch({1.0, 1.0, 20.0});
    EXPECT_NEAR(worldPerPixel() / camera().halfHeight(), plain, 1e-6 * plain) << "the bar lies along X";
}

TEST_F(SceneGuidesTest, GuidesAreShownHiddenUndoneAndRemembered) {
    QTest::qWait(600); // what opening has changed is no step
    for (const auto& [action, key, modifiers, widget] :
         {std::tuple("view.cube", Qt::Key_K, Qt::KeyboardModifiers(Qt::NoModifier), static_cast<QWidget*>(&cube())),
          std::tuple("view.scaleBar", Qt::Key_K, Qt::KeyboardModifiers(Qt::ShiftModifier),
                     static_cast<QWidget*>(&scaleBar()))}) {
        EXPECT_TRUE(isChecked(action));
        QTest::keyClick(window_.get(), key, modifiers);
        EXPECT_FALSE(widget->isVisible()) << action;
        EXPECT_FALSE(isChecked(action));
        QTest::qWait(600);
        QTest::keyClick(window_.get(), Qt::Key_Z, Qt::ControlModifier);
        EXPECT_TRUE(widget->isVisible()) << action;
        EXPECT_TRUE(isChecked(action));
        QTest::keyClick(window_.get(), Qt::Key_Y, Qt::ControlModifier);
        EXPECT_FALSE(widget->isVisible()) << action;
        QTest::qWait(600);
    }
    makeWindow();
    EXPECT_FALSE(isChecked("view.cube"));
    EXPECT_FALSE(isChecked("view.scaleBar"));
    openBall();
    EXPECT_FALSE(cube().isVisible());
    EXPECT_FALSE(scaleBar().isVisible());
}

TEST_F(SceneGuidesTest, ASessionKeepsThem) {
    window_->actions().action("view.cube")->setChecked(false);
    const auto path = folder_ / "ball.isosession";
    dialogs_.answers.push_back(QString::fromStdString(path.string()));
    trigger("file.saveSession");
    ASSERT_TRUE(waitUntil([this] { return window_->messageBar().isVisible(); }));
    window_->actions().action("view.cube")->setChecked(true);
    window_->actions().action("view.scaleBar")->setChecked(false);
    trigger("file.close");
    EXPECT_FALSE(cube().isVisible()) << "there is nothing to find one's way in";
    window_->openFile(QString::fromStdString(path.string()));
    ASSERT_TRUE(waitUntil([this] { return session_->frame() != nullptr && session_->isSettled(); }));
    EXPECT_FALSE(cube().isVisible());
    EXPECT_TRUE(scaleBar().isVisible());
}

TEST_F(SceneGuidesTest, SavedPicturesShowWhatIsOn) {
    trigger("view.reset"); // no fit to the first surface comes any more
    const QImage both = savedPicture();
    trigger("view.cube");
    const QImage barOnly = savedPicture();
    trigger("view.scaleBar");
    const QImage none = savedPicture();
    EXPECT_GT(differences(both, barOnly, cube()), 1000);
    EXPECT_EQ(differences(both, barOnly, scaleBar()), 0);
    EXPECT_GT(differences(barOnly, none, scaleBar()), 300);
    EXPECT_EQ(differences(barOnly, none, cube()), 0);
}

TEST_F(SceneGuidesTest, ASmallViewHasNoRoomForThem) {
    window_->resize(320, 240);
    ASSERT_TRUE(waitUntil([this] { return !cube().isVisible() && !scaleBar().isVisible(); }))
        << viewport().width() << " x " << viewport().height();
    window_->resize(1400, 900);
    ASSERT_TRUE(waitUntil([this] { return cube().isVisible() && scaleBar().isVisible(); }));
    EXPECT_FALSE(cube().geometry().intersects(scaleBar().geometry()));
}

/// -distance from the middle as NIfTI, in the directions of a patient's scanner.
std::filesystem::path writeNiftiBall(const TemporaryFolder& folder, int n) {
    std::string bytes(352, '\0');
    const auto put = [&](std::size_t at, auto value) { std::memcpy(bytes.data() + at, &value, sizeof value); };
    put(0, std::int32_t{348});
    for (std::size_t i = 0; i < 8; ++i) // dim, pixdim
        put(40 + 2 * i, static_cast<std::int16_t>(i == 0 ? 3 : i < 4 ? n : 1));
    put(70, std::int16_t{16}); // float
    put(72, std::int16_t{32});
    for (std::size_t i = 0; i < 4; ++i)
        put(76 + 4 * i, 1.0f);
    put(108, 352.0f);
    put(254, std::int16_t{1}); // sform
    for (const std::size_t row : {280, 300, 320})
        put(row, 1.0f);
    std::memcpy(bytes.data() + 344, "n+1", 4);
    const float middle = static_cast<float>(n - 1) / 2.0f;
    for (int z = 0; z < n; ++z)
        for (int y = 0; y < n; ++y)
            for (int x = 0; x < n; ++x) {
                const float value = -std::hypot(static_cast<float>(x) - middle, static_cast<float>(y) - middle,
                                                static_cast<float>(z) - middle);
                bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
            }
    return folder.write("ball.nii", bytes);
}

class FirstViewTest : public SceneGuidesTest {
protected:
    void openNext(const std::filesystem::path& path) {
        const auto before = session_->datasetGeneration();
        window_->openFile(QString::fromStdString(path.string()));
        ASSERT_TRUE(waitUntil([&] { return session_->datasetGeneration() != before && session_->frame() != nullptr; }));
        ASSERT_TRUE(waitUntilSettled());
    }
    bool isFitted() {
        const double radius = -session_->frame()->isovalue;
        return waitUntil([&] { return std::abs(camera().halfHeight() - radius) < 0.2 * radius; },
                         std::chrono::seconds(5));
    }
};

TEST_F(FirstViewTest, FitsTheSurfaceUntilTheCameraIsMoved) {
    openNext(writeBall(folder_, "first.mha", 24));
    ASSERT_TRUE(isFitted()) << camera().halfHeight() << " of " << session_->frame()->isovalue;
    EXPECT_LT(std::abs(camera().backward().x), 0.9) << "from the side and above";
    EXPECT_GT(camera().backward().z, 0.1);
    const auto first = camera().pose();
    session_->isovalue().request(-2.0);
    ASSERT_TRUE(waitUntil([this] { return session_->isovalue().displayed() == -2.0; }));
    QTest::qWait(200);
    EXPECT_EQ(camera().pose(), first) << "a slide leaves the camera alone";
}

TEST_F(FirstViewTest, PatientsAreSeenFromTheFrontHeadUp) {
    openNext(writeNiftiBall(folder_, 24));
    ASSERT_TRUE(isFitted());
    EXPECT_NEAR(camera().backward().y, -1.0, 1e-9);
    EXPECT_NEAR(camera().up().z, 1.0, 1e-9);
    viewport().changeCamera([](model::Camera& camera) { camera.orbit(0.5, 0.2); });
    QTest::keyClick(&viewport(), Qt::Key_R);
    EXPECT_NEAR(camera().backward().y, -1.0, 1e-9);
    EXPECT_GT(camera().halfHeight(), 15.0) << "the whole volume";
}

TEST_F(FirstViewTest, TicksAndFactsOfPatientsNameTheirDirections) {
    openNext(writeNiftiBall(folder_, 24));
    trigger("view.ticks");
    QStringList titles;
    for (const auto& edge : child<widgets::BoxTicksView>("boxTicks")->edges()) {
        titles << edge.title;
        for (const auto& [place, number] : edge.ticks)
            EXPECT_TRUE(number == QLatin1String("0") || edge.title.contains(number.left(1)))
                << edge.title.toStdString() << number.toStdString();
    }
    EXPECT_TRUE(titles.contains(QStringLiteral("R–L"))) << titles.join(QLatin1Char(' ')).toStdString();
    const auto* glyph = window_->findChild<widgets::AxesGlyph*>();
    EXPECT_EQ(glyph->letters().join(QString()), QStringLiteral("LPS"));
    keepPicture(*window_, "ticks-patient");
    GridGeometry geometry;
    geometry.dims = {2, 2, 2};
    geometry.origin = {90.0, 125.0, -71.0};
    const auto textOf = [&](const char* name, bool isPatient) {
        for (const auto& fact : widgets::placeFactsOf(geometry, "mm", isPatient))
            if (fact.name == QLatin1String(name))
                return QString(fact.value).replace(QChar(QChar::Nbsp), QLatin1Char(' ')).toStdString();
        return std::string();
    };
    EXPECT_EQ(textOf("Origin", true), "L 90, P 125, I 71 mm");
    EXPECT_EQ(textOf("Coordinates", true), "LPS");
    EXPECT_EQ(textOf("Origin", false), "(90, 125, -71) mm");
    EXPECT_EQ(textOf("Coordinates", false), "");
}

TEST_F(SceneGuidesTest, FitToSurfaceFillsTheViewWithTheSurface) {
    session_->isovalue().request(-3.0);
    ASSERT_TRUE(waitUntil([this] { return session_->isovalue().displayed() == -3.0; }));
    viewport().changeCamera([](model::Camera& camera) { camera.pan({0.4, 0.3}, 1.5); });
    const auto before = camera().pose();
    QTest::keyClick(&viewport(), Qt::Key_R, Qt::ShiftModifier);
    ASSERT_TRUE(waitUntil([&] { return camera().distance() < before.distance; }));
    ASSERT_TRUE(waitForFlight());
    EXPECT_LT(glm::length(camera().target()), 0.01) << "the ball is in the middle of the volume";
    EXPECT_EQ(camera().orientation(), before.orientation);
    EXPECT_NEAR(camera().halfHeight(), 3.0, 0.3);
    QTest::keyClick(&viewport(), Qt::Key_R);
    EXPECT_GT(camera().halfHeight(), 15.0) << "the whole volume";
    QTest::keyClick(&viewport(), Qt::Key_F); // as the button of the tool bar
    ASSERT_TRUE(waitUntil([&] { return camera().halfHeight() < 4.0; }));
    EXPECT_TRUE(child<QToolBar>("mainToolBar")->actions().contains(window_->actions().action("view.fit")));
    session_->isovalue().request(-100.0); // below all samples: at the least one
    ASSERT_TRUE(waitUntil([this] { return !window_->actions().action("view.fit")->isEnabled(); }))
        << "there is no surface";
}

TEST_F(SceneGuidesTest, SavedPicturesHaveTheAxesAndNoMarkOfAnEvent) {
    trigger("view.reset"); // as above
    trigger("view.cube"); // Qt does not draw its turned letters alike at all times
    if (!isChecked("view.axes"))
        trigger("view.axes");
    auto* axes = window_->viewportHost().findChild<widgets::AxesGlyph*>();
    ASSERT_NE(axes, nullptr);
    ASSERT_TRUE(axes->isVisible());
    const QImage with = savedPicture();
    EXPECT_EQ(QFileInfo(dialogs_.asked.place).fileName(), QStringLiteral("ball.png"));
    keepPicture(*window_, "axes_on_screen");
    viewport().setSpot(glm::dvec3(12.0));
    EXPECT_EQ(savedPicture(), with) << "the ring is for the eye at the screen";
    viewport().setSpot(std::nullopt);
    trigger("view.axes");
    const QImage without = savedPicture();
    EXPECT_GT(differences(with, without, *axes), 100);
    EXPECT_EQ(differences(with, without, scaleBar()), 0);
}

TEST_F(SceneGuidesTest, TicksComeByKeyFollowTheCameraAndAreSavedAndUndone) {
    auto& ticks = *child<widgets::BoxTicksView>("boxTicks");
    EXPECT_FALSE(ticks.isVisible());
    const QImage without = savedPicture();
    QTest::keyClick(window_.get(), Qt::Key_A, Qt::ShiftModifier);
    ASSERT_TRUE(ticks.isVisible());
    ASSERT_EQ(ticks.edges().size(), 3u);
    for (const auto& edge : ticks.edges())
        EXPECT_GE(edge.ticks.size(), 2u) << edge.title.toStdString();
    const auto before = ticks.edges();
    viewport().changeCamera([](model::Camera& moved) { moved.orbit(0.3, 0.1); });
    EXPECT_NE(ticks.edges(), before);
    viewport().changeCamera([](model::Camera& moved) { moved.orbit(-0.3, 0.0); });
    EXPECT_NE(savedPicture(), without);
    EXPECT_TRUE(settings_->boolean("view/showsTicks"));
    keepPicture(*window_, "ticks");
    QTest::qWait(600); // longer than steps are joined
    QTest::keyClick(window_.get(), Qt::Key_Z, Qt::ControlModifier);
    EXPECT_FALSE(ticks.isVisible());
    EXPECT_FALSE(isChecked("view.ticks"));
}

} // namespace
} // namespace isoslider::test
