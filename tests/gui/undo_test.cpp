// What a user changes is taken back, and made again, step by step.
#include <QAction>
#include <QMouseEvent>
#include <QTest>

#include "tests/gui/window_fixture.h"
#include "ui/model/slices/slice_model.h"
#include "ui/widgets/isovalue/histogram_plot.h"
#include "ui/widgets/isovalue/isovalue_panel.h"
#include "ui/widgets/viewport/viewport_host.h"
#include "ui/widgets/window/action_registry.h"

namespace isoslider::test {
namespace {

class UndoTest : public WindowTest {
protected:
    QAction& undo() { return *window_->actions().action("edit.undo"); }
    QAction& redo() { return *window_->actions().action("edit.redo"); }
    model::IsovalueModel& isovalue() { return session_->isovalue(); }
    const model::ViewOptions& view() { return window_->viewportHost().viewState().options(); }
    /// Another change is another step then.
    static void letStepEnd() { QTest::qWait(600); }
    void press(Qt::Key key, Qt::KeyboardModifiers modifiers) { QTest::keyClick(window_.get(), key, modifiers); }
};

TEST_F(UndoTest, IsovalueAndViewGoBackAndForth) {
    openBall();
    letStepEnd();
    EXPECT_FALSE(undo().isEnabled()) << undo().text().toStdString();
    const double first = isovalue().requested();
    isovalue().request(-5.0);
    letStepEnd();
    trigger("view.box");
    letStepEnd();
    trigger("isovalue.logCounts");
    letStepEnd();
    const auto last = view();
    const auto histogram = session_->histogramOptions().options();
    EXPECT_FALSE(redo().isEnabled());

    press(Qt::Key_Z, Qt::ControlModifier);
    EXPECT_NE(session_->histogramOptions().options(), histogram);
    EXPECT_TRUE(undo().text().contains(QStringLiteral("View"))) << undo().text().toStdString();
    press(Qt::Key_Z, Qt::ControlModifier);
    EXPECT_NE(view(), last);
    EXPECT_EQ(isovalue().requested(), -5.0);
    EXPECT_TRUE(undo().text().contains(QStringLiteral("-5"))) << undo().text().toStdString();
    press(Qt::Key_Z, Qt::ControlModifier);
    EXPECT_EQ(isovalue().requested(), first);
    EXPECT_FALSE(undo().isEnabled());
    ASSERT_TRUE(waitUntil([&] { return isovalue().displayed() == first; }));

    for (int step = 0; step < 3; ++step)
        press(Qt::Key_Z, Qt::ControlModifier | Qt::ShiftModifier);
    EXPECT_EQ(isovalue().requested(), -5.0);
    EXPECT_EQ(view(), last);
    EXPECT_EQ(session_->histogramOptions().options(), histogram);
    EXPECT_FALSE(redo().isEnabled());
    letStepEnd();
    EXPECT_FALSE(redo().isEnabled()) << "what was done again is no new step";
}

TEST_F(UndoTest, ADragIsOneStepHoweverLong) {
    openBall();
    letStepEnd();
    const double first = isovalue().requested();
    auto& plot = window_->isovaluePanel().plot();
    const int y = plot.axisRect()->center().y();
    const auto pixel = [&](double value) { return static_cast<int>(std::lround(plot.pixelOf(value))); };
    QTest::mousePress(&plot, Qt::LeftButton, {}, QPoint(pixel(first), y));
    for (const double value : {-4.0, -5.0, -6.0}) {
        QMouseEvent move(QEvent::MouseMove, QPoint(pixel(value), y), plot.mapToGlobal(QPointF(pixel(value), y)),
                         Qt::NoButton, Qt::LeftButton, Qt::NoModifier);
        QApplication::sendEvent(&plot, &move);
        QTest::qWait(150);
    }
    QTest::mouseRelease(&plot, Qt::LeftButton, {}, QPoint(pixel(-6.0), y));
    EXPECT_NEAR(isovalue().requested(), -6.0, 0.2);
    undo().trigger(); // at once: what is on the way is a step
    EXPECT_EQ(isovalue().requested(), first);
    EXPECT_FALSE(undo().isEnabled());
}

TEST_F(UndoTest, AChangeAfterAnUndoTakesTheOthersPlace) {
    openBall();
    letStepEnd();
    isovalue().request(-5.0);
    letStepEnd();
    undo().trigger();
    EXPECT_TRUE(redo().isEnabled());
    trigger("view.box");
    EXPECT_FALSE(redo().isEnabled());
    letStepEnd();
    EXPECT_FALSE(redo().isEnabled());
    EXPECT_TRUE(undo().isEnabled());
}

TEST_F(UndoTest, SlicesPiecesErrorAndReferenceAreStepsWithTheirNames) {
    openBall();
    letStepEnd();
    struct Scene {
        model::SliceOptions slices;
        std::optional<double> reference;
        extract::MergeError error;
        model::HiddenPieces hidden;

        bool operator==(const Scene&) const = default;
    };
    const auto scene = [&] {
        return Scene{window_->slices().options(), isovalue().reference(), session_->detail().error(),
                     session_->surfaces().active()->hiddenPieces};
    };
    std::vector<Scene> scenes{scene()};
    std::vector<std::string> names;
    const auto note = [&] {
        letStepEnd();
        ASSERT_NE(scene(), scenes.back());
        scenes.push_back(scene());
        names.push_back(undo().text().toStdString());
    };
    press(Qt::Key_F7, Qt::NoModifier);
    note();
    press(Qt::Key_Period, Qt::NoModifier);
    note();
    press(Qt::Key_D, Qt::NoModifier);
    note();
    session_->detail().setError({extract::MergeBound::Measure::Distance, 0.25});
    note();
    trigger("pieces.largest");
    note();
    const std::vector<std::string> wanted{"Slices", "Slices", "Reference", "Error", "Pieces"};
    for (std::size_t i = 0; i < wanted.size(); ++i)
        EXPECT_NE(names[i].find(wanted[i]), std::string::npos) << names[i];
    for (std::size_t i = scenes.size() - 1; i-- > 0;) {
        press(Qt::Key_Z, Qt::ControlModifier);
        EXPECT_TRUE(scene() == scenes[i]) << i;
    }
    for (std::size_t i = 1; i < scenes.size(); ++i) {
        press(Qt::Key_Z, Qt::ControlModifier | Qt::ShiftModifier);
        EXPECT_TRUE(scene() == scenes[i]) << i;
    }
    EXPECT_FALSE(redo().isEnabled());
    ASSERT_TRUE(waitUntilSettled());
    EXPECT_EQ(session_->frame()->mergeBound.limit, 0.25);
}

TEST_F(UndoTest, AnotherVolumeBeginsWithoutAHistory) {
    openBall();
    letStepEnd();
    isovalue().request(-5.0);
    letStepEnd();
    EXPECT_TRUE(undo().isEnabled());
    openBall(20);
    letStepEnd();
    EXPECT_FALSE(undo().isEnabled());
    session_->close();
    EXPECT_FALSE(undo().isEnabled());
}

} // namespace
} // namespace isoslider::test
