// Events of the topology in the window: marks, keys, snapping, the panel, curves and the view.
#include <cmath>

#include <QAction>
#include <QHelpEvent>
#include <QStatusBar>
#include <QTest>
#include <QToolTip>

#include "tests/gui/window_fixture.h"
#include "ui/widgets/common/small_widgets.h"
#include "ui/widgets/isovalue/histogram_plot.h"
#include "ui/widgets/isovalue/isovalue_edit.h"
#include "ui/widgets/isovalue/isovalue_panel.h"
#include "ui/widgets/window/action_registry.h"

namespace isoslider::test {
namespace {

/// Three cones: the surface at 1.5 is three pieces; below, two of them join at 1 and the third at -1.
std::filesystem::path writeCones(const TemporaryFolder& folder) {
    constexpr int kPoints = 32;
    struct Cone {
        float x, y, z, height;
    };
    constexpr std::array<Cone, 3> kCones{{{8, 10, 15, 6}, {17, 10, 15, 4}, {17, 20, 15, 3}}};
    std::string bytes = "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n"
                        "DimSize = 32 32 32\nElementSpacing = 1 1 1\nElementType = MET_FLOAT\n"
                        "ElementDataFile = LOCAL\n";
    for (int z = 0; z < kPoints; ++z)
        for (int y = 0; y < kPoints; ++y)
            for (int x = 0; x < kPoints; ++x) {
                float value = -30.0f;
                for (const Cone& cone : kCones)
                    value = std::max(value, cone.height - std::hypot(static_cast<float>(x) - cone.x,
                                                                     static_cast<float>(y) - cone.y,
                                                                     static_cast<float>(z) - cone.z));
                bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
            }
    return folder.write("cones.mha", bytes);
}

class TopologyTest : public WindowTest {
protected:
    TopologyTest() { openCones(); }

    void openCones() {
        window_->openFile(QString::fromStdString(writeCones(folder_).string()));
        ASSERT_TRUE(waitUntil([this] { return session_->frame() != nullptr; }));
        ASSERT_TRUE(waitUntilSettled());
        ASSERT_EQ(topology().state(), model::TopologyState::Ready);
        ASSERT_GE(topology().shown().size(), 4u);
        QTest::qWait(30);
    }
    model::TopologyModel& topology() { return session_->topology(); }
    model::IsovalueModel& isovalue() { return session_->isovalue(); }
    double range() { return isovalue().max() - isovalue().min(); }
    widgets::HistogramPlot& plot() { return window_->isovaluePanel().plot(); }

    /// Shown events that have a mark and lie apart from any other, from the handle and from the ends.
    std::vector<std::size_t> loneEvents() {
        std::vector<std::size_t> lone;
        for (const std::size_t event : topology().shown()) {
            const auto place = plot().eventMarks().placeOf(event);
            bool isLone = place && topology().events()[event].isovalue > isovalue().min() + 0.1 * range() &&
                          topology().events()[event].isovalue < isovalue().max() - 0.1 * range() &&
                          std::abs(place->x() - plot().pixelOf(isovalue().requested())) > 20.0;
            for (const std::size_t other : topology().shown())
                isLone = isLone && (other == event ||
                                    std::abs(plot().pixelOf(topology().events()[other].isovalue) - place->x()) > 14.0);
            if (isLone)
                lone.push_back(event);
        }
        return lone;
    }
    QPoint markOf(std::size_t event) {
        const auto place = plot().eventMarks().placeOf(event);
        EXPECT_TRUE(place);
        return place.value_or(QPointF()).toPoint();
    }
    void dragTo(QPoint point, Qt::KeyboardModifiers modifiers = Qt::NoModifier) {
        QMouseEvent move(QEvent::MouseMove, point, plot().mapToGlobal(QPointF(point)), Qt::NoButton, Qt::LeftButton,
                         modifiers);
        QApplication::sendEvent(&plot(), &move);
    }
    QPoint handle() {
        return {static_cast<int>(std::lround(plot().pixelOf(isovalue().requested()))),
                plot().axisRect()->top() + plot().axisRect()->height() / 4};
    }
};

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

} // namespace
} // namespace isoslider::test
