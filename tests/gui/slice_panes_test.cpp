// Panes of slices: when they are there, and what is written in them.
#include <QAction>
#include <QTest>

#include "tests/gui/float_volume.h"
#include "tests/gui/window_fixture.h"
#include "ui/model/slices/slice_model.h"
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
    widgets::SlicePane& pane(SliceKind kind) { return window_->sliceWorkspace().pane(kind); }
    bool isSeen(SliceKind kind) { return pane(kind).isVisible(); }
    void press(Qt::Key key) { QTest::keyClick(window_.get(), key); }
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

} // namespace
} // namespace isoslider::test
