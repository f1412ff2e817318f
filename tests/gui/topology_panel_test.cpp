// The panel of the topology: its list, filters, menus and words.
#include <QAbstractItemModelTester>
#include <QAction>
#include <QClipboard>
#include <QComboBox>
#include <QDockWidget>
#include <QGuiApplication>
#include <QHeaderView>
#include <QLabel>
#include <QScrollBar>
#include <QSlider>
#include <QSortFilterProxyModel>
#include <QTabWidget>
#include <QTableView>
#include <QTest>

#include "tests/gui/topology_fixture.h"
#include "ui/model/isovalue/number_text.h"
#include "ui/widgets/common/small_widgets.h"
#include "ui/widgets/panels/topology_table.h"
#include "ui/widgets/viewport/viewport_host.h"
#include "ui/widgets/viewport/viewport_widget.h"
#include "ui/widgets/window/action_registry.h"

namespace isoslider::test {
namespace {

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

// The panel may be too narrow for all of them.
TEST_F(TopologyPanelTest, ColumnsInViewAreWhole) {
    topology().setLeastPersistence(0.0);
    const auto* header = table_->horizontalHeader();
    auto* dock = child<QDockWidget>("topologyDock");
    for (const int width : {450, 360, 800}) {
        window_->resizeDocks({dock}, {width}, Qt::Horizontal);
        ASSERT_TRUE(waitUntil([&] { return dock->width() == width; }));
        for (const int sorted : {widgets::TopologyTable::Persistence, widgets::TopologyTable::Isovalue}) {
            table_->sortByColumn(sorted, Qt::AscendingOrder);
            QTest::qWait(30);
            const int right = table_->viewport()->width();
            for (int column = 0; column < widgets::TopologyTable::kColumns; ++column) {
                const int begin = header->sectionViewportPosition(column), end = begin + header->sectionSize(column);
                EXPECT_TRUE(end <= right || begin >= right) << column << " in " << width;
                EXPECT_GE(header->sectionSize(column),
                          header->fontMetrics().horizontalAdvance(
                              table_->model()->headerData(column, Qt::Horizontal).toString()));
                if (column == widgets::TopologyTable::What)
                    continue;
                for (int row = 0; row < rows(); ++row)
                    EXPECT_GE(header->sectionSize(column),
                              table_->sizeHintForIndex(table_->model()->index(row, column)).width());
            }
            if (width >= 450) {
                EXPECT_LE(header->sectionViewportPosition(widgets::TopologyTable::Tunnels), right);
            }
        }
    }
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

} // namespace
} // namespace isoslider::test
