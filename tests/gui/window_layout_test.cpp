// How the window looks and is used with keys, small screens, other colours and assistive technology.
#include <algorithm>
#include <set>
#include <vector>

#include <QAccessible>
#include <QAction>
#include <QClipboard>
#include <QContextMenuEvent>
#include <QDockWidget>
#include <QGuiApplication>
#include <QLabel>
#include <QMenu>
#include <QMenuBar>
#include <QScrollArea>
#include <QScrollBar>
#include <QStyle>
#include <QStyleFactory>
#include <QTableView>
#include <QTest>

#include "core/volume_io/volume_reader.h"
#include "preprocess/build_index.h"
#include "tests/gui/window_fixture.h"
#include "tests/support/process_runner.h"
#include "ui/widgets/common/small_widgets.h"
#include "ui/widgets/common/text_colour.h"
#include "ui/widgets/isovalue/histogram_plot.h"
#include "ui/widgets/isovalue/isovalue_edit.h"
#include "ui/widgets/isovalue/isovalue_panel.h"
#include "ui/widgets/viewport/viewport_host.h"
#include "ui/widgets/window/action_registry.h"
#include "ui/widgets/window/message_bar.h"

namespace isoslider::test {
namespace {

class WindowLayoutTest : public WindowTest {
protected:
    void resizeTo(int width, int height) {
        window_->resize(width, height);
        QTest::qWait(120);
    }
    /// Moves the line between the view and the panels.
    void dragPanelEdge(int right) {
        auto* dock = child<QDockWidget>("datasetDock");
        dragLine(dock->mapTo(window_.get(), QPoint(0, 0)) + QPoint(-2, 100), QPoint(right, 0));
    }
    void dragLine(const QPoint& edge, const QPoint& way) {
        QTest::mousePress(window_.get(), Qt::LeftButton, {}, edge);
        const QPoint end = edge + way;
        QMouseEvent move(QEvent::MouseMove, end, window_->mapToGlobal(QPointF(end)), Qt::NoButton, Qt::LeftButton,
                         Qt::NoModifier);
        QApplication::sendEvent(window_.get(), &move);
        QTest::qWait(30);
        QTest::mouseRelease(window_.get(), Qt::LeftButton, {}, end);
        QTest::qWait(30);
    }
    /// Some of it, or of what is in it.
    bool isSeen(const QWidget& widget) {
        const QWidget* there = window_->childAt(widget.mapTo(window_.get(), widget.rect().center()));
        return !widget.visibleRegion().isEmpty() || (there != nullptr && widget.isAncestorOf(there));
    }
    int panelWidth() { return child<QDockWidget>("datasetDock")->width(); }
};

TEST_F(WindowLayoutTest, PanelsGetTheirWidthBack) {
    openBall();
    QTest::qWait(30);
    const int width = panelWidth();
    ASSERT_GT(width, 300);
    QTest::qWait(120);
    resizeTo(500, 400); // they are put away
    resizeTo(1500, 1000);
    EXPECT_EQ(panelWidth(), width);
    for (int window = 1500; window >= 700; window -= 100) // squeezed first
        resizeTo(window, 900);
    resizeTo(1500, 1000);
    EXPECT_EQ(panelWidth(), width);
    dragPanelEdge(70);
    const int wanted = panelWidth();
    ASSERT_NEAR(wanted, width - 70, 2);
    resizeTo(500, 400);
    resizeTo(1500, 1000);
    EXPECT_EQ(panelWidth(), wanted);
    window_->close();
    makeWindow();
    window_->restoreLayout();
    resizeTo(1500, 1000);
    EXPECT_NEAR(panelWidth(), wanted, 2) << "as it was saved";
}

TEST_F(WindowLayoutTest, TheHistogramGetsItsHeightBack) {
    openBall();
    auto* dock = child<QDockWidget>("isovalueDock");
    resizeTo(1500, 1000);
    const int height = dock->height();
    ASSERT_GT(height, 200);
    for (int window = 1000; window >= 500; window -= 100)
        resizeTo(1300, window);
    EXPECT_LT(dock->height(), 250) << "the view keeps its share";
    resizeTo(1500, 1000);
    EXPECT_EQ(dock->height(), height);
    resizeTo(500, 400); // panels are put away
    resizeTo(1500, 1000);
    EXPECT_EQ(dock->height(), height);
    dragLine(dock->mapTo(window_.get(), QPoint(200, 0)) + QPoint(0, -2), QPoint(0, -60));
    const int wanted = dock->height();
    ASSERT_NEAR(wanted, height + 60, 2);
    resizeTo(900, 600);
    resizeTo(1500, 1000);
    EXPECT_EQ(dock->height(), wanted);
    window_->close();
    makeWindow();
    window_->restoreLayout();
    resizeTo(1500, 1000);
    EXPECT_NEAR(child<QDockWidget>("isovalueDock")->height(), wanted, 2) << "as it was saved";
}

TEST_F(WindowLayoutTest, AWindowThatBeginsSmallHasItsPanelsLater) {
    const int width = panelWidth();
    window_.reset();
    makeWindow();
    window_->hide();
    window_->resize(500, 400);
    window_->show();
    QTest::qWait(30);
    resizeTo(1400, 900);
    EXPECT_TRUE(waitUntil([&] { return panelWidth() == width; }, std::chrono::seconds(5))) << panelWidth();
}

TEST_F(WindowLayoutTest, FullScreenGoesBackToAMaximisedWindow) {
    window_->showMaximized();
    QTest::qWait(20);
    trigger("view.fullScreen");
    QTest::qWait(20);
    EXPECT_TRUE(window_->isFullScreen());
    trigger("view.fullScreen");
    QTest::qWait(20);
    EXPECT_FALSE(window_->isFullScreen());
    EXPECT_TRUE(window_->isMaximized());
    window_->showNormal();
    trigger("view.fullScreen");
    trigger("view.fullScreen");
    EXPECT_FALSE(window_->isMaximized());
    window_->showFullScreen(); // by the desktop
    EXPECT_TRUE(window_->actions().action("view.fullScreen")->isChecked());
    window_->showNormal();
    EXPECT_FALSE(window_->actions().action("view.fullScreen")->isChecked());
}

// Each stop of the Tab key is seen, and the way comes round, by the tool bar, the view, the histogram and the panels.
TEST_F(WindowLayoutTest, TabReachesAllThatIsSeenAndComesRound) {
    openBall();
    window_->resize(1500, 1000);
    window_->activateWindow();
    ASSERT_TRUE(QTest::qWaitForWindowActive(window_.get()));
    ASSERT_TRUE(waitUntilSettled());
    QTest::qWait(600); // jobs in the status bar come and go
    for (const bool isForwards : {true, false}) {
        trigger("isovalue.edit");
        QWidget* first = QApplication::focusWidget();
        ASSERT_EQ(first, child<QWidget>("isovalueEdit"));
        std::vector<QWidget*> stops;
        const auto reaches = [&](const QWidget* part) {
            return std::any_of(stops.begin(), stops.end(),
                               [part](const QWidget* stop) { return stop == part || part->isAncestorOf(stop); });
        };
        for (int press = 0; press < 150; ++press) {
            QWidget* before = QApplication::focusWidget();
            QTest::keyClick(window_->windowHandle(), Qt::Key_Tab, isForwards ? Qt::NoModifier : Qt::ShiftModifier);
            QWidget* now = QApplication::focusWidget();
            ASSERT_NE(now, nullptr) << press;
            const std::string name = now->metaObject()->className() + (" " + now->objectName().toStdString());
            ASSERT_NE(now, before) << "stuck at " << name;
            EXPECT_TRUE(isSeen(*now)) << name;
            EXPECT_GE(std::min(now->width(), now->height()), 8) << name;
            if (now->objectName() == QStringLiteral("viewport") || qobject_cast<QScrollArea*>(now) != nullptr) {
                const auto* frame = now->findChild<QWidget*>(QStringLiteral("focusFrame"), Qt::FindDirectChildrenOnly);
                EXPECT_TRUE(frame != nullptr && frame->isVisible()) << name;
            }
            if (now == first)
                break;
            ASSERT_EQ(std::count(stops.begin(), stops.end(), now), 0) << "a smaller round from " << name;
            stops.push_back(now);
        }
        EXPECT_EQ(QApplication::focusWidget(), first) << "it comes round";
        for (const char* part : {"mainToolBar", "viewport", "isovalueDock", "datasetDock", "countsDock"})
            EXPECT_TRUE(reaches(child<QWidget>(part))) << part << (isForwards ? "" : ", backwards");
    }
}

TEST_F(WindowLayoutTest, EachLetterOfAMenuIsOneCommand) {
    QStringList recent;
    for (int i = 0; i < 12; ++i)
        recent << QString::fromStdString(folder_.write("R&D" + std::to_string(i) + ".mha", "x").string());
    settings_->set("files/recent", recent);
    makeWindow();
    QList<QMenu*> menus = window_->menuBar()->findChildren<QMenu*>();
    ASSERT_GT(menus.size(), 6);
    std::set<QString> bar;
    for (const QAction* action : window_->menuBar()->actions())
        EXPECT_TRUE(bar.insert(QKeySequence::mnemonic(action->text()).toString()).second)
            << action->text().toStdString();
    for (const QMenu* menu : menus) {
        std::set<QString> letters;
        for (const QAction* action : menu->actions()) {
            const QString letter = QKeySequence::mnemonic(action->text()).toString();
            if (letter.isEmpty()) {
                EXPECT_TRUE(action->isSeparator() || action->objectName().isEmpty()) << action->text().toStdString();
                continue;
            }
            EXPECT_TRUE(letters.insert(letter).second)
                << menu->title().toStdString() << " > " << action->text().toStdString() << ": " << letter.toStdString();
        }
    }
}

TEST_F(WindowLayoutTest, TheKeysMoveTheSurfaceOfAVolumeThatWasOpened) {
    openBall();
    auto& isovalue = session_->isovalue();
    const double before = isovalue.requested();
    ASSERT_NE(window_->focusWidget(), nullptr);
    QTest::keyClick(window_->focusWidget(), Qt::Key_Right);
    EXPECT_GT(isovalue.requested(), before);
    // What is being typed when the next volume comes stays.
    trigger("isovalue.edit");
    QTest::keyClicks(window_->focusWidget(), QStringLiteral("-3"));
    window_->openFile(QString::fromStdString(writeBall(folder_, "other.mha", 16).string()));
    ASSERT_TRUE(waitUntil([&] { return session_->dataset()->name == "other.mha" && session_->isSettled(); }));
    EXPECT_TRUE(window_->isovaluePanel().edit().hasFocus());
}

TEST_F(WindowLayoutTest, ReadoutsGiveWayBeforeTheControlsScroll) {
    openBall();
    resizeTo(1400, 900);
    EXPECT_TRUE(child<QLabel>("requestedReadout")->isVisible());
    resizeTo(740, 500);
    EXPECT_FALSE(child<QLabel>("requestedReadout")->isVisible());
    for (const auto* area : window_->isovaluePanel().findChildren<QScrollArea*>())
        EXPECT_FALSE(area->horizontalScrollBar()->isVisible());
    resizeTo(1400, 900);
    EXPECT_TRUE(child<QLabel>("requestedReadout")->isVisible());
}

TEST_F(WindowLayoutTest, NamesInTheTableOfLevelsAreShownWhole) {
    const auto source = io::openVolume(writeBall(folder_, "ball.mha", 40));
    ASSERT_TRUE(source.isOk());
    preprocess::BuildOptions options;
    options.kind = index::IndexKind::Metacells;
    ASSERT_TRUE(preprocess::buildIndex(*source.value(), folder_ / "ball.isx", options).isOk());
    window_->openFile(QString::fromStdString((folder_ / "ball.isx").string()));
    ASSERT_TRUE(waitUntilSettled());
    QTest::qWait(30);
    const auto* table = child<QTableView>("levelsTable");
    ASSERT_GT(table->model()->rowCount(), 3);
    for (int row = 0; row < table->model()->rowCount(); ++row) {
        const auto index = table->model()->index(row, 0);
        EXPECT_GE(table->visualRect(index).width(), table->sizeHintForIndex(index).width())
            << index.data().toString().toStdString();
    }
}

TEST_F(WindowLayoutTest, FactsAreReadWithTheirValues) {
    openBall();
    int facts = 0;
    for (const auto* form : window_->findChildren<widgets::FactForm*>())
        for (auto* label : form->findChildren<QLabel*>()) {
            if (label->isHidden() || label->accessibleName().isEmpty())
                continue;
            ++facts;
            auto* interface = QAccessible::queryAccessibleInterface(label);
            EXPECT_TRUE(interface->text(QAccessible::Name).contains(label->text())) << label->text().toStdString();
        }
    EXPECT_GT(facts, 10);
    for (const char* name : {"requestedReadout", "displayedReadout", "elapsedReadout"}) {
        auto* label = child<QLabel>(name);
        EXPECT_TRUE(QAccessible::queryAccessibleInterface(label)->text(QAccessible::Name).contains(label->text()))
            << name;
    }
}

// The value that the menu was asked for on, what is selected of it, or all facts of the form.
TEST_F(WindowLayoutTest, FactsAreCopiedByTheirMenu) {
    openBall();
    auto* dock = child<QDockWidget>("datasetDock");
    dock->show();
    dock->raise();
    auto* form = dock->findChild<widgets::FactForm*>();
    ASSERT_TRUE(waitUntil([&] { return form->isVisible(); }));
    QTest::qWait(30);
    std::vector<QLabel*> values;
    for (auto* label : form->findChildren<QLabel*>())
        if (!label->isHidden() && !label->accessibleName().isEmpty())
            values.push_back(label);
    ASSERT_GT(values.size(), 4u);
    const auto choose = [](QLabel* value, const char* action) {
        const QPoint middle = value->rect().center();
        QContextMenuEvent event(QContextMenuEvent::Mouse, middle, value->mapToGlobal(middle));
        QApplication::sendEvent(value, &event);
        auto* menu = qobject_cast<QMenu*>(QApplication::activePopupWidget());
        ASSERT_NE(menu, nullptr);
        auto* found = menu->findChild<QAction*>(QLatin1String(action));
        ASSERT_NE(found, nullptr);
        QTest::mouseClick(menu, Qt::LeftButton, {}, menu->actionGeometry(found).center());
    };
    for (QLabel* value : {values.front(), values[3]}) {
        choose(value, "copyFact");
        EXPECT_EQ(QGuiApplication::clipboard()->text(), value->text());
    }
    values[3]->setSelection(0, 2);
    choose(values[3], "copyFact");
    EXPECT_EQ(QGuiApplication::clipboard()->text(), values[3]->text().left(2));
    choose(values.front(), "copyFacts");
    const QString all = QGuiApplication::clipboard()->text();
    EXPECT_EQ(all.count(QLatin1Char('\n')), static_cast<qsizetype>(values.size()));
    for (const QLabel* value : values)
        EXPECT_TRUE(all.contains(QLatin1Char('\t') + value->text() + QLatin1Char('\n')));
}

/// Facts as a folder of slices has them: longer than one line, and more than there were.
class LongFactsTest : public WindowLayoutTest {
protected:
    void SetUp() override {
        builder_->holds = true; // nothing that follows lays the facts out again
        volumes_.open = [](const std::filesystem::path& path, const io::ReadOptions& options) {
            auto source = io::openVolume(path, options);
            if (!source.isOk() || path.filename() != "long.mha")
                return source;
            io::VolumeInfo info = source.value()->info();
            info.fieldTitle = "STD BRAIN 1MM, iDose, CT, 140 axial slices of 512 x 512, 2015-02-06, of a phantom";
            info.notes = {
                "140 slices in the order of their positions, spacing from these, which differ by 0.01 mm at most",
                "slope and intercept applied, as the files say; rescaled values are stored as 16 bits"};
            auto grid = io::readVolume(*source.value(), path, JobControl());
            return Result<std::unique_ptr<io::VolumeSource>>(
                io::makeMemorySource(std::move(grid).value(), std::move(info)));
        };
        makeWindow();
    }
    void open(const char* name) {
        window_->openFile(QString::fromStdString(writeBall(folder_, name, 24).string()));
        ASSERT_TRUE(waitUntil([&] { return session_->dataset() != nullptr && session_->dataset()->name == name; }));
    }
    struct Fact {
        widgets::FactForm* form;
        QLabel* label;
        int neededHeight;
        bool isWhole() const { return label->height() >= neededHeight && form->rect().contains(label->geometry()); }
    };
    std::vector<Fact> facts() {
        std::vector<Fact> all;
        for (auto* form : child<QDockWidget>("datasetDock")->findChildren<widgets::FactForm*>())
            for (auto* label : form->findChildren<QLabel*>())
                if (!label->isHidden() && !label->text().isEmpty())
                    all.push_back(
                        {form, label,
                         label->wordWrap() ? label->heightForWidth(label->width()) : label->sizeHint().height()});
        return all;
    }
    void expectWholeFacts() {
        QTest::qWait(50);
        // The layout follows, later on a machine that is busy.
        (void)waitUntil(
            [this] {
                const auto all = facts();
                return std::all_of(all.begin(), all.end(), [](const Fact& fact) { return fact.isWhole(); });
            },
            std::chrono::seconds(2));
        int lines = 0;
        for (const auto& fact : facts()) {
            EXPECT_TRUE(fact.isWhole()) << fact.label->height() << " of " << fact.neededHeight << ": "
                                        << fact.label->text().toStdString();
            lines += fact.label->wordWrap() && fact.neededHeight > 2 * fact.label->fontMetrics().height() - 4 ? 1 : 0;
        }
        EXPECT_GE(lines, 3);
    }
};

TEST_F(LongFactsTest, AreShownWholeAtOnce) {
    open("long.mha");
    expectWholeFacts();
}

TEST_F(LongFactsTest, AreShownWholeAfterShortOnes) {
    open("short.mha");
    QTest::qWait(50);
    open("long.mha");
    expectWholeFacts();
}

TEST_F(LongFactsTest, AreShownWholeInPanelsOfManySizes) {
    for (const int width : {270, 310, 347, 354, 361, 396, 424, 438})
        for (const int height : {420, 520}) {
            SCOPED_TRACE(width);
            makeWindow();
            auto* dock = child<QDockWidget>("datasetDock");
            dock->setFixedSize(width, height);
            QTest::qWait(30);
            open("long.mha");
            expectWholeFacts();
        }
}

/// Assistive technology that looks at whatever it hears of, before the first window is there.
class Assistance {
protected:
    Assistance() {
        QAccessible::setActive(true);
        QAccessible::installUpdateHandler([](QAccessibleEvent* event) { (void)event->accessibleInterface(); });
    }
    ~Assistance() {
        QAccessible::installUpdateHandler(nullptr);
        QAccessible::setActive(false);
    }
};

class AssistedWindowTest : private Assistance, public WindowLayoutTest {};

TEST_F(AssistedWindowTest, TheHistogramIsASlider) {
    openBall();
    auto& plot = window_->isovaluePanel().plot();
    auto* interface = QAccessible::queryAccessibleInterface(&plot);
    ASSERT_NE(interface, nullptr);
    EXPECT_EQ(interface->role(), QAccessible::Slider);
    ASSERT_NE(interface->valueInterface(), nullptr);
    EXPECT_EQ(interface->valueInterface()->currentValue().toDouble(), session_->isovalue().requested());
    interface->valueInterface()->setCurrentValue(-6.25);
    EXPECT_EQ(session_->isovalue().requested(), -6.25);
}

// What the first histogram of a program installs is there for all that follow: only a program that begins shows it.
TEST(AssistedProgram, TheHistogramOfItsFirstWindowIsASlider) {
    const auto program = std::filesystem::read_symlink("/proc/self/exe").string();
    const auto result = runProcess(program, {"--gtest_filter=AssistedWindowTest.*"}, {});
    EXPECT_EQ(result.exitCode, 0) << result.standardOutput << result.standardError;
}

/// Colours as the system may give them: all that is needed for reading, and nothing else.
QPalette systemPalette(QColor window, QColor base, QColor text) {
    QPalette palette;
    for (const auto role : {QPalette::Window, QPalette::Button})
        palette.setColor(role, window);
    for (const auto role : {QPalette::Base, QPalette::AlternateBase})
        palette.setColor(role, base);
    for (const auto role : {QPalette::WindowText, QPalette::Text, QPalette::ButtonText, QPalette::BrightText})
        palette.setColor(role, text);
    return palette;
}

class PaletteTest : public WindowLayoutTest {
protected:
    void SetUp() override {
        style_ = QApplication::style()->objectName();
        QApplication::setStyle(QStyleFactory::create(QStringLiteral("Fusion")));
    }
    void TearDown() override {
        QApplication::setPalette(QPalette());
        QApplication::setStyle(QStyleFactory::create(style_));
    }
    /// The colour behind a label: of the nearest widget that fills its background.
    static QColor backgroundOf(const QLabel& label) {
        const QWidget* widget = &label;
        while (!widget->isWindow() && !widget->autoFillBackground())
            widget = widget->parentWidget();
        return widget->palette().color(QPalette::Window);
    }
    void expectReadableLabels(const char* when) {
        int seen = 0;
        for (const auto* label : window_->findChildren<QLabel*>()) {
            if (label->text().isEmpty() || !label->isEnabled() || !label->styleSheet().isEmpty())
                continue;
            ++seen;
            EXPECT_GE(widgets::contrastOf(label->palette().color(label->foregroundRole()), backgroundOf(*label)), 4.5)
                << when << ": " << label->text().toStdString();
        }
        EXPECT_GT(seen, 20);
    }

    QString style_;
};

TEST_F(PaletteTest, EveryLabelCanBeReadInADarkAndALightOne) {
    const QPalette dark = systemPalette(QColor(49, 54, 59), QColor(35, 38, 41), QColor(239, 240, 241));
    const QPalette light = systemPalette(QColor(239, 240, 241), QColor(252, 252, 252), QColor(35, 38, 39));
    expectReadableLabels("as it is");
    QApplication::setPalette(dark);
    makeWindow();
    expectReadableLabels("dark from the start");
    openBall();
    trigger("mesh.check");
    ASSERT_TRUE(waitUntilSettled());
    expectReadableLabels("dark with a volume");
    keepPicture(*window_, "palette_dark");
    QApplication::setPalette(light);
    QTest::qWait(20);
    expectReadableLabels("changed to light");
    QApplication::setPalette(dark);
    QTest::qWait(20);
    window_->openFile(QStringLiteral("/none.mha"));
    ASSERT_TRUE(waitUntil([this] { return window_->messageBar().isVisible(); }));
    expectReadableLabels("changed to dark");
}

TEST(TextColour, IsQuietButReadable) {
    EXPECT_NEAR(widgets::contrastOf(Qt::black, Qt::white), 21.0, 1e-6);
    EXPECT_NEAR(widgets::contrastOf(QColor(0, 0, 0, 0), Qt::white), 1.0, 1e-3);
    for (const int text : {0, 40, 90, 235, 255})
        for (const int back : {0, 30, 60, 200, 255}) {
            QPalette palette;
            palette.setColor(QPalette::WindowText, QColor(text, text, text));
            palette.setColor(QPalette::Window, QColor(back, back, back));
            const double most = widgets::contrastOf(QColor(text, text, text), QColor(back, back, back));
            const double quiet = widgets::contrastOf(widgets::quietTextColour(palette), QColor(back, back, back));
            EXPECT_GE(quiet, std::min(most, 4.5)) << text << " on " << back;
            EXPECT_LE(quiet, most + 1e-9);
        }
}

} // namespace
} // namespace isoslider::test
