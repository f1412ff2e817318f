// What the window offers about the topology: suggested isovalues, the first one, those that are found, and comparing.
#include <cmath>

#include <QAction>
#include <QApplication>
#include <QComboBox>
#include <QDockWidget>
#include <QHelpEvent>
#include <QLabel>
#include <QLineEdit>
#include <QMenu>
#include <QMenuBar>
#include <QPushButton>
#include <QTabBar>
#include <QTabWidget>
#include <QTableView>
#include <QTest>
#include <QToolTip>
#include <QTreeWidget>
#include <QWindow>

#include "tests/gui/cones.h"
#include "tests/gui/window_fixture.h"
#include "ui/model/isovalue/histogram_model.h"
#include "ui/model/isovalue/number_text.h"
#include "ui/model/topology/question_model.h"
#include "ui/widgets/isovalue/axis_highlights.h"
#include "ui/widgets/isovalue/histogram_plot.h"
#include "ui/widgets/isovalue/isovalue_edit.h"
#include "ui/widgets/isovalue/isovalue_panel.h"
#include "ui/widgets/panels/topology_panel.h"
#include "ui/widgets/viewport/viewport_host.h"
#include "ui/widgets/window/action_registry.h"
#include "ui/widgets/window/session_keeper.h"

namespace isoslider::test {
namespace {

class QuestionsTest : public WindowTest {
protected:
    void openCones(std::optional<double> first = std::nullopt) {
        startOpening(first);
        ASSERT_TRUE(waitUntilSettled());
        ASSERT_EQ(topology().state(), model::TopologyState::Ready);
        ASSERT_GE(topology().suggestions().size(), 3u);
        QTest::qWait(30);
    }
    /// Until the first surface; the index is not there where the builder holds it.
    void startOpening(std::optional<double> first = std::nullopt) {
        window_->openFile(QString::fromStdString(writeCones(folder_).string()), first);
        ASSERT_TRUE(waitUntil([this] { return isovalue().hasDisplayed(); }));
    }
    void waitForTopology() {
        builder_->holds = false;
        ASSERT_TRUE(waitUntil([this] { return topology().state() == model::TopologyState::Ready; }));
    }
    model::TopologyModel& topology() { return session_->topology(); }
    model::IsovalueModel& isovalue() { return session_->isovalue(); }
    widgets::HistogramPlot& plot() { return window_->isovaluePanel().plot(); }
    widgets::AxisHighlights& highlights() { return *plot().findChild<widgets::AxisHighlights*>(); }
    double best() { return topology().suggestions().front().isovalue; }
    double ofHistogram() { return model::firstIsovalue(*session_->dataset()->values); }
    std::string note() {
        auto* label = child<QLabel>("firstIsovalueNote");
        return label->isVisible() ? label->text().toStdString() : std::string();
    }
    static std::string noteOf(const model::SuggestedIsovalue& one) { return "Isovalue " + model::suggestionText(one); }
    void clickTab(const char* title) {
        child<QDockWidget>("topologyDock")->raise();
        auto* bar = child<QTabWidget>("topologyTabs")->tabBar();
        ASSERT_TRUE(waitUntil([bar] { return bar->isVisible(); }));
        for (int tab = 0; tab < bar->count(); ++tab)
            if (bar->tabText(tab) == QLatin1String(title))
                QTest::mouseClick(bar, Qt::LeftButton, {}, bar->tabRect(tab).center());
    }
    static QPoint placeOf(const QTreeWidget& list, int row) {
        return list.visualItemRect(list.topLevelItem(row)).center();
    }
};

// --- the first isovalue

TEST_F(QuestionsTest, OpensWithTheHistogramsIsovalueAndSlidesToTheBest) {
    builder_->holds = true;
    startOpening();
    EXPECT_EQ(isovalue().requested(), ofHistogram());
    EXPECT_EQ(note(), noteOf({ofHistogram(), model::kHistogramReason}));
    keepPicture(*window_, "first_isovalue_histogram");
    waitForTopology();
    EXPECT_EQ(isovalue().requested(), best());
    ASSERT_TRUE(waitUntilSettled());
    EXPECT_EQ(isovalue().displayed(), best());
    EXPECT_EQ(note(), noteOf(session_->suggestions().front()));
    EXPECT_NE(best(), ofHistogram());
    keepPicture(*window_, "first_isovalue_best");
    plot().setFocus();
    QTest::keyClick(&plot(), Qt::Key_Right);
    EXPECT_EQ(note(), "");
    isovalue().request(best());
    EXPECT_EQ(note(), "") << "it was gone to, not opened with";
}

TEST_F(QuestionsTest, StaysWhereTheUserHasGone) {
    builder_->holds = true;
    startOpening();
    plot().setFocus();
    QTest::keyClick(&plot(), Qt::Key_Right);
    const double there = isovalue().requested();
    EXPECT_EQ(note(), "");
    waitForTopology();
    ASSERT_TRUE(waitUntilSettled());
    EXPECT_EQ(isovalue().requested(), there);
    EXPECT_EQ(note(), "");
}

TEST_F(QuestionsTest, StaysWhereItWasAskedFor) {
    openCones(-2.0);
    EXPECT_EQ(isovalue().requested(), -2.0);
    EXPECT_EQ(note(), "");
}

TEST_F(QuestionsTest, WaitsUntilTheButtonIsReleased) {
    builder_->holds = true;
    startOpening();
    const QPoint empty(40, window_->menuBar()->height() / 2 + 400);
    QTest::mousePress(window_->windowHandle(), Qt::LeftButton, {}, empty);
    waitForTopology();
    QTest::qWait(400);
    EXPECT_EQ(isovalue().requested(), ofHistogram()) << "no jump under the hands";
    QTest::mouseRelease(window_->windowHandle(), Qt::LeftButton, {}, empty);
    EXPECT_TRUE(waitUntil([this] { return isovalue().requested() == best(); }, std::chrono::seconds(5)));
}

TEST_F(QuestionsTest, WaitsWhileAValueIsTyped) {
    builder_->holds = true;
    startOpening();
    trigger("isovalue.edit");
    auto& edit = window_->isovaluePanel().edit();
    QTest::keyClicks(&edit, QStringLiteral("-3"));
    waitForTopology();
    QTest::qWait(400);
    EXPECT_EQ(isovalue().requested(), ofHistogram());
    EXPECT_EQ(edit.text(), QStringLiteral("-3"));
    QTest::keyClick(&edit, Qt::Key_Return);
    EXPECT_EQ(isovalue().requested(), -3.0);
    QTest::qWait(400);
    EXPECT_EQ(isovalue().requested(), -3.0);
}

TEST_F(QuestionsTest, WhatIsCheckedStays) {
    builder_->holds = true;
    startOpening();
    trigger("mesh.check");
    waitForTopology();
    ASSERT_TRUE(waitUntilSettled());
    EXPECT_EQ(isovalue().requested(), ofHistogram());
    EXPECT_NE(note(), "") << "it is still the first one";
}

TEST_F(QuestionsTest, OfAnIndexWithItsTopologyTheBestIsTheFirst) {
    openCones();
    const double found = best();
    makeWindow();
    std::vector<double> displayed;
    const auto subscription = session_->isovalue().observe([&] {
        if (isovalue().hasDisplayed() && (displayed.empty() || displayed.back() != isovalue().displayed()))
            displayed.push_back(isovalue().displayed());
    });
    openCones();
    EXPECT_EQ(displayed, std::vector<double>{found});
    EXPECT_EQ(note(), noteOf(session_->suggestions().front()));
}

TEST_F(QuestionsTest, TheNoteGivesWayInASmallView) {
    openCones();
    EXPECT_NE(note(), "");
    const auto* label = child<QLabel>("firstIsovalueNote");
    EXPECT_TRUE(window_->viewportHost().rect().contains(label->geometry()));
    trigger("view.readout");
    EXPECT_EQ(note(), "");
    trigger("view.readout");
    EXPECT_NE(note(), "");
    window_->resize(420, 500);
    ASSERT_TRUE(waitUntil([&] { return window_->viewportHost().width() < 430; }));
    QTest::qWait(50);
    EXPECT_TRUE(label->isHidden() || window_->viewportHost().rect().contains(label->geometry()));
    session_->close();
    EXPECT_EQ(note(), "");
}

// --- suggestions

TEST_F(QuestionsTest, SuggestionsAreInTheMenu) {
    auto* menu = child<QMenu>("suggestionsMenu");
    EXPECT_FALSE(menu->isEnabled());
    builder_->holds = true;
    startOpening();
    ASSERT_EQ(menu->actions().size(), 2);
    EXPECT_FALSE(menu->actions().last()->isEnabled()) << "more to come";
    topology().setFailed("it does not fit into memory");
    EXPECT_EQ(menu->actions().size(), 1) << "nothing more to come";
    topology().clear();
    waitForTopology();
    ASSERT_TRUE(waitUntilSettled());
    const auto suggestions = session_->suggestions();
    ASSERT_EQ(menu->actions().size(), static_cast<int>(suggestions.size()));
    for (std::size_t i = 0; i < suggestions.size(); ++i) {
        QAction* action = menu->actions().at(static_cast<int>(i));
        EXPECT_TRUE(action->text().endsWith(QString::fromStdString(model::suggestionText(suggestions[i]))))
            << action->text().toStdString();
        menu->popup(QPoint(100, 100));
        QTest::mouseClick(menu, Qt::LeftButton, {}, menu->actionGeometry(action).center());
        EXPECT_EQ(isovalue().requested(), suggestions[i].isovalue);
    }
    session_->close();
    EXPECT_FALSE(menu->isEnabled());
}

TEST_F(QuestionsTest, SuggestionsAreStarsOnTheAxis) {
    openCones();
    isovalue().request(isovalue().min());
    const auto suggestions = session_->suggestions();
    int pressed = 0;
    for (std::size_t i = 0; i < suggestions.size(); ++i) {
        const auto place = highlights().placeOf(i);
        ASSERT_TRUE(place);
        EXPECT_NEAR(place->x(), plot().pixelOf(suggestions[i].isovalue), 0.5);
        const bool isAlone = std::all_of(suggestions.begin(), suggestions.end(), [&](const auto& other) {
            return other.isovalue == suggestions[i].isovalue ||
                   std::abs(plot().pixelOf(other.isovalue) - place->x()) > 16.0;
        });
        if (!isAlone || std::abs(plot().pixelOf(isovalue().requested()) - place->x()) < 8.0)
            continue;
        QHelpEvent help(QEvent::ToolTip, place->toPoint(), plot().mapToGlobal(place->toPoint()));
        QApplication::sendEvent(&plot(), &help);
        EXPECT_TRUE(QToolTip::text().contains(QString::fromStdString(suggestions[i].reason)))
            << QToolTip::text().toStdString();
        QToolTip::hideText();
        QTest::mouseClick(&plot(), Qt::LeftButton, {}, place->toPoint() + QPoint(2, 1));
        EXPECT_EQ(isovalue().requested(), suggestions[i].isovalue);
        ++pressed;
        // Below it, the plot is the slider it always was.
        QTest::mouseClick(&plot(), Qt::LeftButton, {}, place->toPoint() + QPoint(20, 40));
        EXPECT_NE(isovalue().requested(), suggestions[i].isovalue);
    }
    EXPECT_GE(pressed, 2);
}

TEST_F(QuestionsTest, SuggestionsAreListedInThePanel) {
    openCones();
    clickTab("Isovalues");
    auto* list = child<QTreeWidget>("suggestedIsovalues");
    ASSERT_TRUE(list->isVisible());
    const auto suggestions = session_->suggestions();
    ASSERT_EQ(list->topLevelItemCount(), static_cast<int>(suggestions.size()));
    ASSERT_NE(list->currentItem(), nullptr);
    EXPECT_TRUE(list->topLevelItem(0)->isSelected()) << "the one on screen";
    EXPECT_EQ(list->topLevelItem(1)->text(1).toStdString(), suggestions[1].reason);
    QTest::mouseClick(list->viewport(), Qt::LeftButton, {}, placeOf(*list, 1));
    EXPECT_EQ(isovalue().requested(), suggestions[1].isovalue);
    QTest::keyClick(list, Qt::Key_Up);
    QTest::keyClick(list, Qt::Key_Return);
    EXPECT_EQ(isovalue().requested(), suggestions[0].isovalue);
    keepPicture(*window_, "suggestions");
}

// --- isovalues that are found

class FindTest : public QuestionsTest {
protected:
    FindTest() {
        openCones();
        QTest::keyClick(window_.get(), Qt::Key_F, Qt::ControlModifier);
        value_ = child<QLineEdit>("findValue");
        found_ = child<QTreeWidget>("foundIsovalues");
    }
    void type(const QString& text) {
        value_->selectAll();
        QTest::keyClick(value_, Qt::Key_Delete);
        QTest::keyClicks(value_, text);
        ASSERT_TRUE(waitUntil([this] { return question().state() != model::QuestionState::Searching; }));
    }
    void choose(model::QueryQuantity quantity) {
        auto* box = child<QComboBox>("findQuantity");
        box->setFocus();
        while (box->currentIndex() != static_cast<int>(quantity)) {
            const int before = box->currentIndex();
            QTest::keyClick(box, box->currentIndex() < static_cast<int>(quantity) ? Qt::Key_Down : Qt::Key_Up);
            ASSERT_NE(box->currentIndex(), before);
        }
        ASSERT_TRUE(waitUntil([this] { return question().state() != model::QuestionState::Searching; }));
    }
    model::QuestionModel& question() { return window_->findChild<widgets::TopologyPanel*>()->question(); }
    std::string answer() {
        auto* label = child<QLabel>("findAnswer");
        return label->isVisible() ? label->text().toStdString() : std::string();
    }

    QLineEdit* value_ = nullptr;
    QTreeWidget* found_ = nullptr;
};

TEST_F(FindTest, TheShortcutBringsTheFieldUp) {
    EXPECT_TRUE(value_->isVisible());
    EXPECT_EQ(QApplication::focusWidget(), value_);
    EXPECT_TRUE(value_->placeholderText().startsWith(QStringLiteral("now ")))
        << value_->placeholderText().toStdString();
    EXPECT_EQ(value_->accessibleName(), QStringLiteral("Pieces"));
    EXPECT_EQ(answer(), "");
}

TEST_F(FindTest, IsovaluesWithSoManyPieces) {
    type(QStringLiteral("3"));
    ASSERT_EQ(question().state(), model::QuestionState::Answered);
    ASSERT_GE(found_->topLevelItemCount(), 1);
    EXPECT_NE(answer().find("3 pieces"), std::string::npos) << answer();
    EXPECT_EQ(highlights().found().size(), question().found().intervals.size());
    for (int row = 0; row < found_->topLevelItemCount(); ++row) {
        QTest::mouseClick(found_->viewport(), Qt::LeftButton, {}, placeOf(*found_, row));
        EXPECT_EQ(topology().countsAt(isovalue().requested())->components, 3) << row;
    }
    keepPicture(*window_, "find_pieces");
    // Enter goes from one to the next.
    isovalue().request(isovalue().min());
    value_->setFocus();
    QTest::keyClick(value_, Qt::Key_Return);
    EXPECT_EQ(topology().countsAt(isovalue().requested())->components, 3);
    QTest::keyClick(value_, Qt::Key_Escape);
    EXPECT_EQ(value_->text(), QString());
    EXPECT_EQ(answer(), "");
    EXPECT_TRUE(highlights().found().empty());
    EXPECT_FALSE(found_->isVisible());
}

TEST_F(FindTest, ArrowsReachTheList) {
    type(QStringLiteral("1"));
    QTest::keyClick(value_, Qt::Key_Down);
    EXPECT_EQ(QApplication::focusWidget(), found_);
    const double before = isovalue().requested();
    QTest::keyClick(found_, Qt::Key_Return);
    EXPECT_EQ(isovalue().requested(), model::isovalueIn(question().found().intervals.front()));
    EXPECT_NE(isovalue().requested(), before);
}

TEST_F(FindTest, StatesWhatThereIsNot) {
    type(QStringLiteral("70"));
    EXPECT_EQ(question().state(), model::QuestionState::Answered);
    EXPECT_EQ(answer().find("No isovalue has 70 pieces; the most is "), 0u) << answer();
    EXPECT_TRUE(highlights().found().empty());
    keepPicture(*window_, "find_nothing");
    type(QStringLiteral("2.5"));
    EXPECT_EQ(answer(), "Only whole numbers are counted");
    type(QStringLiteral("many"));
    EXPECT_EQ(answer(), "Type a whole number");
    keepPicture(*window_, "find_invalid");
    const double before = isovalue().requested();
    QTest::keyClick(value_, Qt::Key_Return);
    EXPECT_EQ(isovalue().requested(), before);
    EXPECT_EQ(value_->text(), QStringLiteral("many")) << "letters are typed, no shortcuts";
}

TEST_F(FindTest, IsovaluesOfAnAreaAndOfAVolume) {
    for (const auto quantity : {model::QueryQuantity::Area, model::QueryQuantity::Volume}) {
        isovalue().request(1.0);
        ASSERT_TRUE(waitUntil([this] { return !isovalue().isLagging(); }));
        choose(quantity);
        EXPECT_TRUE(value_->accessibleName().contains(QStringLiteral("units")))
            << value_->accessibleName().toStdString();
        const double wanted = model::valueAt(*topology().summary(), quantity, 1.0).value();
        type(QString::number(wanted, 'g', 17));
        ASSERT_GE(found_->topLevelItemCount(), 1) << answer();
        double nearest = 1e9;
        for (const auto& interval : question().found().intervals)
            nearest = std::min(nearest, std::abs(model::isovalueIn(interval) - 1.0));
        EXPECT_LT(nearest, 1e-9);
        QTest::mouseClick(found_->viewport(), Qt::LeftButton, {}, placeOf(*found_, 0));
        EXPECT_NEAR(model::valueAt(*topology().summary(), quantity, isovalue().requested()).value(), wanted,
                    1e-6 * wanted);
        type(QStringLiteral("1e30"));
        EXPECT_NE(answer().find("; the most is "), std::string::npos) << answer();
    }
    keepPicture(*window_, "find_volume");
}

TEST_F(FindTest, AnotherVolumeIsSearchedForTheSame) {
    type(QStringLiteral("3"));
    ASSERT_GE(found_->topLevelItemCount(), 1);
    session_->close();
    EXPECT_EQ(question().state(), model::QuestionState::Empty);
    EXPECT_TRUE(highlights().found().empty());
    openBall();
    ASSERT_TRUE(waitUntil([this] { return question().state() == model::QuestionState::Answered; }));
    EXPECT_EQ(question().found().count, 0u);
    value_->setFocus();
    EXPECT_EQ(answer().find("No isovalue has 3 pieces"), 0u) << answer();
}

// --- comparing

class CompareTest : public QuestionsTest {
protected:
    CompareTest() { openCones(); }
    void goTo(double value) {
        isovalue().request(value);
        ASSERT_TRUE(waitUntil([this] { return !isovalue().isLagging(); }));
    }
    QString cell(const QString& row, int column) {
        const auto* sides = child<QTableView>("compareTable")->model();
        for (int i = 0; i < sides->rowCount(); ++i)
            if (sides->index(i, 0).data().toString() == row)
                return sides->index(i, column).data().toString();
        return QStringLiteral("no row ") + row;
    }
    std::string between(const char* name) {
        for (const auto* label : child<QWidget>("compareBetween")->findChildren<QLabel*>())
            if (label->accessibleName().startsWith(QLatin1String(name) + QStringLiteral(": ")))
                return label->text().toStdString();
        return "none";
    }
};

TEST_F(CompareTest, StatesWhatLiesBetweenWhileSliding) {
    goTo(1.5);
    QTest::keyClick(window_.get(), Qt::Key_D);
    EXPECT_EQ(isovalue().reference(), 1.5);
    auto* table = child<QTableView>("compareTable");
    ASSERT_TRUE(waitUntil([table] { return table->isVisible(); })) << "the key brings the page up";
    EXPECT_EQ(between("Events"), "0");
    goTo(5.0);
    EXPECT_EQ(cell(QStringLiteral("Isovalue"), 1), QStringLiteral("1.5"));
    EXPECT_EQ(cell(QStringLiteral("Isovalue"), 2), QStringLiteral("5"));
    EXPECT_EQ(cell(QStringLiteral("Pieces"), 1), QStringLiteral("3"));
    EXPECT_EQ(cell(QStringLiteral("Pieces"), 2), QStringLiteral("1"));
    EXPECT_EQ(between("Pieces disappear"), "2");
    EXPECT_EQ(between("Pieces appear"), "0");
    EXPECT_TRUE(QString::fromStdString(between("Volume between")).endsWith(QStringLiteral("units³")));
    keepPicture(*window_, "compare");
    // Downwards, what splits on the way up joins.
    goTo(-3.0);
    EXPECT_EQ(cell(QStringLiteral("Pieces"), 2), QStringLiteral("1"));
    EXPECT_EQ(between("Pieces join"), "2");
    EXPECT_EQ(between("Pieces split"), "0");
    EXPECT_EQ(std::stoul(between("Events")), topology::difference(*topology().summary(), -3.0, 1.5).value().events);
}

TEST_F(CompareTest, ButtonsSwapAndStop) {
    clickTab("Compare");
    auto *compare = child<QPushButton>("compareButton"), *swap = child<QPushButton>("compareSwap"),
         *stop = child<QPushButton>("compareStop");
    EXPECT_TRUE(compare->isEnabled());
    EXPECT_FALSE(swap->isEnabled());
    EXPECT_FALSE(stop->isEnabled());
    EXPECT_TRUE(child<QLabel>("compareHint")->isVisible());
    keepPicture(*window_, "compare_nothing");
    goTo(1.5);
    QTest::mouseClick(compare, Qt::LeftButton);
    goTo(4.0);
    QTest::mouseClick(swap, Qt::LeftButton);
    EXPECT_EQ(isovalue().reference(), 4.0);
    EXPECT_EQ(isovalue().requested(), 1.5);
    QTest::mouseClick(stop, Qt::LeftButton);
    EXPECT_FALSE(isovalue().reference());
    EXPECT_FALSE(stop->isEnabled());
    EXPECT_FALSE(child<QTableView>("compareTable")->isVisible());
    trigger("isovalue.compare");
    QTest::keyClick(window_.get(), Qt::Key_D, Qt::ShiftModifier);
    EXPECT_FALSE(isovalue().reference());
}

TEST_F(CompareTest, TheReferenceIsMarkedOnTheAxis) {
    goTo(1.5);
    const QPoint flag(static_cast<int>(std::lround(plot().pixelOf(1.5))), plot().axisRect()->top() + 3);
    EXPECT_FALSE(highlights().tipAt(flag).contains(QStringLiteral("Reference")));
    trigger("isovalue.compare");
    goTo(5.0);
    EXPECT_EQ(highlights().tipAt(flag), QStringLiteral("Reference isovalue 1.5"));
    const QColor colour = plot().grab().toImage().pixelColor(flag.x() + 1, flag.y() + 1);
    const QColor text = plot().palette().color(QPalette::Text);
    EXPECT_LT(std::abs(colour.lightness() - text.lightness()), 60) << colour.name().toStdString();
    session_->close();
    EXPECT_EQ(highlights().tipAt(flag), QString());
}

TEST_F(CompareTest, AnotherVolumeHasNoReference) {
    trigger("isovalue.compare");
    openBall();
    EXPECT_FALSE(isovalue().reference());
    EXPECT_FALSE(window_->actions().action("isovalue.stopComparing")->isEnabled());
}

TEST_F(CompareTest, ASessionKeepsTheReference) {
    goTo(1.5);
    trigger("isovalue.compare");
    goTo(4.0);
    const auto path = folder_ / "kept.isosession";
    dialogs_.answers.push_back(QString::fromStdString(path.string()));
    trigger("file.saveSession");
    ASSERT_TRUE(waitUntil([&] { return std::filesystem::exists(path); }));
    makeWindow();
    window_->openFile(QString::fromStdString(path.string()));
    ASSERT_TRUE(waitUntil([this] { return isovalue().reference().has_value(); }));
    ASSERT_TRUE(waitUntilSettled());
    EXPECT_EQ(isovalue().reference(), 1.5);
    EXPECT_EQ(isovalue().requested(), 4.0) << "and no suggestion takes the place of a kept isovalue";
    EXPECT_EQ(note(), "");
}

TEST_F(CompareTest, TabGoesThroughThePages) {
    QTest::keyClick(window_.get(), Qt::Key_F, Qt::ControlModifier);
    auto* value = child<QLineEdit>("findValue");
    ASSERT_EQ(QApplication::focusWidget(), value);
    QTest::keyClicks(value, QStringLiteral("1"));
    auto* found = child<QTreeWidget>("foundIsovalues");
    ASSERT_TRUE(waitUntil([found] { return found->isVisible(); }));
    QTest::keyClick(value, Qt::Key_Tab);
    EXPECT_EQ(QApplication::focusWidget(), found);
    QTest::keyClick(found, Qt::Key_Backtab);
    QTest::keyClick(value, Qt::Key_Backtab);
    EXPECT_EQ(QApplication::focusWidget(), child<QComboBox>("findQuantity"));
    QTest::keyClick(QApplication::focusWidget(), Qt::Key_Backtab);
    EXPECT_EQ(QApplication::focusWidget(), child<QTreeWidget>("suggestedIsovalues"));
    for (const auto* widget : {static_cast<QWidget*>(found), static_cast<QWidget*>(value),
                               static_cast<QWidget*>(child<QComboBox>("findQuantity")),
                               static_cast<QWidget*>(child<QTreeWidget>("suggestedIsovalues"))})
        EXPECT_FALSE(widget->accessibleName().isEmpty()) << widget->objectName().toStdString();
}

} // namespace
} // namespace isoslider::test
