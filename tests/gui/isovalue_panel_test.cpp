#include <cmath>

#include <QAccessible>
#include <QAction>
#include <QClipboard>
#include <QGuiApplication>
#include <QLabel>
#include <QTest>
#include <QToolTip>
#include <QWheelEvent>

#include <gmock/gmock.h>

#include "tests/gui/float_volume.h"
#include "tests/gui/window_fixture.h"
#include "ui/widgets/isovalue/histogram_plot.h"
#include "ui/widgets/isovalue/isovalue_edit.h"
#include "ui/widgets/isovalue/isovalue_panel.h"
#include "ui/widgets/window/action_registry.h"

namespace isoslider::test {
namespace {

class IsovaluePanelTest : public WindowTest {
protected:
    IsovaluePanelTest() { openBall(); }

    widgets::HistogramPlot& plot() { return window_->isovaluePanel().plot(); }
    widgets::IsovalueEdit& edit() { return window_->isovaluePanel().edit(); }
    model::IsovalueModel& isovalue() { return session_->isovalue(); }
    double range() { return isovalue().max() - isovalue().min(); }
    bool waitUntilDisplayed() {
        return waitUntil([this] { return !isovalue().isLagging(); });
    }
    QPoint onPlot(double value) {
        return {static_cast<int>(std::lround(plot().pixelOf(value))), plot().axisRect()->center().y()};
    }
    void drag(QPoint from, QPoint to, Qt::KeyboardModifiers modifiers = Qt::NoModifier) {
        QTest::mousePress(&plot(), Qt::LeftButton, modifiers, from);
        for (int step = 1; step <= 10; ++step) {
            const QPoint point = from + (to - from) * step / 10;
            QMouseEvent move(QEvent::MouseMove, point, plot().mapToGlobal(QPointF(point)), Qt::NoButton, Qt::LeftButton,
                             modifiers);
            QApplication::sendEvent(&plot(), &move);
            QTest::qWait(2);
        }
        QTest::mouseRelease(&plot(), Qt::LeftButton, modifiers, to);
    }
    void wheel(QWidget& widget, QPointF point, int notches, Qt::KeyboardModifiers modifiers = Qt::NoModifier) {
        QWheelEvent event(point, widget.mapToGlobal(point), {}, QPoint(0, 120 * notches), Qt::NoButton, modifiers,
                          Qt::NoScrollPhase, false);
        QApplication::sendEvent(&widget, &event);
    }
};

TEST_F(IsovaluePanelTest, DraggingTheHandleMovesTheSurface) {
    const auto trianglesBefore = session_->frame()->stats.triangles;
    const double target = isovalue().min() + 0.8 * range();
    drag(onPlot(isovalue().requested()), onPlot(target));
    EXPECT_NEAR(isovalue().requested(), target, 0.01 * range());
    ASSERT_TRUE(waitUntilDisplayed());
    EXPECT_EQ(session_->frame()->isovalue, isovalue().requested());
    EXPECT_NE(session_->frame()->stats.triangles, trianglesBefore);
}

TEST_F(IsovaluePanelTest, AFineStepIsATenthOfAStep) {
    const double before = isovalue().requested();
    plot().setFocus();
    QTest::keyClick(&plot(), Qt::Key_Right, Qt::ShiftModifier);
    EXPECT_EQ(isovalue().stepRule().unit, 0.02) << "about a thousandth of what is in view, a round number";
    EXPECT_GT(isovalue().requested(), before);
    EXPECT_LE(isovalue().requested(), before + 0.002 + 1e-12);
    const double steps = isovalue().requested() / 0.002;
    EXPECT_NEAR(steps, std::round(steps), 1e-9);
}

TEST_F(IsovaluePanelTest, PressingBesideTheHandleBringsItThere) {
    const double target = isovalue().min() + 0.3 * range();
    QTest::mouseClick(&plot(), Qt::LeftButton, {}, onPlot(target));
    EXPECT_NEAR(isovalue().requested(), target, 0.01 * range());
}

TEST_F(IsovaluePanelTest, ShiftMakesTheDragTenTimesFiner) {
    const double before = isovalue().requested();
    const QPoint from = onPlot(before);
    drag(from, from + QPoint(200, 0), Qt::ShiftModifier);
    const double perPixel = plot().visibleRange().size() / plot().axisRect()->width();
    EXPECT_NEAR(isovalue().requested() - before, 20.0 * perPixel, 0.5 * perPixel);
}

TEST_F(IsovaluePanelTest, DraggingBeyondTheEndStopsThere) {
    drag(onPlot(isovalue().requested()), QPoint(plot().width() + 400, plot().axisRect()->center().y()));
    EXPECT_EQ(isovalue().requested(), isovalue().max());
}

TEST_F(IsovaluePanelTest, TypingIsTakenOnEnterAndNotBefore) {
    trigger("isovalue.edit");
    const double before = isovalue().requested();
    QTest::keyClicks(&edit(), QStringLiteral("-7.25"));
    EXPECT_EQ(isovalue().requested(), before);
    QTest::keyClick(&edit(), Qt::Key_Return);
    EXPECT_EQ(isovalue().requested(), -7.25);
    ASSERT_TRUE(waitUntilDisplayed());
    EXPECT_EQ(child<QLabel>("displayedReadout")->text(), QStringLiteral("-7.25"));
}

TEST_F(IsovaluePanelTest, TypingIsTakenWhenTheFocusLeaves) {
    trigger("isovalue.edit");
    QTest::keyClicks(&edit(), QStringLiteral("-6.5"));
    plot().setFocus();
    EXPECT_EQ(isovalue().requested(), -6.5);
}

TEST_F(IsovaluePanelTest, WhatIsNoNumberIsPutBack) {
    const double before = isovalue().requested();
    for (const char* text : {"bone", "nan", "", "1e"}) {
        trigger("isovalue.edit");
        edit().selectAll();
        QTest::keyClick(&edit(), Qt::Key_Delete);
        QTest::keyClicks(&edit(), QLatin1String(text));
        QTest::keyClick(&edit(), Qt::Key_Return);
        EXPECT_EQ(isovalue().requested(), before) << text;
        EXPECT_FALSE(edit().text().isEmpty());
        EXPECT_NE(edit().text(), QLatin1String(text));
    }
}

TEST_F(IsovaluePanelTest, StandardDeviationsAreFromTheMean) {
    const ValueSpread spread = session_->dataset()->values->spread;
    ASSERT_TRUE(spread.isExact);
    ASSERT_GT(spread.deviation, 0.5);
    const auto type = [this](const QString& text) {
        trigger("isovalue.edit");
        QTest::keyClicks(&edit(), text);
        QTest::keyClick(&edit(), Qt::Key_Return);
    };
    type(QStringLiteral("1.5 sigma"));
    EXPECT_DOUBLE_EQ(isovalue().requested(), spread.mean + 1.5 * spread.deviation);
    EXPECT_THAT(edit().toolTip().toStdString(), ::testing::HasSubstr("Now: mean + 1.5 \xCF\x83"));
    trigger("isovalue.edit");
    QTest::keyClicks(&edit(), QStringLiteral("-0,5"));
    edit().insert(QStringLiteral("σ")); // no key of the test library
    QTest::keyClick(&edit(), Qt::Key_Return);
    EXPECT_DOUBLE_EQ(isovalue().requested(), spread.mean - 0.5 * spread.deviation);
    EXPECT_THAT(edit().toolTip().toStdString(), ::testing::HasSubstr("mean \xE2\x88\x92 0.5 \xCF\x83"));
    type(QStringLiteral("1 SD"));
    EXPECT_DOUBLE_EQ(isovalue().requested(), spread.mean + spread.deviation);
    type(QStringLiteral("50 sd"));
    EXPECT_EQ(isovalue().requested(), isovalue().max()) << "as any isovalue beyond the samples";
}

TEST_F(IsovaluePanelTest, OfEqualSamplesThereAreNoStandardDeviations) {
    window_->openFile(qpath(test::writeFloats(folder_, "flat.mha", {4, 4, 4}, [](int, int, int) { return 3.0F; })));
    ASSERT_TRUE(waitUntil([this] { return session_->dataset()->name == "flat.mha"; }));
    trigger("isovalue.edit");
    edit().selectAll();
    QTest::keyClicks(&edit(), QStringLiteral("2 sigma"));
    QTest::keyClick(&edit(), Qt::Key_Return);
    EXPECT_EQ(isovalue().requested(), 3.0);
    EXPECT_EQ(edit().text(), QStringLiteral("3"));
    if (edit().hasFocus()) {
        EXPECT_TRUE(QToolTip::text().contains(QStringLiteral("no standard deviation")))
            << QToolTip::text().toStdString();
    }
    EXPECT_FALSE(edit().toolTip().contains(QStringLiteral("Now")));
}

TEST_F(IsovaluePanelTest, LettersThatNoNumberHasGoToTheWindow) {
    const bool hadBox = window_->actions().action("view.box")->isChecked();
    trigger("isovalue.edit");
    QTest::keyClick(&edit(), Qt::Key_B);
    EXPECT_NE(window_->actions().action("view.box")->isChecked(), hadBox);
    QTest::keyClicks(&edit(), QStringLiteral("-7e0"));
    QTest::keyClick(&edit(), Qt::Key_Return);
    EXPECT_EQ(isovalue().requested(), -7.0);
    QTest::keyClick(&edit(), Qt::Key_B);
    EXPECT_EQ(window_->actions().action("view.box")->isChecked(), hadBox) << "the text is not the user's any more";
}

TEST_F(IsovaluePanelTest, LettersAreTextOnceSomethingWasTyped) {
    const double before = isovalue().requested();
    const bool hadBox = window_->actions().action("view.box")->isChecked();
    trigger("isovalue.edit");
    QTest::keyClicks(&edit(), QStringLiteral("6 metres B"));
    EXPECT_EQ(edit().text(), QStringLiteral("6 metres B"));
    EXPECT_TRUE(session_->surfaces().active()->isVisible);
    EXPECT_EQ(window_->actions().action("view.box")->isChecked(), hadBox);
    QTest::keyClick(&edit(), Qt::Key_Return);
    EXPECT_EQ(isovalue().requested(), before);
    trigger("isovalue.edit");
    QTest::keyClicks(&edit(), QStringLiteral("6"));
    QTest::keyClick(&edit(), Qt::Key_Escape);
    QTest::keyClick(&edit(), Qt::Key_S);
    EXPECT_FALSE(session_->surfaces().active()->isVisible) << "what was typed is gone";
}

TEST_F(IsovaluePanelTest, LettersWithControlAreTheFields) {
    trigger("isovalue.edit");
    QTest::keyClicks(&edit(), QStringLiteral("-5"));
    QTest::keyClick(&edit(), Qt::Key_Return);
    trigger("isovalue.edit");
    QTest::keyClicks(&edit(), QStringLiteral("12"));
    QTest::keyClick(&edit(), Qt::Key_A, Qt::ControlModifier);
    EXPECT_EQ(edit().selectedText(), QStringLiteral("12"));
    QTest::keyClick(&edit(), Qt::Key_C, Qt::ControlModifier);
    EXPECT_EQ(QGuiApplication::clipboard()->text(), QStringLiteral("12"));
    QTest::keyClicks(&edit(), QStringLiteral("77"));
    EXPECT_EQ(edit().text(), QStringLiteral("77"));
    QTest::keyClick(&edit(), Qt::Key_Z, Qt::ControlModifier);
    EXPECT_NE(edit().text(), QStringLiteral("77"));
    EXPECT_EQ(isovalue().requested(), -5.0) << "typing is undone, and no step of the window";
}

TEST_F(IsovaluePanelTest, ANumberOutOfRangeIsClampedAndShownSo) {
    trigger("isovalue.edit");
    QTest::keyClicks(&edit(), QStringLiteral("1e9"));
    QTest::keyClick(&edit(), Qt::Key_Return);
    EXPECT_EQ(isovalue().requested(), isovalue().max());
    EXPECT_NEAR(edit().text().toDouble(), isovalue().max(), 1e-5);
}

TEST_F(IsovaluePanelTest, EscapePutsTheValueBack) {
    trigger("isovalue.edit");
    const QString shown = edit().text();
    QTest::keyClicks(&edit(), QStringLiteral("-3"));
    QTest::keyClick(&edit(), Qt::Key_Escape);
    EXPECT_EQ(edit().text(), shown);
}

TEST_F(IsovaluePanelTest, TheWheelStepsAndControlZooms) {
    const double before = isovalue().requested();
    const QPointF point = onPlot(before);
    wheel(plot(), point, 3);
    EXPECT_NEAR(isovalue().requested(), (std::floor(before / 0.02) + 3.0) * 0.02, 1e-9);
    const double requested = isovalue().requested();
    const double wholeRange = plot().visibleRange().size();
    wheel(plot(), point, 4, Qt::ControlModifier);
    EXPECT_EQ(isovalue().requested(), requested);
    EXPECT_LT(plot().visibleRange().size(), 0.6 * wholeRange);
    doubleClick(plot(), Qt::LeftButton, {}, QPoint(plot().axisRect()->center().x(), plot().axisRect()->bottom() + 8));
    EXPECT_NEAR(plot().visibleRange().size(), wholeRange, 1e-9);
}

TEST_F(IsovaluePanelTest, ANewVolumeOfTheSameRangeIsShownWhole) {
    const auto whole = plot().visibleRange();
    wheel(plot(), onPlot(isovalue().requested()), 6, Qt::ControlModifier);
    ASSERT_LT(plot().visibleRange().size(), 0.5 * whole.size());
    const auto zoomed = plot().visibleRange();
    int news = 0;
    const auto subscription = session_->datasetChanged().observe([&] { ++news; });
    window_->openFile(QString::fromStdString((folder_.path() / "missing.mha").string())); // news of the same volume
    ASSERT_TRUE(waitUntil([&] { return session_->isSettled() && news > 0; }));
    EXPECT_EQ(plot().visibleRange().lower, zoomed.lower);
    const auto generation = session_->datasetGeneration();
    window_->openFile(QString::fromStdString(writeBall(folder_, "same.mha", 24).string()));
    ASSERT_TRUE(waitUntil([&] { return session_->datasetGeneration() != generation && session_->isSettled(); }));
    EXPECT_EQ(plot().visibleRange().lower, whole.lower);
    EXPECT_EQ(plot().visibleRange().upper, whole.upper);
}

TEST_F(IsovaluePanelTest, ADoubleClickShowsTheWholeRangeAndNothingElse) {
    const double whole = plot().visibleRange().size();
    const double before = isovalue().requested();
    wheel(plot(), onPlot(before), 4, Qt::ControlModifier);
    const QPoint beside = onPlot(before) + QPoint(120, 0);
    QTest::mousePress(&plot(), Qt::LeftButton, {}, beside);
    EXPECT_NE(isovalue().requested(), before) << "a press is answered at once";
    QTest::mouseRelease(&plot(), Qt::LeftButton, {}, beside);
    doubleClick(plot(), Qt::LeftButton, {}, beside);
    QMouseEvent move(QEvent::MouseMove, beside + QPoint(3, 0), plot().mapToGlobal(QPointF(beside + QPoint(3, 0))),
                     Qt::NoButton, Qt::LeftButton, Qt::NoModifier);
    QApplication::sendEvent(&plot(), &move);
    QTest::mouseRelease(&plot(), Qt::LeftButton, {}, beside);
    EXPECT_EQ(isovalue().requested(), before);
    EXPECT_NEAR(plot().visibleRange().size(), whole, 1e-9);
    ASSERT_TRUE(waitUntilDisplayed());
    EXPECT_EQ(session_->frame()->isovalue, before);
}

TEST_F(IsovaluePanelTest, TheHandleTakenBesideItsMiddleDoesNotJump) {
    const double before = isovalue().requested();
    const QPoint handle = onPlot(before);
    const double perPixel = plot().visibleRange().size() / plot().axisRect()->width();
    for (const int offset : {-5, -2, 3, 5}) {
        isovalue().request(before);
        QTest::mousePress(&plot(), Qt::LeftButton, {}, handle + QPoint(offset, 0));
        EXPECT_EQ(isovalue().requested(), before) << offset;
        QMouseEvent move(QEvent::MouseMove, handle + QPoint(offset + 17, 0),
                         plot().mapToGlobal(QPointF(handle + QPoint(offset + 17, 0))), Qt::NoButton, Qt::LeftButton,
                         Qt::NoModifier);
        QApplication::sendEvent(&plot(), &move);
        QTest::mouseRelease(&plot(), Qt::LeftButton, {}, handle + QPoint(offset + 17, 0));
        EXPECT_NEAR(isovalue().requested() - before, 17.0 * perPixel, 0.5 * perPixel) << offset;
    }
}

TEST_F(IsovaluePanelTest, KeysStepPageAndJump) {
    plot().setFocus();
    isovalue().request(-8.0);
    const auto expectStep = [&](Qt::Key key, Qt::KeyboardModifiers modifiers, double difference) {
        const double before = isovalue().requested();
        QTest::keyClick(&plot(), key, modifiers);
        EXPECT_NEAR(isovalue().requested() - before, difference, 1e-9) << key;
    };
    expectStep(Qt::Key_Right, Qt::NoModifier, 0.02);
    expectStep(Qt::Key_Left, Qt::NoModifier, -0.02);
    expectStep(Qt::Key_Up, Qt::ShiftModifier, 0.002);
    expectStep(Qt::Key_Down, Qt::ShiftModifier, -0.002);
    expectStep(Qt::Key_PageUp, Qt::NoModifier, 0.2);
    expectStep(Qt::Key_PageDown, Qt::ControlModifier, -2.0);
    QTest::keyClick(&plot(), Qt::Key_Home);
    EXPECT_EQ(isovalue().requested(), isovalue().min());
    QTest::keyClick(&plot(), Qt::Key_End);
    EXPECT_EQ(isovalue().requested(), isovalue().max());
    EXPECT_TRUE(waitUntilDisplayed());
}

TEST_F(IsovaluePanelTest, PlayMovesTheSurfaceAndPauseStopsIt) {
    const double before = isovalue().requested();
    trigger("isovalue.play");
    EXPECT_TRUE(waitUntil([&] { return isovalue().displayed() > before + 0.002 * range(); }));
    trigger("isovalue.play");
    ASSERT_TRUE(waitUntilDisplayed());
    const double after = isovalue().requested();
    QTest::qWait(80);
    EXPECT_EQ(isovalue().requested(), after);
}

TEST_F(IsovaluePanelTest, WhyATextIsNoNumberIsStatedUntilSomethingElseIsTyped) {
    const auto type = [this](const char* text, Qt::Key last) {
        trigger("isovalue.edit");
        edit().selectAll();
        QTest::keyClicks(&edit(), QLatin1String(text));
        QTest::keyClick(&edit(), last);
    };
    const auto isStated = [] {
        return QToolTip::isVisible() && QToolTip::text().contains(QStringLiteral("not a number"));
    };
    const auto waitUntilGone = [&] {
        return waitUntil([&] { return !isStated(); }, std::chrono::milliseconds(900)); // it fades for a moment
    };
    type("12..5", Qt::Key_Return);
    EXPECT_TRUE(isStated());
    QTest::keyClicks(&edit(), QStringLiteral("-7"));
    EXPECT_TRUE(waitUntilGone());
    QTest::keyClick(&edit(), Qt::Key_Return);
    EXPECT_EQ(isovalue().requested(), -7.0);
    EXPECT_FALSE(isStated());
    type("12..5", Qt::Key_Return);
    EXPECT_TRUE(isStated());
    isovalue().request(-6.0); // by the handle
    EXPECT_TRUE(waitUntilGone());
    type("12..5", Qt::Key_Return);
    EXPECT_TRUE(isStated());
    QTest::keyClick(&edit(), Qt::Key_Tab);
    EXPECT_TRUE(waitUntilGone());
    trigger("isovalue.edit");
    QTest::keyClicks(&edit(), QStringLiteral("1e"));
    edit().clearFocus(); // left with it, and nothing else has the keyboard
    EXPECT_FALSE(isStated());
}

TEST_F(IsovaluePanelTest, NothingIsPlayedOfOneValue) {
    window_->openFile(qpath(writeFloats(folder_, "even.mha", {8, 8, 8}, [](int, int, int) { return 3.0; })));
    ASSERT_TRUE(waitUntil([this] { return session_->isSettled() && isovalue().max() == 3.0; }));
    QAction* play = window_->actions().action("isovalue.play");
    EXPECT_FALSE(play->isEnabled());
    EXPECT_TRUE(play->toolTip().contains(QStringLiteral("one value"))) << play->toolTip().toStdString();
    QTest::keyClick(window_.get(), Qt::Key_P);
    EXPECT_FALSE(play->isChecked());
    keepPicture(*window_, "play_one_value");
    openBall();
    EXPECT_TRUE(play->isEnabled());
    EXPECT_FALSE(play->toolTip().contains(QStringLiteral("one value")));
}

// Should the range become one value while it is played, as where a preview gives way to the volume.
TEST_F(IsovaluePanelTest, PlayEndsWithTheVolume) {
    trigger("isovalue.play");
    QAction* play = window_->actions().action("isovalue.play");
    ASSERT_TRUE(play->isChecked());
    window_->openFile(qpath(writeFloats(folder_, "even.mha", {8, 8, 8}, [](int, int, int) { return 3.0; })));
    ASSERT_TRUE(waitUntil([this] { return session_->isSettled() && isovalue().max() == 3.0; }));
    EXPECT_FALSE(play->isChecked());
    EXPECT_EQ(play->text(), QStringLiteral("&Play"));
}

TEST_F(IsovaluePanelTest, TheHandleHasAnAccessibleNameAndValue) {
    isovalue().request(-7.5);
    EXPECT_EQ(plot().accessibleName(), QStringLiteral("Isovalue"));
    EXPECT_EQ(plot().accessibleDescription(), QStringLiteral("-7.5"));
    auto* interface = QAccessible::queryAccessibleInterface(&plot());
    ASSERT_NE(interface, nullptr);
    EXPECT_EQ(interface->role(), QAccessible::Slider);
    auto* value = interface->valueInterface();
    ASSERT_NE(value, nullptr);
    EXPECT_EQ(value->currentValue().toDouble(), -7.5);
    EXPECT_EQ(value->maximumValue().toDouble(), isovalue().max());
    value->setCurrentValue(-6.25);
    EXPECT_EQ(isovalue().requested(), -6.25);
}

TEST_F(IsovaluePanelTest, LogAndLinearCountsAreRemembered) {
    trigger("isovalue.logCounts");
    EXPECT_FALSE(settings_->boolean("histogram/logCounts"));
    makeWindow();
    EXPECT_FALSE(window_->actions().action("isovalue.logCounts")->isChecked());
}

} // namespace
} // namespace isoslider::test
