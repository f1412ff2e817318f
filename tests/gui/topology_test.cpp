// Events of the topology in the window: marks, keys, snapping, the panel, curves and the view.
#include <cmath>

#include <QAbstractItemModelTester>
#include <QAction>
#include <QClipboard>
#include <QComboBox>
#include <QDockWidget>
#include <QGuiApplication>
#include <QHeaderView>
#include <QHelpEvent>
#include <QLabel>
#include <QMenu>
#include <QProgressBar>
#include <QScrollBar>
#include <QSlider>
#include <QSortFilterProxyModel>
#include <QStatusBar>
#include <QTabWidget>
#include <QTableView>
#include <QTest>
#include <QTimer>
#include <QToolButton>
#include <QToolTip>

#include "core/topology/topology_curve.h"
#include "tests/gui/cones.h"
#include "tests/gui/window_fixture.h"
#include "ui/model/isovalue/number_text.h"
#include "ui/widgets/common/small_widgets.h"
#include "ui/widgets/isovalue/curve_overlay.h"
#include "ui/widgets/isovalue/histogram_plot.h"
#include "ui/widgets/isovalue/isovalue_edit.h"
#include "ui/widgets/isovalue/isovalue_panel.h"
#include "ui/widgets/panels/topology_table.h"
#include "ui/widgets/viewport/event_marker.h"
#include "ui/widgets/viewport/viewport_host.h"
#include "ui/widgets/viewport/viewport_widget.h"
#include "ui/widgets/window/action_registry.h"
#include "ui/widgets/window/settings_store.h"

namespace isoslider::test {
namespace {

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

/// A summary of a volume that nothing happens in; its area falls, its volume is 0.
class QuietSummary final : public topology::TopologySummary {
public:
    QuietSummary() {
        curves_.isovalues = {-30.0, 10.0};
        curves_.measures = {{40.0, 0.0, 1e6, 1.0}, {0.0, 0.0, 1.0, 1.0}};
    }
    std::uint64_t eventCount() const override { return 0; }
    Result<topology::SurfaceCounts> at(double) const override { return topology::SurfaceCounts{}; }
    Status visitEvents(const std::function<bool(const topology::TopologyEvent&)>&) const override { return {}; }
    bool areCountsExact() const override { return true; }
    const topology::MeasureCurves& curves() const override { return curves_; }

private:
    topology::MeasureCurves curves_;
};

class TopologyPanelTest : public TopologyTest {
protected:
    TopologyPanelTest() {
        child<QDockWidget>("topologyDock")->raise();
        table_ = child<QTableView>("topologyTable");
        EXPECT_TRUE(waitUntil([this] { return table_->isVisible(); }));
    }
    QString textAt(int row, int column) { return table_->model()->index(row, column).data().toString(); }
    int rows() { return table_->model()->rowCount(); }
    void click(int row) {
        const QModelIndex index = table_->model()->index(row, widgets::TopologyTable::What);
        table_->scrollTo(index);
        QTest::mouseClick(table_->viewport(), Qt::LeftButton, {}, table_->visualRect(index).center());
    }
    std::string stateText() {
        auto* state = child<QLabel>("topologyState");
        EXPECT_TRUE(state->isVisible());
        EXPECT_FALSE(table_->isVisible());
        return state->text().toStdString();
    }

    QTableView* table_ = nullptr;
};

TEST_F(TopologyPanelTest, ListsTheShownEvents) {
    QAbstractItemModelTester tester(table_->model(), QAbstractItemModelTester::FailureReportingMode::Warning);
    ASSERT_EQ(rows(), static_cast<int>(topology().shown().size()));
    EXPECT_EQ(child<widgets::ElidedLabel>("topologyCount")->fullText().toStdString(),
              std::to_string(rows()) + " of " + std::to_string(topology().eventCount()) + " events");
    const auto& first = topology().events()[topology().shown().front()];
    EXPECT_EQ(textAt(0, widgets::TopologyTable::Isovalue).toDouble(), std::stod(model::valueText(first.isovalue, 7)));
    EXPECT_EQ(textAt(0, widgets::TopologyTable::What).toStdString(), model::wordsOf(first));
    topology().setLeastPersistence(0.0);
    EXPECT_EQ(rows(), static_cast<int>(topology().events().size()));
    keepPicture(*window_, "topology_panel");
}

TEST_F(TopologyPanelTest, SortsByEachColumn) {
    topology().setLeastPersistence(0.0);
    for (int column = 0; column < widgets::TopologyTable::kColumns; ++column) {
        auto* header = table_->horizontalHeader();
        table_->horizontalScrollBar()->setValue(header->sectionPosition(column));
        const auto clickHeader = [&] {
            QTest::mouseClick(header->viewport(), Qt::LeftButton, {},
                              QPoint(header->sectionViewportPosition(column) + header->sectionSize(column) / 2,
                                     header->height() / 2));
        };
        const auto isSorted = [&](bool isAscending) {
            const auto* sorting = qobject_cast<QSortFilterProxyModel*>(table_->model());
            const auto* source = qobject_cast<widgets::TopologyTable*>(sorting->sourceModel());
            for (int row = 0; row + 1 < rows(); ++row) {
                const double a = source->sortKey(sorting->mapToSource(sorting->index(row, 0)).row(), column);
                const double b = source->sortKey(sorting->mapToSource(sorting->index(row + 1, 0)).row(), column);
                if (isAscending ? a > b : a < b)
                    return false;
            }
            return true;
        };
        clickHeader();
        const bool isAscending = header->sortIndicatorOrder() == Qt::AscendingOrder;
        EXPECT_EQ(header->sortIndicatorSection(), column);
        EXPECT_TRUE(isSorted(isAscending)) << column;
        clickHeader();
        EXPECT_TRUE(isSorted(!isAscending)) << column;
    }
}

TEST_F(TopologyPanelTest, FiltersByKindAndPersistence) {
    const int all = rows();
    auto* filter = child<QComboBox>("topologyFilter");
    filter->setFocus();
    QTest::keyClick(filter, Qt::Key_Down);
    EXPECT_EQ(topology().eventFilter(), model::EventFilter::PiecesCome);
    EXPECT_LT(rows(), all);
    EXPECT_EQ(rows(), static_cast<int>(topology().shown().size()));
    QTest::keyClick(filter, Qt::Key_End);
    EXPECT_EQ(topology().eventFilter(), model::EventFilter::Loops);
    QTest::keyClick(filter, Qt::Key_Home);
    EXPECT_EQ(rows(), all);
    auto* slider = child<QSlider>("topologyPersistence");
    EXPECT_NEAR(topology().persistenceAt(static_cast<double>(slider->value()) / slider->maximum()),
                topology().leastPersistence(), 0.02 * topology().leastPersistence());
    slider->setFocus();
    QTest::keyClick(slider, Qt::Key_Home);
    EXPECT_EQ(topology().leastPersistence(), 0.0);
    EXPECT_EQ(rows(), static_cast<int>(topology().events().size()));
    QTest::keyClick(slider, Qt::Key_End);
    EXPECT_EQ(topology().leastPersistence(), topology().greatestPersistence());
    EXPECT_GE(rows(), 1);
    topology().setLeastPersistence(1e9);
    EXPECT_EQ(rows(), 0);
    EXPECT_TRUE(child<widgets::ElidedLabel>("topologyCount")->fullText().contains(QStringLiteral("none passes")));
}

TEST_F(TopologyPanelTest, AClickOnARowMovesTheSurfaceAndTheCamera) {
    auto* viewport = window_->viewportHost().viewport();
    for (const int row : {rows() / 2, 1}) {
        const std::size_t event = topology().shown()[static_cast<std::size_t>(row)];
        click(row);
        EXPECT_EQ(isovalue().requested(), topology().justPast(event));
        EXPECT_EQ(topology().chosen(), event);
        if (viewport == nullptr)
            continue;
        const auto& at = topology().events()[event].position;
        const glm::dvec3 place = glm::dvec3(at[0], at[1], at[2]) - 15.5;
        EXPECT_TRUE(waitUntil([&] { return glm::length(viewport->camera().target() - place) < 1e-3; },
                              std::chrono::seconds(5)));
        EXPECT_LT(viewport->camera().distance(), viewport->camera().sceneRadius());
    }
    // A camera that the user moves meanwhile stays where the user wants it.
    if (viewport != nullptr) {
        click(rows() / 2);
        viewport->changeCamera([](model::Camera& camera) { camera.fit(); });
        QTest::qWait(400);
        EXPECT_EQ(viewport->camera().target(), glm::dvec3(0.0));
    }
}

TEST_F(TopologyPanelTest, EnterPicksTheRowAndTheChosenRowIsSelected) {
    table_->setFocus();
    table_->setCurrentIndex(table_->model()->index(1, 0));
    QTest::keyClick(table_, Qt::Key_Down);
    EXPECT_FALSE(topology().chosen()) << "only looked at";
    QTest::keyClick(table_, Qt::Key_Return);
    EXPECT_EQ(topology().chosen(), topology().shown()[2]);
    EXPECT_EQ(isovalue().requested(), topology().justPast(topology().shown()[2]));
    table_->sortByColumn(widgets::TopologyTable::Persistence, Qt::DescendingOrder);
    QTest::keyClick(window_.get(), Qt::Key_BracketRight);
    ASSERT_TRUE(topology().chosen());
    const auto selected = table_->selectionModel()->selectedRows(widgets::TopologyTable::Isovalue);
    ASSERT_EQ(selected.size(), 1);
    EXPECT_EQ(selected.front().data().toString().toStdString(),
              model::valueText(topology().events()[*topology().chosen()].isovalue, 7));
    QTest::keyClick(window_.get(), Qt::Key_Escape);
    EXPECT_TRUE(table_->selectionModel()->selectedRows().isEmpty());
}

// What the menu of a row offers, for the row that the right button was pressed on.
TEST_F(TopologyPanelTest, TheMenuOfARowGoesThereHidesAndCopies) {
    const auto press = [this](int row) {
        const QModelIndex index = table_->model()->index(row, widgets::TopologyTable::What);
        table_->scrollTo(index);
        QTest::mouseClick(table_->viewport(), Qt::RightButton, {}, table_->visualRect(index).center());
    };
    ASSERT_EQ(table_->contextMenuPolicy(), Qt::ActionsContextMenu);
    press(1);
    EXPECT_FALSE(topology().chosen()) << "the menu decides";
    const QString isovalue = textAt(1, widgets::TopologyTable::Isovalue);
    table_->findChild<QAction*>(QStringLiteral("topologyGo"))->trigger();
    EXPECT_EQ(topology().chosen(), topology().shown()[1]);

    press(1);
    QTest::keyClick(table_, Qt::Key_C, Qt::ControlModifier);
    const QStringList lines = QGuiApplication::clipboard()->text().split(QLatin1Char('\n'));
    ASSERT_EQ(lines.size(), 3) << "headings, the row, and what follows its end";
    EXPECT_EQ(lines[0].split(QLatin1Char('\t')).size(), widgets::TopologyTable::kColumns);
    EXPECT_TRUE(lines[1].startsWith(isovalue + QLatin1Char('\t')));
    EXPECT_TRUE(lines[2].isEmpty());
    table_->findChild<QAction*>(QStringLiteral("copyAllRows"))->trigger();
    EXPECT_EQ(QGuiApplication::clipboard()->text().count(QLatin1Char('\n')), rows() + 1);

    table_->sortByColumn(widgets::TopologyTable::Persistence, Qt::DescendingOrder);
    const int before = rows();
    press(0);
    table_->findChild<QAction*>(QStringLiteral("topologyHideLess"))->trigger();
    EXPECT_LT(rows(), before);
    EXPECT_GE(rows(), 1) << "itself stays";
}

TEST_F(TopologyPanelTest, StatesWhyThereIsNothing) {
    topology().setAnalysing();
    EXPECT_EQ(stateText(), "Analysing the topology…");
    topology().setFailed("volumes with missing values are not analysed");
    EXPECT_EQ(stateText(), "The topology could not be analysed: volumes with missing values are not analysed");
    keepPicture(*window_, "topology_failed");
    topology().setContent(model::TopologyModel::contentOf(std::make_shared<QuietSummary>()).value());
    EXPECT_EQ(stateText(), "The surface has the same topology at every isovalue: there are no events.");
    EXPECT_FALSE(window_->actions().action("isovalue.nextEvent")->isEnabled());
    session_->close();
    EXPECT_EQ(stateText(), "No volume is open.");
}

// Of a volume with more events than memory holds: counts at some isovalues.
TEST_F(TopologyPanelTest, OffersCountsWhereThereAreNoEvents) {
    std::vector<topology::TopologyEvent> steps(3);
    for (std::size_t i = 0; i < steps.size(); ++i) {
        steps[i].isovalue = -30.0 + 20.0 * static_cast<double>(i);
        steps[i].below.components = i == 0 ? 0 : static_cast<std::int64_t>(4 + i);
        steps[i].above.components = i + 1 == steps.size() ? 0 : static_cast<std::int64_t>(5 + i);
    }
    const auto withEvents = topology().summary();
    auto* note = child<QLabel>("topologyNoEvents");
    EXPECT_FALSE(note->isVisible()) << "there are events";
    topology().setContent(model::TopologyModel::contentOf(
                              std::make_shared<topology::TopologyCurve>(steps, QuietSummary().curves(), true, false))
                              .value());
    EXPECT_TRUE(waitUntil([&] { return note->isVisible(); }));
    EXPECT_FALSE(table_->isVisible());
    EXPECT_FALSE(child<QComboBox>("topologyFilter")->isVisible());
    EXPECT_EQ(topology().eventCount(), 0u);
    EXPECT_FALSE(window_->actions().action("isovalue.nextEvent")->isEnabled());
    EXPECT_EQ(topology().countsAt(-15.0)->components, 5);
    EXPECT_TRUE(topology().hasCurve(model::TopologyQuantity::Pieces));
    EXPECT_TRUE(child<QTabWidget>("topologyTabs")->isVisible()) << "isovalues can be asked for, and compared";
    keepPicture(*window_, "topology_without_events");
    topology().setContent(model::TopologyModel::contentOf(withEvents).value());
    EXPECT_TRUE(waitUntil([&] { return table_->isVisible(); }));
    EXPECT_FALSE(note->isVisible());
}

class CurvesTest : public TopologyTest {
protected:
    /// Opens the menu with the mouse and clicks the entry.
    void toggle(const char* name) {
        auto* button = child<QToolButton>("curvesButton");
        QAction* action = actionOf(name);
        // The menu has an event loop.
        QTimer::singleShot(0, button->menu(), [button, action] {
            ASSERT_TRUE(waitUntil([&] { return button->menu()->isVisible(); }, std::chrono::seconds(5)));
            QTest::mouseClick(button->menu(), Qt::LeftButton, {}, button->menu()->actionGeometry(action).center());
            button->menu()->close();
        });
        QTest::mouseClick(button, Qt::LeftButton);
        ASSERT_TRUE(waitUntil([button] { return !button->menu()->isVisible(); }));
    }
    QAction* actionOf(const char* name) {
        auto* action = window_->findChild<QAction*>(QStringLiteral("curve.") + QLatin1String(name));
        EXPECT_NE(action, nullptr);
        return action;
    }
    std::string legend() {
        auto* label = child<QLabel>("curveLegend");
        QString text = label->isVisible() ? label->text() : QString();
        text.replace(QStringLiteral("&nbsp;"), QStringLiteral(" ")).replace(QChar(QChar::Nbsp), QLatin1Char(' '));
        return text.toStdString();
    }
};

TEST_F(CurvesTest, AreDrawnWhereTheyAreWantedAndKnown) {
    EXPECT_EQ(legend(), "");
    EXPECT_TRUE(actionOf("pieces")->isEnabled());
    toggle("pieces");
    isovalue().request(1.5);
    EXPECT_NE(legend().find("pieces: 3"), std::string::npos) << legend();
    isovalue().request(5.0);
    EXPECT_NE(legend().find("pieces: 1"), std::string::npos) << legend();
    EXPECT_EQ(settings_->list("histogram/curves"), QStringList{QStringLiteral("pieces")});
    keepPicture(*window_, "topology_curves");
    toggle("pieces");
    EXPECT_EQ(legend(), "");
    EXPECT_TRUE(settings_->list("histogram/curves").isEmpty());
}

TEST_F(CurvesTest, OfMeasuresAreThereOnceTheyAreKnown) {
    topology().setFailed("no measures");
    for (const char* name : {"pieces", "area", "gradient"}) {
        EXPECT_FALSE(actionOf(name)->isEnabled()) << name;
        EXPECT_EQ(actionOf(name)->toolTip(), QStringLiteral("Not known for this volume"));
    }
    topology().setContent(model::TopologyModel::contentOf(std::make_shared<QuietSummary>()).value());
    EXPECT_FALSE(actionOf("pieces")->isEnabled());
    toggle("area");
    toggle("triangles");
    isovalue().request(-10.0);
    EXPECT_NE(legend().find("area: 20 units²"), std::string::npos) << legend();
    EXPECT_NE(legend().find("triangles (log): 500,001"), std::string::npos) << legend();
    topology().setFailed("gone");
    EXPECT_EQ(legend(), "") << "what is chosen is not shown of nothing";
}

TEST_F(CurvesTest, ChoicesAreKept) {
    toggle("tunnels");
    makeWindow();
    openCones();
    EXPECT_TRUE(actionOf("tunnels")->isChecked());
    EXPECT_NE(legend().find("tunnels: "), std::string::npos) << legend();
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
