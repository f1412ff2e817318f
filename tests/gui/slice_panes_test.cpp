// Panes of slices: when they are there, and what is written in them.
#include <algorithm>
#include <map>

#include <QAction>
#include <QTest>
#include <QWheelEvent>

#include "tests/gui/float_volume.h"
#include "tests/gui/window_fixture.h"
#include "ui/model/slices/slice_model.h"
#include "ui/widgets/common/text_colour.h"
#include "ui/widgets/slices/slice_pane.h"
#include "ui/widgets/slices/slice_workspace.h"
#include "ui/widgets/viewport/viewport_host.h"
#include "ui/widgets/window/action_registry.h"

namespace isoslider::test {
namespace {

using model::SliceKind;

class SlicePanesTest : public WindowTest {
protected:
    void openRamp() {
        window_->openFile(qpath(writeFloats(folder_, "ramp.mha", {20, 16, 12},
                                            [](int x, int y, int z) { return x + 100 * y + 10000 * z; })));
        ASSERT_TRUE(waitUntil([this] { return session_->frame() != nullptr; }));
        ASSERT_TRUE(waitUntilSettled());
    }
    /// The same, twice as far apart along its third axis, with lines of the header that place it in space.
    void openIn(const char* name, const std::string& place) {
        const auto before = session_->datasetGeneration();
        window_->openFile(qpath(writeFloats(
            folder_, name, {20, 16, 12}, [](int x, int y, int z) { return x + 100 * y + 10000 * z; },
            "ElementSpacing = 1 1 2\n" + place)));
        ASSERT_TRUE(waitUntil([&] { return session_->datasetGeneration() != before && session_->frame() != nullptr; }));
        ASSERT_TRUE(waitUntilSettled());
        press(Qt::Key_F7);
        ASSERT_TRUE(waitForSlices());
    }
    QString readingAt(SliceKind kind, const glm::dvec3& place) {
        const QPointF point = pane(kind).pointOf(place).toPoint();
        QMouseEvent move(QEvent::MouseMove, point, pane(kind).mapToGlobal(point), Qt::NoButton, Qt::NoButton, {});
        QApplication::sendEvent(&pane(kind), &move);
        return pane(kind).readout();
    }
    model::SliceModel& slices() { return window_->slices(); }
    widgets::SlicePane& pane(SliceKind kind) { return window_->sliceWorkspace().pane(kind); }
    bool isSeen(SliceKind kind) { return pane(kind).isVisible(); }
    void press(Qt::Key key) { QTest::keyClick(window_.get(), key); }
    bool waitForSlices() {
        return waitUntil([this] { return session_->isSettled() && slices().isSettled(); });
    }
    static void wheel(QWidget& widget, QPoint point, int angle, Qt::KeyboardModifiers modifiers) {
        QWheelEvent event(point, widget.mapToGlobal(QPointF(point)), {}, {0, angle}, Qt::NoButton, modifiers,
                          Qt::NoScrollPhase, false);
        QApplication::sendEvent(&widget, &event);
    }
};

TEST_F(SlicePanesTest, WithoutAVolumeThereAreNoPanes) {
    openRamp();
    press(Qt::Key_F7);
    ASSERT_TRUE(isSeen(SliceKind::X) && isSeen(SliceKind::Y) && isSeen(SliceKind::Z));
    trigger("file.close");
    for (const Qt::Key key : {Qt::Key_F7, Qt::Key_F8, Qt::Key_F6, Qt::Key_F7}) {
        for (const SliceKind kind : model::kSliceKinds)
            EXPECT_FALSE(isSeen(kind)) << key;
        press(key);
    }
    QTest::qWait(20);
    EXPECT_NEAR(window_->viewportHost().width(), window_->sliceWorkspace().width(), 2)
        << "the start page has all of it";
    openRamp();
    EXPECT_TRUE(isSeen(SliceKind::X) && isSeen(SliceKind::Y) && isSeen(SliceKind::Z)) << "as it was chosen";
    QTest::qWait(20);
    EXPECT_NEAR(window_->viewportHost().width(), 0.68 * window_->sliceWorkspace().width(), 20);
}

TEST_F(SlicePanesTest, WindowAndLevelAreLegibleOnWhite) {
    openRamp();
    press(Qt::Key_F6);
    slices().change([](model::SliceOptions& options) { options.window = model::ValueWindow{-2.0, -1.0}; });
    ASSERT_TRUE(waitForSlices());
    wheel(pane(SliceKind::Z), pane(SliceKind::Z).rect().center(), 1200, Qt::ShiftModifier); // all of it is slice
    QTest::qWait(50);
    const QImage picture = pane(SliceKind::Z).grab().toImage();
    const QColor white(picture.pixel(picture.width() / 2 + 20, picture.height() - 60));
    ASSERT_GT(white.lightness(), 240);
    // What most pixels around the words have is what they are read against.
    const QRect corner(picture.width() - 34, picture.height() - 32, 26, 24);
    std::map<QRgb, int> counts;
    for (int y = corner.top(); y <= corner.bottom(); ++y)
        for (int x = corner.left(); x <= corner.right(); ++x)
            ++counts[picture.pixel(x, y)];
    const auto ground = std::max_element(counts.begin(), counts.end(),
                                         [](const auto& a, const auto& b) { return a.second < b.second; });
    double most = 1.0;
    for (const auto& [colour, count] : counts) {
        // Not of an outline that makes words darker than they are meant.
        if (QColor(colour).lightness() > 150)
            most = std::max(most, widgets::contrastOf(QColor(colour), QColor(ground->first)));
    }
    EXPECT_GE(most, 4.5);
    keepPicture(*window_, "slices_window_on_white");
}

// Its first axis runs along z, the second along x, the third along y.
TEST_F(SlicePanesTest, WhatIsSeenAndDoneIsNamedByTheWorldWhateverTheOrderOfTheSamples) {
    openIn("permuted.mha", "DistanceUnits = mm\nTransformMatrix = 0 0 1 1 0 0 0 1 0\nOffset = 100 200 300\n");
    EXPECT_EQ(pane(SliceKind::X).caption(), QStringLiteral("X = 108 mm (8 of 15)"));
    EXPECT_EQ(pane(SliceKind::Y).caption(), QStringLiteral("Y = 212 mm (6 of 11)"));
    EXPECT_EQ(pane(SliceKind::Z).caption(), QStringLiteral("Z = 310 mm (10 of 19)"));
    const auto labels = slices().labels(SliceKind::Z);
    EXPECT_EQ(labels.right + labels.bottom, "XY");
    EXPECT_EQ(readingAt(SliceKind::Z, {10.0, 5.0, 7.0}),
              QStringLiteral("70510   at (i 10, j 5, k 7)\n105, 214, 310 mm"));
    pane(SliceKind::Z).setFocus();
    press(Qt::Key_Period);
    EXPECT_EQ(slices().options().position, glm::dvec3(11.0, 8.0, 6.0));
    if (window_->viewportHost().viewport() != nullptr) { // else there is no scene
        QTest::keyClick(window_.get(), Qt::Key_Z, Qt::ShiftModifier);
        EXPECT_TRUE(slices().options().inScene[placeOf(SliceKind::Z)]);
    }
    const glm::dvec3 normal = slices().planeOf(SliceKind::Z).normal();
    EXPECT_EQ(normal.y, 0.0);
    EXPECT_EQ(normal.z, 0.0);
    EXPECT_EQ(window_->actions().action("slices.sceneZ")->text(), QStringLiteral("Across &Z"));
    keepPicture(*window_, "slices-permuted");
}

TEST_F(SlicePanesTest, AxesOfATurnedGridAreCalledByOtherLetters) {
    openIn("turned.mha", "DistanceUnits = mm\nTransformMatrix = 0.8 0.6 0 -0.6 0.8 0 0 0 1\nOffset = 0 0 0\n");
    EXPECT_EQ(pane(SliceKind::X).caption(), QStringLiteral("i = 10 of 19"));
    EXPECT_EQ(pane(SliceKind::Z).caption(), QStringLiteral("k = 6 of 11"));
    EXPECT_EQ(slices().labels(SliceKind::Z).right, "i");
    EXPECT_EQ(readingAt(SliceKind::Z, {5.0, 5.0, 6.0}), QStringLiteral("60505   at (i 5, j 5, k 6)\n1, 7, 12 mm"));
    QAction& across = *window_->actions().action("slices.sceneX");
    EXPECT_EQ(across.text(), QStringLiteral("Across &i"));
    EXPECT_EQ(across.toolTip(), QStringLiteral("The slice across i in the 3-D view (Shift+X)"));
    openIn("plain.mha", "Offset = 0 0 5\n");
    EXPECT_EQ(across.text(), QStringLiteral("Across &X"));
}

TEST_F(SlicePanesTest, CaptionsGiveThePlaceWhereTheUnitIsUnknown) {
    openIn("plain.mha", "Offset = 0 0 5\n");
    EXPECT_EQ(pane(SliceKind::Z).caption(), QStringLiteral("Z = 17 (6 of 11)"));
}

TEST_F(SlicePanesTest, PlacesInAPatientHaveTheirDirections) {
    openIn("patient.mha", "DistanceUnits = mm\nTransformMatrix = 1 0 0 0 1 0 0 0 1\nOffset = -10 20 30\n"
                          "AnatomicalOrientation = RAI\n");
    EXPECT_EQ(pane(SliceKind::Z).caption(), QStringLiteral("Axial   S 42 mm (6 of 11)"));
    EXPECT_EQ(pane(SliceKind::X).caption(), QStringLiteral("Sagittal   L 0 mm (10 of 19)"));
    EXPECT_EQ(readingAt(SliceKind::Z, {5.0, 7.0, 6.0}), QStringLiteral("60705   at (5, 7, 6)\nR 5, P 27, S 42 mm"));
    keepPicture(*window_, "slices-patient");
}

TEST_F(SlicePanesTest, ANarrowPaneKeepsThePlaceAndItsUnitLongest) {
    openIn("patient.mha", "DistanceUnits = mm\nTransformMatrix = 1 0 0 0 1 0 0 0 1\nOffset = -10.25 20.125 30\n"
                          "AnatomicalOrientation = RAI\n");
    auto& coronal = pane(SliceKind::Y);
    QStringList shown;
    for (int width = 400; width >= 110; width -= 10) {
        coronal.resize(width, 120);
        const QString text = coronal.shownCaption();
        EXPECT_LE(coronal.fontMetrics().horizontalAdvance(text), width) << width;
        EXPECT_TRUE(text.contains(QStringLiteral("P 28.125 mm"))) << width << text.toStdString();
        if (shown.isEmpty() || shown.last() != text)
            shown << text;
    }
    EXPECT_EQ(shown.join(QStringLiteral(" | ")).toStdString(),
              "Coronal   P 28.125 mm (8 of 15) | Coronal   P 28.125 mm | P 28.125 mm");
}

} // namespace
} // namespace isoslider::test
