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

} // namespace
} // namespace isoslider::test
