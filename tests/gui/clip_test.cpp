// The crop box and the clip plane: handles, keys, panel, what is picked, undone and kept.
#include <cmath>
#include <filesystem>
#include <numbers>

#include <QAction>
#include <QApplication>
#include <QComboBox>
#include <QDockWidget>
#include <QDoubleSpinBox>
#include <QLabel>
#include <QMouseEvent>
#include <QSpinBox>
#include <QToolButton>
#include <QtTest>

#include <glm/geometric.hpp>

#include "core/mesh/mesh_checks.h"
#include "tests/gui/float_volume.h"
#include "tests/gui/window_fixture.h"
#include "ui/widgets/viewport/clip_tool.h"
#include "ui/widgets/viewport/viewport_host.h"
#include "ui/widgets/viewport/viewport_widget.h"
#include "ui/widgets/window/action_registry.h"
#include "ui/widgets/window/message_bar.h"

namespace isoslider::test {
namespace {

using widgets::ClipHandle;
using Kind = widgets::ClipHandle::Kind;

constexpr int kPoints = 24;
constexpr double kRadius = 8.0;
constexpr double kMiddle = (kPoints - 1) / 2.0;

class ClipTest : public WindowTest {
protected:
    void SetUp() override {
        if (window_->viewportHost().viewport() == nullptr)
            GTEST_SKIP() << "no OpenGL 3.3 here";
        openBall(kPoints);
        ASSERT_TRUE(session_->isovalue().request(-kRadius));
        QTest::keyClick(window_.get(), Qt::Key_1); // looks along +Y: X to the right, Z upwards
        ASSERT_TRUE(waitUntilSettled());
    }
    widgets::ViewportWidget& viewport() { return *window_->viewportHost().viewport(); }
    widgets::ClipHandles& handles() { return *child<widgets::ClipHandles>("clipHandles"); }
    QAction& action(const char* id) { return *window_->actions().action(id); }
    const model::Clipping& clipping() { return window_->viewportHost().viewState().options().clipping; }
    model::CapModel& cap() { return window_->viewportHost().clipTool()->cap(0); }
    void press(Qt::Key key, Qt::KeyboardModifiers modifiers = {}) { QTest::keyClick(window_.get(), key, modifiers); }
    static void letStepEnd() { QTest::qWait(600); }
    QPoint pointOf(const ClipHandle& handle) { return handles().pointOf(handle)->toPoint(); }
    /// Where a place of the volume, in index units, is in the view.
    QPoint seenAt(const glm::dvec3& place) {
        const glm::dvec3 world = place - kMiddle;
        const auto& camera = viewport().camera();
        const double aspect = static_cast<double>(viewport().width()) / viewport().height();
        const glm::dvec4 clip = camera.projectionMatrix(aspect) * camera.viewMatrix() * glm::dvec4(world, 1.0);
        return QPointF((clip.x / clip.w + 1.0) / 2.0 * viewport().width(),
                       (1.0 - clip.y / clip.w) / 2.0 * viewport().height())
            .toPoint();
    }
    void drag(QPoint from, QPoint to, int steps = 6) {
        QTest::mousePress(&viewport(), Qt::LeftButton, {}, from);
        for (int step = 1; step <= steps; ++step) {
            const QPointF point = from + QPointF(to - from) * step / steps;
            QMouseEvent move(QEvent::MouseMove, point, viewport().mapToGlobal(point), Qt::NoButton, Qt::LeftButton,
                             Qt::NoModifier);
            QApplication::sendEvent(&viewport(), &move);
            QTest::qWait(20);
        }
        QTest::mouseRelease(&viewport(), Qt::LeftButton, {}, to);
    }
    void openOther() {
        openBall(20);
        ASSERT_TRUE(waitUntil([this] { return session_->dataset()->geometry.dims[0] == 20; }));
    }
};

TEST_F(ClipTest, AFaceOfTheCropBoxIsDraggedToGridPoints) {
    EXPECT_TRUE(handles().handles().empty());
    press(Qt::Key_B, Qt::ShiftModifier);
    EXPECT_TRUE(clipping().isCropped);
    EXPECT_TRUE(action("clip.crop").isChecked());
    ASSERT_EQ(handles().handles().size(), 6u);
    EXPECT_TRUE(handles().isVisible());
    const auto orientation = viewport().camera().orientation();
    const ClipHandle right{Kind::Face, 0, true};
    drag(pointOf(right), seenAt(glm::dvec3(14.2, kMiddle, kMiddle)));
    EXPECT_EQ(clipping().crop, (model::CropBox{{0, 0, 0}, {14, 23, 23}}));
    EXPECT_EQ(viewport().camera().orientation(), orientation) << "the view stays";
    drag(pointOf({Kind::Face, 2, false}), seenAt(glm::dvec3(7.0, kMiddle, 5.8)));
    EXPECT_EQ(clipping().crop, (model::CropBox{{0, 0, 6}, {14, 23, 23}}));
    drag(pointOf(right), QPoint(2, viewport().height() / 2));
    EXPECT_EQ(clipping().crop->high[0], 1) << "a cell stays";
    keepPicture(*window_, "crop");
    trigger("clip.resetCrop");
    EXPECT_FALSE(clipping().crop);
    EXPECT_TRUE(clipping().isCropped);
    EXPECT_FALSE(action("clip.resetCrop").isEnabled());
    press(Qt::Key_B, Qt::ShiftModifier);
    EXPECT_FALSE(clipping().isCropped);
    EXPECT_FALSE(handles().isVisible());
    drag(pointOf(right), pointOf(right) + QPoint(-60, 0));
    EXPECT_NE(viewport().camera().orientation(), orientation) << "where no handle is, the view turns";
}

// The words under the surface state it, and what shows it elsewhere has it made everywhere.
TEST_F(ClipTest, TheSurfaceSlidesInTheCropBoxOnly) {
    openBall(48);
    ASSERT_TRUE(waitUntil([this] { return session_->dataset()->geometry.dims[0] == 48; }));
    ASSERT_TRUE(waitUntilSettled());
    const auto readout = [this] { return child<QLabel>("viewReadout")->text(); };
    const std::uint64_t all = session_->frame()->stats.triangles;
    press(Qt::Key_B, Qt::ShiftModifier);
    ASSERT_TRUE(waitUntilSettled());
    EXPECT_FALSE(session_->frame()->region) << "the box holds all";
    EXPECT_FALSE(readout().contains(QStringLiteral("crop"))) << readout().toStdString();
    auto options = window_->viewportHost().viewState().options();
    options.clipping.crop = model::CropBox{{0, 0, 0}, {12, 47, 47}};
    window_->viewportHost().viewState().setOptions(options);
    ASSERT_TRUE(waitUntil([this] { return session_->frame()->region.has_value(); }));
    ASSERT_TRUE(waitUntilSettled());
    EXPECT_LT(session_->frame()->stats.triangles, all);
    EXPECT_TRUE(readout().contains(QStringLiteral("about the crop box"))) << readout().toStdString();
    window_->slices().change([](model::SliceOptions& slices) { slices.inScene[0] = true; });
    ASSERT_TRUE(waitUntil([this] { return !session_->frame()->region; }));
    EXPECT_EQ(session_->frame()->stats.triangles, all) << "a slice shows where the surface cuts it, beyond the box too";
    window_->slices().change([](model::SliceOptions& slices) { slices.inScene[0] = false; });
    ASSERT_TRUE(waitUntil([this] { return session_->frame()->region.has_value(); }));
    press(Qt::Key_B, Qt::ShiftModifier);
    ASSERT_TRUE(waitUntil([this] { return !session_->frame()->region; }));
    EXPECT_EQ(session_->frame()->stats.triangles, all);
}

TEST_F(ClipTest, HandlesStandOutBelowThePointer) {
    trigger("clip.crop");
    const QPoint point = pointOf({Kind::Face, 0, true});
    const auto moveTo = [this](QPointF at) {
        QMouseEvent move(QEvent::MouseMove, at, viewport().mapToGlobal(at), Qt::NoButton, Qt::NoButton, Qt::NoModifier);
        QApplication::sendEvent(&viewport().view(), &move); // which is where a pointer's events come first
    };
    EXPECT_TRUE(viewport().view().hasMouseTracking());
    moveTo(point);
    EXPECT_EQ(viewport().cursor().shape(), Qt::SizeAllCursor);
    moveTo(point + QPoint(0, 60));
    EXPECT_NE(viewport().cursor().shape(), Qt::SizeAllCursor);
    trigger("view.measure");
    moveTo(point);
    moveTo(point + QPoint(0, 60));
    EXPECT_EQ(viewport().cursor().shape(), Qt::CrossCursor) << "as it was before";
}

TEST_F(ClipTest, TheTextAtAHandleFollowsAPlaneThatIsMovedFromElsewhere) {
    press(Qt::Key_V);
    const QPointF at = pointOf(ClipHandle{Kind::Plane});
    QMouseEvent move(QEvent::MouseMove, at, viewport().mapToGlobal(at), Qt::NoButton, Qt::NoButton, Qt::NoModifier);
    QApplication::sendEvent(&viewport().view(), &move);
    EXPECT_TRUE(handles().text().startsWith(QStringLiteral("0"))) << handles().text().toStdString();
    auto& view = window_->viewportHost().viewState();
    auto options = view.options();
    options.clipping.plane().offset = 3.0;
    view.setOptions(options);
    EXPECT_TRUE(handles().text().startsWith(QStringLiteral("3"))) << handles().text().toStdString();
}

TEST_F(ClipTest, WhatIsCroppedAwayIsNeitherPickedNorMeasured) {
    const QPoint onBall = seenAt(glm::dvec3(kMiddle + 5.0, kMiddle, kMiddle));
    const auto selected = [this] { return window_->viewportHost().viewState().options().pieces.selected.has_value(); };
    doubleClick(viewport(), Qt::LeftButton, {}, onBall);
    ASSERT_TRUE(waitUntil(selected)) << "the test shows something";
    trigger("clip.crop");
    drag(pointOf({Kind::Face, 0, true}), seenAt(glm::dvec3(12.0, kMiddle, kMiddle)));
    ASSERT_EQ(clipping().crop->high[0], 12);
    doubleClick(viewport(), Qt::LeftButton, {}, onBall);
    ASSERT_TRUE(waitUntil([&] { return !selected(); }));
    trigger("view.measure");
    const auto& measured = window_->viewportHost().viewState().options().measured;
    QTest::mouseClick(&viewport(), Qt::LeftButton, {}, onBall);
    EXPECT_TRUE(measured.empty());
    // From the front only its far inside is left behind a plane across the view.
    trigger("clip.acrossY");
    trigger("clip.flip");
    QTest::mouseClick(&viewport(), Qt::LeftButton, {}, seenAt(glm::dvec3(kMiddle - 5.0, kMiddle, kMiddle + 2.0)));
    ASSERT_EQ(window_->viewportHost().viewState().options().measured.size(), 1u);
    EXPECT_GT(window_->viewportHost().viewState().options().measured[0].y, 0.0);
}

// Its first axis runs along z, the second along x, the third along y.
TEST_F(ClipTest, RowsAndButtonsHaveTheNamesOfTheAxes) {
    const auto openTurned = [&](const char* name, const std::string& matrix) {
        const auto before = session_->datasetGeneration();
        const auto path = writeFloats(
            folder_, name, {20, 16, 12}, [](int x, int y, int z) { return x + y + z; },
            "ElementSpacing = 1 1 1\nTransformMatrix = " + matrix + "\nOffset = 0 0 0\n");
        window_->openFile(QString::fromStdString(path.string()));
        ASSERT_TRUE(waitUntil([&] { return session_->datasetGeneration() != before && session_->frame() != nullptr; }));
        ASSERT_TRUE(waitUntilSettled());
    };
    const auto buttons = [&] {
        QStringList texts;
        for (const auto* button : child<QDockWidget>("clipDock")->findChildren<QToolButton*>())
            if (button->defaultAction() != nullptr && button->text().size() == 1)
                texts << button->text();
        return texts.join(QLatin1Char(' ')).toStdString();
    };
    openTurned("permuted.mha", "0 0 1 1 0 0 0 1 0");
    EXPECT_EQ(child<QSpinBox>("cropHighZ")->value(), 19);
    child<QSpinBox>("cropLowX")->setValue(5);
    EXPECT_EQ(clipping().crop, (model::CropBox{{0, 5, 0}, {19, 15, 11}}));
    trigger("clip.acrossX");
    EXPECT_EQ(clipping().plane().normal, glm::dvec3(1.0, 0.0, 0.0));
    EXPECT_EQ(buttons(), "X Y Z");
    openTurned("turned.mha", "0.8 0.6 0 -0.6 0.8 0 0 0 1");
    EXPECT_EQ(buttons(), "i j k");
    EXPECT_EQ(child<QSpinBox>("cropLowX")->accessibleName(), QStringLiteral("First grid point along i"));
    EXPECT_EQ(action("clip.acrossZ").text(), QStringLiteral("Across &k"));
}

TEST_F(ClipTest, ThePanelShowsAndTakesNumbers) {
    auto* low = child<QSpinBox>("cropLowX");
    auto* high = child<QSpinBox>("cropHighX");
    EXPECT_EQ(low->value(), 0);
    EXPECT_EQ(high->value(), kPoints - 1);
    low->setValue(5);
    EXPECT_TRUE(clipping().isCropped) << "whoever gives a box wants it";
    EXPECT_EQ(clipping().crop, (model::CropBox{{5, 0, 0}, {23, 23, 23}}));
    high->setValue(3);
    EXPECT_EQ(high->value(), 6) << "a cell at least";
    EXPECT_EQ(clipping().crop->high[0], 6);
    drag(pointOf({Kind::Face, 0, false}), seenAt(glm::dvec3(2.0, kMiddle, kMiddle)));
    EXPECT_EQ(low->value(), clipping().crop->low[0]);
    EXPECT_LT(low->value(), 5);

    auto* offset = child<QDoubleSpinBox>("clipOffset");
    EXPECT_FALSE(offset->isEnabled());
    trigger("clip.acrossX");
    EXPECT_TRUE(offset->isEnabled());
    offset->setValue(3.5);
    EXPECT_EQ(clipping().plane().offset, 3.5);
    EXPECT_EQ(offset->maximum(), kMiddle);
    auto* filled = child<QComboBox>("clipCap");
    EXPECT_EQ(filled->currentIndex(), static_cast<int>(model::Cap::Colour));
    trigger("clip.valueCap");
    EXPECT_EQ(filled->currentIndex(), static_cast<int>(model::Cap::Values));
    trigger("clip.valueCap");
    EXPECT_TRUE(action("clip.valueCap").isChecked()) << "chosen again it stays";
    EXPECT_FALSE(action("clip.colourCap").isChecked());
    QStringList buttons;
    for (const auto* button : child<QDockWidget>("clipDock")->findChildren<QToolButton*>())
        if (button->defaultAction() != nullptr)
            buttons << button->text();
    EXPECT_EQ(buttons.join(QLatin1Char(' ')).toStdString(), "Crop Reset Clip Flip Second X Y Z the View") << "short";
    child<QDockWidget>("clipDock")->raise();
    keepPicture(*window_, "clip_panel");
}

TEST_F(ClipTest, ThePlaneIsMovedAndTurnedByItsHandles) {
    press(Qt::Key_V);
    ASSERT_TRUE(clipping().plane().isOn);
    EXPECT_EQ(clipping().plane().normal, glm::dvec3(1.0, 0.0, 0.0));
    EXPECT_EQ(clipping().plane().offset, 0.0);
    ASSERT_EQ(handles().handles().size(), 2u);
    drag(pointOf(ClipHandle{Kind::Plane}), seenAt(glm::dvec3(kMiddle + 4.0, kMiddle, kMiddle)));
    EXPECT_NEAR(clipping().plane().offset, 4.0, 0.15);
    const glm::dvec3 pivot = handles().placeOf({Kind::Plane});
    const QPoint middle = pointOf(ClipHandle{Kind::Plane});
    drag(pointOf(ClipHandle{Kind::Normal}), middle + QPoint(0, -400));
    EXPECT_NEAR(clipping().plane().normal.z, 1.0, 0.01) << "upwards";
    EXPECT_NEAR(glm::length(clipping().plane().normal), 1.0, 1e-12);
    EXPECT_NEAR(glm::dot(clipping().plane().normal, pivot), clipping().plane().offset, 1e-9);
    const auto before = clipping().plane();
    press(Qt::Key_V, Qt::ShiftModifier);
    EXPECT_EQ(clipping().plane().normal, -before.normal);
    EXPECT_EQ(clipping().plane().offset, -before.offset);
    press(Qt::Key_V, Qt::ControlModifier | Qt::ShiftModifier);
    EXPECT_NEAR(glm::dot(clipping().plane().normal, viewport().camera().backward()), 1.0, 1e-9);
    EXPECT_NEAR(clipping().plane().offset, 0.0, 1e-12);
    press(Qt::Key_V);
    EXPECT_FALSE(clipping().plane().isOn);
}

TEST_F(ClipTest, ASecondPlaneHasSeparateHandlesKeysAndFields) {
    press(Qt::Key_V);
    auto* dock = child<QDockWidget>("clipDock");
    dock->raise();
    press(Qt::Key_V, Qt::ControlModifier | Qt::AltModifier);
    EXPECT_TRUE(action("clip.second").isChecked());
    ASSERT_EQ(clipping().active, 1u);
    EXPECT_TRUE(clipping().plane().isOn) << "chosen, it cuts";
    EXPECT_EQ(clipping().plane().normal, glm::dvec3(0.0, 1.0, 0.0));
    ASSERT_EQ(handles().handles().size(), 2u) << "those of one plane";
    const auto first = clipping().planes[0];
    action("clip.acrossZ").trigger();
    EXPECT_EQ(clipping().plane().normal, glm::dvec3(0.0, 0.0, 1.0));
    child<QDoubleSpinBox>("clipOffset")->setValue(2.5);
    EXPECT_EQ(clipping().planes[1].offset, 2.5);
    press(Qt::Key_V, Qt::ShiftModifier);
    EXPECT_EQ(clipping().planes[1].normal, glm::dvec3(0.0, 0.0, -1.0));
    drag(pointOf(ClipHandle{Kind::Plane}), seenAt(glm::dvec3(kMiddle, kMiddle, kMiddle + 6.0)), 6);
    EXPECT_NEAR(clipping().planes[1].offset, -6.0, 0.3);
    EXPECT_EQ(clipping().planes[0], first);
    for (const std::size_t place : {0u, 1u})
        EXPECT_TRUE(waitUntil([&] {
            auto& of = window_->viewportHost().clipTool()->cap(place);
            return of.isSettled() && of.samples() != nullptr;
        })) << place;
    keepPicture(*window_, "two_clip_planes");
    // Back at the first one, the second still cuts.
    press(Qt::Key_V, Qt::ControlModifier | Qt::AltModifier);
    EXPECT_EQ(clipping().active, 0u);
    EXPECT_FALSE(action("clip.second").isChecked());
    EXPECT_TRUE(clipping().planes[1].isOn);
    press(Qt::Key_V);
    EXPECT_FALSE(clipping().planes[0].isOn);
    EXPECT_TRUE(clipping().hasPlane());
    EXPECT_TRUE(action("pieces.exportShown").isEnabled()) << "what the second one leaves";
}

// As for a box of degrees by metres: handles stay apart and are dragged to where they are seen.
TEST_F(ClipTest, ThePlaneIsMovedWhereLengthsAreStretched) {
    auto options = window_->viewportHost().viewState().options();
    for (const double by : {0.01, 100.0}) {
        options = window_->viewportHost().viewState().options();
        options.stage.stretch = {by, 1.0, 1.0};
        options.clipping.plane() = {};
        options.clipping.plane().isOn = true; // across X
        window_->viewportHost().viewState().setOptions(options);
        press(Qt::Key_R);
        QTest::keyClick(window_.get(), Qt::Key_1);
        QTest::qWait(700); // the camera flies
        const QPoint plane = pointOf(ClipHandle{Kind::Plane}), normal = pointOf(ClipHandle{Kind::Normal});
        EXPECT_GT((normal - plane).manhattanLength(), 30) << by;
        EXPECT_LT((normal - plane).manhattanLength(), viewport().width() / 2) << by;
        const double offset = clipping().plane().offset;
        drag(plane, seenAt(glm::dvec3(kMiddle + 4.0, kMiddle, kMiddle)), by < 1.0 ? 1 : 6);
        if (by > 1.0) { // otherwise 4 cells are less than a pixel
            EXPECT_NEAR(clipping().plane().offset, offset + 4.0, 0.15) << by;
        } else {
            EXPECT_EQ(clipping().plane().normal, glm::dvec3(1.0, 0.0, 0.0)) << "the plane's handle, not the normal's";
        }
    }
}

TEST_F(ClipTest, ADragIsOneStepAndAllOfItIsKeptInSessions) {
    letStepEnd();
    trigger("clip.crop");
    letStepEnd();
    const auto before = clipping();
    drag(pointOf({Kind::Face, 0, true}), seenAt(glm::dvec3(15.0, kMiddle, kMiddle)), 30); // longer than a step waits
    letStepEnd();
    const auto cropped = clipping();
    EXPECT_TRUE(action("edit.undo").text().contains(QStringLiteral("Clipping")));
    trigger("clip.facing");
    letStepEnd();
    trigger("clip.valueCap");
    letStepEnd();
    const auto all = clipping();
    trigger("edit.undo");
    trigger("edit.undo");
    EXPECT_EQ(clipping(), cropped);
    trigger("edit.undo");
    EXPECT_EQ(clipping(), before);
    for (int step = 0; step < 3; ++step)
        trigger("edit.redo");
    EXPECT_EQ(clipping(), all);
    dialogs_.answers.push_back(QString::fromStdString((folder_ / "a.isosession").string()));
    trigger("file.saveSession");
    ASSERT_TRUE(waitUntil([this] { return window_->messageBar().isVisible(); }));
    openOther();
    EXPECT_EQ(clipping(), model::Clipping()) << "of another volume";
    EXPECT_FALSE(action("clip.crop").isChecked());
    openBall(kPoints); // another file of that name lies there
    drop(folder_ / "a.isosession");
    ASSERT_TRUE(waitUntil([&] { return session_->isSettled() && clipping() == all; }));
    EXPECT_TRUE(action("clip.crop").isChecked());
    EXPECT_TRUE(action("clip.plane").isChecked());
}

TEST_F(ClipTest, ABoxOfASessionIsBroughtWithinTheVolume) {
    auto options = window_->viewportHost().viewState().options();
    options.clipping.isCropped = true;
    options.clipping.crop = model::CropBox{{5, 900, 7}, {900, 901, 7}};
    options.clipping.plane() = {true, {0.0, 0.0, 7.0}, 1e6, model::Cap::Colour};
    window_->viewportHost().viewState().setOptions(options);
    EXPECT_EQ(clipping().crop, (model::CropBox{{5, 22, 7}, {23, 23, 8}}));
    EXPECT_EQ(clipping().plane().normal, glm::dvec3(0.0, 0.0, 1.0));
    EXPECT_EQ(clipping().plane().offset, kMiddle);
}

TEST_F(ClipTest, TheCapFollowsPlaneAndIsovalueAndIsInSavedPictures) {
    trigger("clip.facing");
    ASSERT_TRUE(waitUntil([this] { return cap().isSettled() && cap().samples() != nullptr; }));
    EXPECT_TRUE(cap().problem().empty());
    // Darker and warmer than the surface.
    const auto isCap = [this](const glm::dvec3& place) {
        const QImage picture = window_->viewportHost().picture();
        const double ratio = static_cast<double>(picture.width()) / viewport().width();
        const QRgb pixel = picture.pixel((QPointF(seenAt(place)) * ratio).toPoint());
        return qRed(pixel) > 150 && qRed(pixel) > 1.6 * qBlue(pixel);
    };
    const glm::dvec3 middle(kMiddle);
    EXPECT_TRUE(isCap(middle + glm::dvec3(2.0, 0.0, 3.0)));
    EXPECT_TRUE(isCap(middle + glm::dvec3(-7.5, 0.0, 0.0)));
    EXPECT_FALSE(isCap(middle + glm::dvec3(-8.5, 0.0, 0.0)));
    ASSERT_TRUE(session_->isovalue().request(-5.0));
    ASSERT_TRUE(waitUntilSettled());
    EXPECT_TRUE(isCap(middle + glm::dvec3(-4.5, 0.0, 0.0)));
    EXPECT_FALSE(isCap(middle + glm::dvec3(-5.5, 0.0, 0.0)));
    child<QDoubleSpinBox>("clipOffset")->setValue(4.0); // towards the viewer: a disc of radius 3
    ASSERT_TRUE(waitUntil([this] { return cap().isSettled(); }));
    EXPECT_TRUE(isCap(middle + glm::dvec3(2.0, -4.0, 0.0)));
    EXPECT_FALSE(isCap(middle + glm::dvec3(3.5, -4.0, 0.0)));
    keepPicture(*window_, "cap");
    trigger("clip.noCap");
    EXPECT_FALSE(isCap(middle + glm::dvec3(2.0, -4.0, 0.0)));
    EXPECT_EQ(cap().samples(), nullptr) << "nothing is kept for nobody";
}

TEST_F(ClipTest, AnIndexThatIsGoneTellsWhyTheCutIsOpen) {
    const auto* label = child<QLabel>("clipProblem");
    for (const bool isGone : {false, true}) {
        builder_->kind = index::IndexKind::Edges;
        openBall(22);
        ASSERT_TRUE(
            waitUntil([this] { return session_->indexState() == model::IndexState::Ready && session_->isSettled(); }));
        if (isGone)
            std::filesystem::remove(session_->dataset()->indexPath);
        trigger("clip.plane");
        ASSERT_TRUE(waitUntil([this] { return cap().isSettled(); }));
        EXPECT_EQ(cap().samples() == nullptr, isGone);
        EXPECT_EQ(cap().problem().empty(), !isGone);
        EXPECT_EQ(label->isHidden(), cap().problem().empty());
        EXPECT_EQ(label->text().toStdString(), cap().problem());
        trigger("clip.plane");
    }
}

TEST_F(ClipTest, WhatIsShownIsExportedAndTheCropClosed) {
    const auto write = [this](const char* id, const char* name) {
        dialogs_.answers.push_back(QString::fromStdString((folder_ / name).string()));
        EXPECT_TRUE(action(id).isEnabled()) << id;
        action(id).trigger();
        EXPECT_TRUE(waitUntil([&] { return std::filesystem::exists(folder_ / name); })) << name;
        EXPECT_TRUE(waitUntilSettled());
        return mesh::checkMeshFile(folder_ / name).value();
    };
    EXPECT_FALSE(action("pieces.exportShown").isEnabled());
    EXPECT_FALSE(action("clip.exportClosed").isEnabled());
    auto options = window_->viewportHost().viewState().options();
    options.clipping.isCropped = true;
    options.clipping.crop = model::CropBox{{0, 0, 0}, {11, 23, 23}}; // half a cell short of the middle
    window_->viewportHost().viewState().setOptions(options);
    const double ball = 4.0 / 3.0 * std::numbers::pi * std::pow(kRadius, 3);
    const double slab = std::numbers::pi * kRadius * kRadius * 0.5;
    const auto open = write("pieces.exportShown", "open.ply");
    EXPECT_FALSE(open.isClosed);
    EXPECT_EQ(open.boundaryLoops, 1u);
    const auto closed = write("clip.exportClosed", "closed.ply");
    EXPECT_TRUE(closed.isClosed && closed.isManifold && closed.isOriented);
    EXPECT_GT(closed.triangles, open.triangles);
    EXPECT_NEAR(closed.enclosedVolume, ball / 2.0 - slab, 0.02 * ball);
    EXPECT_FALSE(window_->messageBar().isVisible() &&
                 window_->messageBar().findChild<QLabel*>()->text().contains(QStringLiteral("not sound")));
    trigger("clip.crop");
    trigger("clip.acrossZ");
    ASSERT_TRUE(action("clip.plane").isChecked());
    const auto half = write("pieces.exportShown", "half.ply");
    EXPECT_EQ(half.boundaryLoops, 1u) << "one cut, without cracks";
    EXPECT_TRUE(half.isManifold && half.isOriented);
    EXPECT_NEAR(half.area, 2.0 * std::numbers::pi * kRadius * kRadius, 0.02 * half.area);
    EXPECT_FALSE(action("clip.exportClosed").isEnabled()) << "there is no box";
    session_->detail().setError({extract::MergeBound::Measure::Distance, 0.2});
    trigger("clip.plane");
    trigger("clip.crop");
    ASSERT_TRUE(waitUntil([this] { return session_->isSettled() && session_->frame()->mergeBound.limit > 0.0; }));
    EXPECT_FALSE(action("clip.exportClosed").isEnabled()) << "merged cells reach across the sides";
    const auto merged = write("pieces.exportShown", "merged.ply");
    EXPECT_LT(merged.triangles, open.triangles);
    EXPECT_NEAR(merged.area, open.area, 0.03 * open.area);
}

TEST(ClipActions, AreOffWithoutAView) {
    // Seen where there is no OpenGL; elsewhere without a volume.
    class Window : public WindowTest {
    public:
        void TestBody() override {}
        bool isEnabled(const char* id) { return window_->actions().action(id)->isEnabled(); }
    } window;
    for (const char* id : {"clip.crop", "clip.resetCrop", "clip.plane", "clip.flip", "clip.facing", "clip.acrossX",
                           "clip.noCap", "clip.colourCap", "clip.valueCap"})
        EXPECT_FALSE(window.isEnabled(id)) << id;
}

} // namespace
} // namespace isoslider::test
