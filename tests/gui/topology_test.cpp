// Events of the topology in the window: marks, keys, snapping, the status bar and the view.
#include <cmath>

#include <QHelpEvent>
#include <QStatusBar>
#include <QTest>
#include <QToolTip>

#include "tests/gui/topology_fixture.h"
#include "ui/widgets/common/small_widgets.h"
#include "ui/widgets/isovalue/histogram_plot.h"
#include "ui/widgets/isovalue/isovalue_panel.h"
#include "ui/widgets/viewport/event_marker.h"
#include "ui/widgets/viewport/viewport_host.h"
#include "ui/widgets/viewport/viewport_widget.h"
#include "ui/widgets/window/action_registry.h"
#include "ui/widgets/window/settings_store.h"

namespace isoslider::test {
namespace {

TEST_F(TopologyTest, EventsAreMarkedOnTheAxis) {
    EXPECT_GE(plot().eventMarks().drawnCount(), 3u);
    EXPECT_LE(plot().eventMarks().drawnCount(), topology().shown().size());
    keepPicture(*window_, "topology_marks");
    topology().setLeastPersistence(1e9);
    EXPECT_EQ(plot().eventMarks().drawnCount(), 0u);
    session_->close();
    EXPECT_EQ(plot().eventMarks().drawnCount(), 0u);
}

TEST_F(TopologyTest, AMorePersistentMarkIsHigher) {
    std::optional<std::size_t> weak, strong;
    for (const std::size_t event : topology().shown()) {
        if (!plot().eventMarks().placeOf(event))
            continue;
        const auto persistence = [&](std::size_t of) { return topology().events()[of].persistence; };
        if (!weak || persistence(event) < persistence(*weak))
            weak = event;
        if (!strong || persistence(event) > persistence(*strong))
            strong = event;
    }
    ASSERT_TRUE(weak && strong && weak != strong);
    EXPECT_LT(markOf(*strong).y(), markOf(*weak).y());
}

TEST_F(TopologyTest, ClickingAMarkGoesJustPastItsEvent) {
    const auto lone = loneEvents();
    ASSERT_FALSE(lone.empty());
    const std::size_t event = lone.front();
    QTest::mouseClick(&plot(), Qt::LeftButton, {}, markOf(event));
    EXPECT_EQ(isovalue().requested(), topology().justPast(event));
    EXPECT_EQ(topology().chosen(), event);
    ASSERT_TRUE(waitUntil([this] { return !isovalue().isLagging(); }));
    EXPECT_EQ(topology().countsAt(isovalue().displayed()), topology().events()[event].above);
    keepPicture(*window_, "topology_chosen");
    // Above the marks the plot is the slider it always was.
    QTest::mouseClick(&plot(), Qt::LeftButton, {}, QPoint(markOf(lone.back()).x() + 3, handle().y()));
    EXPECT_NE(isovalue().requested(), topology().justPast(lone.back()));
    EXPECT_EQ(topology().chosen(), event);
}

TEST_F(TopologyTest, AMarkExplainsItselfUnderThePointer) {
    const auto lone = loneEvents();
    ASSERT_FALSE(lone.empty());
    const auto tipAt = [this](QPoint point) {
        QHelpEvent help(QEvent::ToolTip, point, plot().mapToGlobal(point));
        QApplication::sendEvent(&plot(), &help);
        return QToolTip::text();
    };
    const QString tip = tipAt(markOf(lone.front()));
    EXPECT_EQ(tip.toStdString(), model::describe(topology().events()[lone.front()]));
    EXPECT_TRUE(tip.contains(QStringLiteral("Isovalue"))) << tip.toStdString();
    EXPECT_TRUE(tip.contains(QStringLiteral("After: "))) << tip.toStdString();
    QMouseEvent move(QEvent::MouseMove, markOf(lone.front()), plot().mapToGlobal(QPointF(markOf(lone.front()))),
                     Qt::NoButton, Qt::NoButton, Qt::NoModifier);
    QApplication::sendEvent(&plot(), &move);
    EXPECT_EQ(plot().cursor().shape(), Qt::PointingHandCursor);
    QToolTip::hideText();
}

TEST_F(TopologyTest, KeysGoFromEventToEvent) {
    plot().setFocus();
    QTest::keyClick(&plot(), Qt::Key_Home);
    EXPECT_EQ(isovalue().requested(), isovalue().min());
    std::vector<double> stops;
    for (std::size_t i = 0; i < topology().shown().size() + 2; ++i) {
        const auto next = topology().next(isovalue().requested());
        QTest::keyClick(window_.get(), Qt::Key_BracketRight);
        if (!next || topology().justPast(*next) > isovalue().max())
            break;
        EXPECT_EQ(isovalue().requested(), topology().justPast(*next));
        EXPECT_EQ(topology().chosen(), next);
        stops.push_back(isovalue().requested());
    }
    ASSERT_GE(stops.size(), 3u);
    isovalue().request(isovalue().max());
    for (auto stop = stops.rbegin(); stop != stops.rend(); ++stop) {
        QTest::keyClick(window_.get(), Qt::Key_BracketLeft);
        EXPECT_EQ(isovalue().requested(), *stop);
    }
    QTest::keyClick(window_.get(), Qt::Key_Escape);
    EXPECT_FALSE(topology().chosen());
    session_->close();
    EXPECT_FALSE(window_->actions().action("isovalue.nextEvent")->isEnabled());
}

TEST_F(TopologyTest, EscapeInTheFieldPutsTheValueBackFirst) {
    trigger("isovalue.nextEvent");
    ASSERT_TRUE(topology().chosen());
    trigger("isovalue.edit");
    auto& edit = window_->isovaluePanel().edit();
    const QString shown = edit.text();
    QTest::keyClicks(&edit, QStringLiteral("-3["));
    QTest::keyClick(&edit, Qt::Key_Escape);
    EXPECT_EQ(edit.text(), shown);
    EXPECT_TRUE(topology().chosen());
}

TEST_F(TopologyTest, ADragSnapsToEventsWhereThatIsWanted) {
    const auto lone = loneEvents();
    ASSERT_FALSE(lone.empty());
    const double past = topology().justPast(lone.front());
    const auto dragNear = [&](int offset, Qt::KeyboardModifiers modifiers = Qt::NoModifier) {
        QTest::mousePress(&plot(), Qt::LeftButton, {}, handle());
        const QPoint to(static_cast<int>(std::lround(plot().pixelOf(past))) + offset, handle().y());
        dragTo(to, modifiers);
        const double value = isovalue().requested();
        dragTo(to + QPoint(offset > 0 ? 25 : -25, 0));
        const double left = isovalue().requested();
        QTest::mouseRelease(&plot(), Qt::LeftButton, {}, to);
        EXPECT_NE(left, past) << "it can be left again";
        return value;
    };
    EXPECT_NE(dragNear(4), past);
    trigger("isovalue.snap");
    EXPECT_TRUE(settings_->boolean("isovalue/snapsToEvents"));
    for (const int offset : {-4, 0, 4})
        EXPECT_EQ(dragNear(offset), past) << offset;
    EXPECT_NE(dragNear(9), past);
    QTest::mouseClick(&plot(), Qt::LeftButton, {},
                      QPoint(static_cast<int>(std::lround(plot().pixelOf(past))) + 4, handle().y()));
    EXPECT_EQ(isovalue().requested(), past) << "a press is the beginning of a drag";
    trigger("isovalue.snap");
    EXPECT_NE(dragNear(4), past);
}

TEST_F(TopologyTest, CountsThatChangeDoNotStandOnATipInTheStatusBar) {
    auto* counts = child<widgets::ElidedLabel>("topologyCounts");
    window_->statusBar()->showMessage(QStringLiteral("Animate the isovalue"));
    isovalue().request(1.5);
    ASSERT_TRUE(waitUntil([this] { return !isovalue().isLagging(); }));
    EXPECT_FALSE(counts->isVisible());
    window_->statusBar()->clearMessage();
    EXPECT_TRUE(counts->isVisible());
    EXPECT_TRUE(counts->text().startsWith(QStringLiteral("3 pieces")));
}

TEST_F(TopologyTest, TheStatusBarCountsWhatIsDisplayed) {
    auto* counts = child<widgets::ElidedLabel>("topologyCounts");
    ASSERT_TRUE(counts->isVisible());
    const auto textAt = [&](double value) {
        isovalue().request(value);
        EXPECT_TRUE(waitUntil([this] { return !isovalue().isLagging(); }));
        return counts->text();
    };
    EXPECT_EQ(textAt(1.5), QStringLiteral("3 pieces · 0 tunnels · 0 voids · 0 boundary loops"));
    EXPECT_EQ(textAt(5.0), QStringLiteral("1 piece · 0 tunnels · 0 voids · 0 boundary loops"));
    EXPECT_TRUE(counts->toolTip().isEmpty());
    window_->resize(700, 600);
    ASSERT_TRUE(waitUntil([&] { return counts->width() <= 700; }));
    EXPECT_FALSE(counts->text().contains(QChar(0x2026))) << "there is room enough";
    const int widthBefore = window_->width();
    window_->resize(320, 600);
    ASSERT_TRUE(waitUntil([&] { return window_->width() < widthBefore; }));
    QTest::qWait(30);
    EXPECT_LE(window_->width(), 360) << "the bar does not hold the window open";
    EXPECT_TRUE(counts->text().endsWith(QChar(0x2026)) || counts->toolTip().isEmpty());
    window_->resize(1000, 300);
    ASSERT_TRUE(waitUntil([this] { return !window_->statusBar()->isVisible(); }));
    window_->resize(1400, 900);
    ASSERT_TRUE(waitUntil([this] { return window_->statusBar()->isVisible(); }));
    session_->close();
    EXPECT_FALSE(window_->statusBar()->isVisible());
    EXPECT_FALSE(counts->isVisibleTo(window_->statusBar()));
}

/// Pixels in the colour of what is pointed out.
int cyanIn(widgets::ViewportWidget& viewport) {
    const QImage image = viewport.grabFramebuffer().convertToFormat(QImage::Format_RGB32);
    int count = 0;
    for (int y = 0; y < image.height(); ++y)
        for (int x = 0; x < image.width(); ++x) {
            const QRgb pixel = image.pixel(x, y);
            count += qBlue(pixel) > 100 && qGreen(pixel) > 80 && qBlue(pixel) > 2 * qRed(pixel);
        }
    return count;
}

// How strong all of it is: falls as it fades, where the number of pixels may not.
int cyanStrengthIn(widgets::ViewportWidget& viewport) {
    const QImage image = viewport.grabFramebuffer().convertToFormat(QImage::Format_RGB32);
    int sum = 0;
    for (int y = 0; y < image.height(); ++y)
        for (int x = 0; x < image.width(); ++x) {
            const QRgb pixel = image.pixel(x, y);
            if (qBlue(pixel) > 100 && qGreen(pixel) > 80)
                sum += std::max(0, qBlue(pixel) - 2 * qRed(pixel));
        }
    return sum;
}

TEST_F(TopologyTest, WhatASlidePassesIsPointedOutForAMoment) {
    auto* viewport = window_->viewportHost().viewport();
    if (viewport == nullptr)
        GTEST_SKIP() << "no OpenGL 3.3 here";
    trigger("view.reset"); // all events are in view
    const auto cyan = [viewport] { return cyanIn(*viewport); };
    const auto slideTo = [this](double value) {
        isovalue().request(value);
        return waitUntil([this] { return !isovalue().isLagging(); });
    };
    ASSERT_TRUE(slideTo(-8.3)); // the next event has a surface around it
    ASSERT_TRUE(waitUntil([&] { return cyan() == 0; }));
    const auto next = *topology().next(-8.3);
    const double before = topology().events()[next].isovalue;
    ASSERT_TRUE(slideTo(std::lerp(-8.3, before, 0.5)));
    EXPECT_EQ(cyan(), 0) << "nothing was passed";
    ASSERT_TRUE(slideTo(before + 1e-3 * range()));
    EXPECT_GT(cyan(), 50) << "upwards";
    EXPECT_FALSE(topology().chosen());
    const int clear = cyanStrengthIn(*viewport);
    EXPECT_TRUE(waitUntil(
        [&] {
            const int now = cyanStrengthIn(*viewport);
            return now > 0 && now < 3 * clear / 4;
        },
        std::chrono::seconds(8)))
        << "it fades";
    ASSERT_TRUE(waitUntil([&] { return cyan() == 0; }, std::chrono::seconds(8)));
    ASSERT_TRUE(slideTo(-8.3));
    EXPECT_GT(cyan(), 50) << "and downwards";
    topology().choose(next);
    QTest::qWait(100);
    ASSERT_TRUE(slideTo(before + 1e-3 * range()));
    ASSERT_TRUE(slideTo(-8.3));
    QTest::qWait(1700);
    EXPECT_TRUE(topology().chosen()) << "the chosen one has its own mark";
    EXPECT_GT(cyan(), 0);
    QTest::keyClick(window_.get(), Qt::Key_Escape);
    EXPECT_EQ(cyan(), 0);
    trigger("isovalue.markPassed");
    EXPECT_FALSE(settings_->boolean("isovalue/marksPassedEvents"));
    ASSERT_TRUE(slideTo(before + 1e-3 * range()));
    EXPECT_EQ(cyan(), 0);
}

TEST_F(TopologyTest, AnEventThatIsJumpedToIsNotHiddenByWhatLiesBetween) {
    auto* viewport = window_->viewportHost().viewport();
    if (viewport == nullptr)
        GTEST_SKIP() << "no OpenGL 3.3 here";
    isovalue().request(isovalue().min());
    ASSERT_TRUE(waitUntil([&] { return !isovalue().isLagging() && cyanIn(*viewport) == 0; }));
    const auto shown = topology().shown();
    ASSERT_GT(shown.size(), 1u);
    for (int step = 0; step < 2; ++step) {
        trigger("isovalue.nextEvent");
        ASSERT_TRUE(waitUntil([this] { return !isovalue().isLagging(); }));
    }
    const auto chosen = topology().chosen();
    ASSERT_TRUE(chosen);
    isovalue().request(isovalue().min());
    ASSERT_TRUE(waitUntil([this] { return !isovalue().isLagging(); }));
    QTest::qWait(1700); // what was passed on the way is not pointed out any more
    const auto* marker = viewport->findChild<widgets::EventMarker*>();
    ASSERT_NE(marker, nullptr);
    topology().choose(chosen);
    const auto place = marker->pointedOut();
    ASSERT_TRUE(place);
    isovalue().request(topology().justPast(*chosen));
    ASSERT_TRUE(waitUntil([this] { return !isovalue().isLagging(); }));
    EXPECT_EQ(marker->pointedOut(), place) << "the chosen event";
}

TEST_F(TopologyTest, TheChosenEventIsPointedOutInTheView) {
    auto* viewport = window_->viewportHost().viewport();
    if (viewport == nullptr)
        GTEST_SKIP() << "no OpenGL 3.3 here";
    trigger("view.reset"); // all events are in view
    const auto cyan = [viewport] { return cyanIn(*viewport); };
    isovalue().request(-8.3); // the next event has a surface around it
    ASSERT_TRUE(waitUntil([&] { return !isovalue().isLagging() && cyan() == 0; }));
    trigger("isovalue.nextEvent");
    ASSERT_TRUE(waitUntil([this] { return !isovalue().isLagging(); }));
    const int clear = cyan();
    EXPECT_GT(clear, 50);
    EXPECT_TRUE(waitUntil([&] { return cyan() < clear / 4; }, std::chrono::seconds(8))) << "it fades";
    trigger("isovalue.nextEvent");
    ASSERT_TRUE(waitUntil([this] { return !isovalue().isLagging(); }));
    EXPECT_GT(cyan(), 50) << "another one is clear again";
    QTest::keyClick(window_.get(), Qt::Key_Escape);
    const QImage plain = viewport->grabFramebuffer();
    EXPECT_EQ(cyan(), 0);
    QTest::qWait(150);
    EXPECT_EQ(viewport->grabFramebuffer(), plain) << "and stays away";
    topology().choose(topology().shown().front());
    EXPECT_GT(cyan(), 50);
    session_->close();
    EXPECT_EQ(cyan(), 0);
}

} // namespace
} // namespace isoslider::test
