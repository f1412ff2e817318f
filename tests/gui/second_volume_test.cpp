// A second volume beside the first: opened, shown at its place, changed in the panel, undone and kept.
#include <cmath>

#include <QAction>
#include <QDockWidget>
#include <QSlider>
#include <QTableView>
#include <QTest>
#include <QToolButton>

#include "tests/gui/float_volume.h"
#include "tests/gui/window_fixture.h"
#include "ui/model/session/saved_session.h"
#include "ui/widgets/panels/surface_table.h"
#include "ui/widgets/viewport/viewport_host.h"
#include "ui/widgets/viewport/viewport_widget.h"
#include "ui/widgets/window/action_registry.h"
#include "ui/widgets/window/message_bar.h"
#include "ui/widgets/window/session_keeper.h"

namespace isoslider::test {
namespace {

using widgets::SurfaceTable;

constexpr double kSpacing = 0.5, kOffset = 40.0; // so it ends beyond the ball of 32 points

class SecondVolumeTest : public WindowTest {
protected:
    /// -distance from the middle, which is at (43.75, 43.75, 43.75) of the space of the first: outside of its box.
    std::filesystem::path writeSmallBall(const char* name = "small.mha") {
        return writeFloats(
            folder_, name, {16, 16, 16},
            [](int x, int y, int z) { return -kSpacing * std::hypot(x - 7.5, y - 7.5, z - 7.5); },
            "ElementSpacing = 0.5 0.5 0.5\nOffset = 40 40 40\n");
    }
    void open() {
        settings_->set("files/previewsFirst", false);
        openBall(32);
        child<QDockWidget>("surfacesDock")->raise();
        session_->isovalue().request(-12.0);
        settle();
        letStepEnd();
    }
    void openBoth() {
        open();
        dialogs_.answers = {qpath(writeSmallBall())};
        trigger("second.open");
        settle();
        ASSERT_NE(second().dataset(), nullptr);
        letStepEnd();
    }
    void settle() { ASSERT_TRUE(waitUntilSettled()); }
    static void letStepEnd() { QTest::qWait(600); }
    model::SecondVolume& second() { return session_->secondVolume(); }
    const std::vector<model::ListedSurface>& all() { return second().surfaces().list().surfaces; }
    QTableView* table() { return child<QTableView>("secondSurfaceTable"); }
    void clickBox(int row) {
        const QRect box = table()->visualRect(table()->model()->index(row, SurfaceTable::Shown));
        QTest::mouseClick(table()->viewport(), Qt::LeftButton, {}, QPoint(box.left() + 10, box.center().y()));
    }
    QImage picture() { return window_->viewportHost().viewport()->grabFramebuffer(); }
    bool hasView() { return window_->viewportHost().viewport() != nullptr; }
    void undo() { QTest::keyClick(window_.get(), Qt::Key_Z, Qt::ControlModifier); }
    void redo() { QTest::keyClick(window_.get(), Qt::Key_Z, Qt::ControlModifier | Qt::ShiftModifier); }
};

TEST_F(SecondVolumeTest, IsShownAtItsPlaceUntilItIsHidden) {
    open();
    if (!hasView())
        GTEST_SKIP() << "without OpenGL";
    window_->viewportHost().viewport()->changeCamera([](model::Camera& camera) { camera.zoom(0.4, {0.0, 0.0}, 1.0); });
    const QImage before = picture();
    dialogs_.answers = {qpath(writeSmallBall())};
    trigger("second.open");
    settle();
    EXPECT_EQ(dialogs_.asked.title, QStringLiteral("Open Second Volume"));
    ASSERT_EQ(all().size(), 1u);
    EXPECT_NE(all()[0].colour, session_->surfaces().active()->colour);
    const auto frame = second().pictureOf(all()[0].id);
    ASSERT_NE(frame, nullptr);
    EXPECT_GT(frame->stats.triangles, 100u);
    const QImage with = picture();
    ASSERT_EQ(with.size(), before.size()) << "the panel does not push the view";
    // What is new lies around the place of its middle.
    auto& viewport = *window_->viewportHost().viewport();
    const double aspect = static_cast<double>(viewport.width()) / viewport.height();
    const glm::dvec3 centred = glm::dvec3(kOffset + 7.5 * kSpacing) - glm::dvec3(15.5);
    const glm::dvec4 clip =
        viewport.camera().projectionMatrix(aspect) * viewport.camera().viewMatrix() * glm::dvec4(centred, 1.0);
    ASSERT_LT(std::abs(clip.z / clip.w), 1.0) << "between the planes of the camera";
    const QPoint middle(static_cast<int>((0.5 + 0.5 * clip.x / clip.w) * with.width()),
                        static_cast<int>((0.5 - 0.5 * clip.y / clip.w) * with.height()));
    ASSERT_TRUE(with.rect().contains(middle));
    EXPECT_GT(std::abs(qGray(with.pixel(middle)) - qGray(before.pixel(middle))), 30);
    const QPoint ball(with.width() / 2, with.height() / 2);
    EXPECT_EQ(with.pixel(ball), before.pixel(ball)) << "the first stays where it is";
    keepPicture(*window_, "second_volume");
    clickBox(0);
    EXPECT_FALSE(all()[0].isVisible);
    EXPECT_EQ(picture().pixel(middle), before.pixel(middle));
}

TEST_F(SecondVolumeTest, ItsSurfacesAreAddedMovedAndRemoved) {
    openBoth();
    EXPECT_TRUE(child<QLabel>("secondName")->text().contains(QStringLiteral("small.mha")));
    EXPECT_TRUE(child<QLabel>("secondName")->toolTip().contains(QStringLiteral("apart")) ||
                child<QLabel>("secondName")->text().contains(QStringLiteral("apart")));
    const double first = all()[0].isovalue;
    auto* isovalue = child<QSlider>("secondIsovalue");
    QTest::keyClick(isovalue, Qt::Key_PageUp);
    EXPECT_GT(all()[0].isovalue, first);
    settle();
    EXPECT_EQ(second().pictureOf(all()[0].id)->isovalue, all()[0].isovalue);
    EXPECT_EQ(session_->isovalue().requested(), -12.0) << "the handle is that of the first volume";
    QTest::keyClick(window_.get(), Qt::Key_Insert, Qt::AltModifier);
    ASSERT_EQ(all().size(), 2u);
    settle();
    EXPECT_NE(second().pictureOf(all()[1].id), nullptr);
    EXPECT_EQ(session_->surfaces().list().surfaces.size(), 1u);
    QTest::keyClick(child<QSlider>("secondSurfaceOpacity"), Qt::Key_PageDown);
    EXPECT_LT(all()[1].opacity, 1.0);
    table()->model()->setData(table()->model()->index(1, SurfaceTable::Isovalue), QStringLiteral("-1e9"));
    EXPECT_EQ(all()[1].isovalue, second().dataset()->min) << "clamped to the values that it has";
    QTest::keyClick(window_.get(), Qt::Key_Delete, Qt::AltModifier | Qt::ShiftModifier);
    ASSERT_EQ(all().size(), 1u);
    EXPECT_FALSE(window_->actions().action("second.removeSurface")->isEnabled());
    keepPicture(*window_, "second_volume_panel");
    session_->close();
    EXPECT_EQ(second().dataset(), nullptr);
    EXPECT_FALSE(child<QWidget>("secondVolume")->isVisible());
}

TEST_F(SecondVolumeTest, UndoTakesItAwayAndBringsItBackAsItWas) {
    openBoth();
    QTest::keyClick(child<QSlider>("secondIsovalue"), Qt::Key_PageUp);
    letStepEnd();
    clickBox(0);
    letStepEnd();
    const auto last = second().state();
    QTest::keyClick(window_.get(), Qt::Key_W, Qt::ControlModifier | Qt::AltModifier);
    EXPECT_EQ(second().dataset(), nullptr);
    letStepEnd();
    undo();
    settle();
    EXPECT_EQ(second().state(), last);
    ASSERT_NE(second().dataset(), nullptr);
    undo();
    EXPECT_TRUE(all()[0].isVisible);
    undo();
    undo();
    EXPECT_EQ(second().dataset(), nullptr);
    EXPECT_FALSE(window_->actions().action("edit.undo")->text().contains(QStringLiteral("Second")));
    for (int step = 0; step < 3; ++step) {
        redo();
        settle();
        letStepEnd(); // nothing of it is a new step
    }
    EXPECT_EQ(second().state(), last);
    EXPECT_TRUE(window_->actions().action("edit.redo")->isEnabled());
}

TEST_F(SecondVolumeTest, ASessionKeepsItWithItsSurfaces) {
    openBoth();
    QTest::keyClick(window_.get(), Qt::Key_Insert, Qt::AltModifier);
    QTest::keyClick(child<QSlider>("secondSurfaceOpacity"), Qt::Key_PageDown);
    clickBox(0);
    settle();
    auto kept = second().state();
    dialogs_.answers = {qpath(folder_ / "s.isosession")};
    trigger("file.saveSession");
    ASSERT_TRUE(waitUntil([this] { return std::filesystem::exists(folder_ / "s.isosession"); }));
    session_->close();
    window_->sessionKeeper().open(qpath(folder_ / "s.isosession"));
    ASSERT_TRUE(waitUntil([this] { return second().dataset() != nullptr; }));
    settle();
    auto now = second().state();
    ASSERT_EQ(now.surfaces.surfaces.size(), kept.surfaces.surfaces.size());
    EXPECT_EQ(now, kept);
    EXPECT_NE(second().pictureOf(all()[1].id), nullptr);
}

TEST_F(SecondVolumeTest, WhatCannotBeOpenedIsReportedAndChangesNothing) {
    openBoth();
    const auto before = second().state();
    dialogs_.answers = {qpath(folder_.write("bad.mha", "ObjectType = Image\nNDims = 3\n"))};
    trigger("second.open");
    settle();
    EXPECT_TRUE(window_->messageBar().isVisible());
    EXPECT_EQ(second().state(), before);
    EXPECT_TRUE(second().opening().empty());
    letStepEnd();
    undo();
    EXPECT_EQ(second().dataset(), nullptr) << "the refusal was no step";
}

} // namespace
} // namespace isoslider::test
