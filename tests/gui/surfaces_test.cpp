// Several surfaces of one volume in the window: by keys, in the list, on the histogram; undone, saved, drawn.
#include <cmath>
#include <ostream>
#include <set>

#include <QAbstractItemModelTester>
#include <QAction>
#include <QClipboard>
#include <QColorDialog>
#include <QDockWidget>
#include <QKeySequence>
#include <QLineEdit>
#include <QMenu>
#include <QMouseEvent>
#include <QSlider>
#include <QTableView>
#include <QTest>

#include "tests/gui/window_fixture.h"
#include "ui/model/session/saved_session.h"
#include "ui/widgets/isovalue/histogram_plot.h"
#include "ui/widgets/isovalue/isovalue_panel.h"
#include "ui/widgets/isovalue/surface_bars.h"
#include "ui/widgets/panels/surface_table.h"
#include "ui/widgets/panels/surfaces_panel.h"
#include "ui/widgets/viewport/viewport_host.h"
#include "ui/widgets/viewport/viewport_widget.h"
#include "ui/widgets/window/action_registry.h"
#include "ui/widgets/window/message_bar.h"
#include "ui/widgets/window/session_keeper.h"

namespace isoslider::model {

void PrintTo(const SurfaceList& list, std::ostream* out) {
    for (const ListedSurface& surface : list.surfaces)
        *out << (surface.id == list.active ? " *" : " ") << static_cast<std::uint32_t>(surface.id) << ' '
             << surface.name << " at " << surface.isovalue << ", " << surface.opacity
             << (surface.isVisible ? ";" : ", hidden;");
}

} // namespace isoslider::model

namespace isoslider::test {
namespace {

using model::ListedSurface;
using widgets::SurfaceTable;

class SurfacesTest : public WindowTest {
protected:
    void open() {
        openBall(32);
        window_->resize(1400, 900);
        child<QDockWidget>("surfacesDock")->raise();
        session_->isovalue().request(-12.0);
        settle();
        letStepEnd();
    }
    void settle() { ASSERT_TRUE(waitUntilSettled()); }
    /// What follows is another step of undo.
    static void letStepEnd() { QTest::qWait(600); }
    void addAt(double isovalue) {
        QTest::keyClick(window_.get(), Qt::Key_Insert);
        session_->isovalue().request(isovalue);
        settle();
        letStepEnd();
    }
    model::SurfacesModel& surfaces() { return session_->surfaces(); }
    const std::vector<ListedSurface>& all() { return surfaces().list().surfaces; }
    QTableView* table() { return child<QTableView>("surfaceTable"); }
    /// The editor that opens; null: none.
    QLineEdit* renameByKey() {
        QTest::keyClick(window_.get(), Qt::Key_F2);
        for (auto* editor : table()->findChildren<QLineEdit*>())
            if (!editor->isHidden()) // as those are that wait to be deleted
                return editor;
        return nullptr;
    }
    QModelIndex cell(int row, int column) { return table()->model()->index(row, column); }
    QPoint middleOf(int row, int column) { return table()->visualRect(cell(row, column)).center(); }
    void clickCell(int row, int column) {
        QTest::mouseClick(table()->viewport(), Qt::LeftButton, {}, middleOf(row, column));
    }
    void type(int row, int column, const QString& text) {
        clickCell(row, column); // that of QTest is the second press alone
        doubleClick(*table()->viewport(), Qt::LeftButton, {}, middleOf(row, column));
        QTest::mouseRelease(table()->viewport(), Qt::LeftButton, {}, middleOf(row, column));
        auto* editor = table()->findChild<QLineEdit*>();
        ASSERT_NE(editor, nullptr);
        editor->selectAll();
        QTest::keyClicks(editor, text);
        QTest::keyClick(editor, Qt::Key_Return);
        QTest::qWait(20); // the editor goes
    }
    widgets::HistogramPlot& plot() { return window_->isovaluePanel().plot(); }
    widgets::SurfaceBars& bars() { return *plot().findChild<widgets::SurfaceBars*>(); }
    static void moveTo(QWidget& widget, QPoint place, Qt::MouseButtons buttons) {
        QMouseEvent move(QEvent::MouseMove, place, widget.mapToGlobal(QPointF(place)), Qt::NoButton, buttons,
                         Qt::NoModifier);
        QApplication::sendEvent(&widget, &move);
    }
    void undo() { QTest::keyClick(window_.get(), Qt::Key_Z, Qt::ControlModifier); }
    void redo() { QTest::keyClick(window_.get(), Qt::Key_Z, Qt::ControlModifier | Qt::ShiftModifier); }
};

TEST_F(SurfacesTest, KeysAddRemoveAndStepThroughThem) {
    open();
    EXPECT_FALSE(window_->actions().action("surfaces.remove")->isEnabled());
    addAt(-6.0);
    ASSERT_EQ(all().size(), 2u);
    EXPECT_EQ(all()[0].isovalue, -12.0);
    EXPECT_EQ(all()[1].isovalue, -6.0);
    QTest::keyClick(window_.get(), Qt::Key_N);
    EXPECT_EQ(surfaces().active(), &all()[0]);
    EXPECT_EQ(session_->isovalue().requested(), -12.0);
    QTest::keyClick(window_.get(), Qt::Key_N, Qt::ShiftModifier);
    EXPECT_EQ(surfaces().active(), &all()[1]);
    QTest::keyClick(window_.get(), Qt::Key_S);
    EXPECT_FALSE(all()[1].isVisible);
    EXPECT_FALSE(window_->actions().action("surfaces.show")->isChecked());
    QTest::keyClick(window_.get(), Qt::Key_Delete, Qt::ShiftModifier);
    ASSERT_EQ(all().size(), 1u);
    EXPECT_EQ(session_->isovalue().requested(), -12.0);
    EXPECT_TRUE(window_->actions().action("surfaces.show")->isChecked());
    settle();
    EXPECT_EQ(session_->frame()->isovalue, -12.0);
}

TEST_F(SurfacesTest, KeysChangeTheOpacityOfTheActiveOne) {
    open();
    EXPECT_FALSE(window_->actions().action("surfaces.moreOpaque")->isEnabled());
    QTest::keyClick(window_.get(), Qt::Key_U);
    QTest::keyClick(window_.get(), Qt::Key_U);
    EXPECT_EQ(all()[0].opacity, 0.8);
    letStepEnd();
    QTest::keyClick(window_.get(), Qt::Key_U, Qt::ShiftModifier);
    EXPECT_EQ(all()[0].opacity, 0.9);
    letStepEnd();
    undo();
    EXPECT_EQ(all()[0].opacity, 0.8);
    undo();
    EXPECT_EQ(all()[0].opacity, 1.0);
}

TEST_F(SurfacesTest, TheListShowsHidesNamesAndActivates) {
    open();
    addAt(-6.0);
    const QAbstractItemModelTester tester(table()->model(), QAbstractItemModelTester::FailureReportingMode::Fatal);
    ASSERT_EQ(table()->model()->rowCount(), 2);
    EXPECT_EQ(table()->currentIndex().row(), 1);
    QTest::keyClick(table(), Qt::Key_Home); // moves the cursor, not the handle
    EXPECT_EQ(surfaces().active(), &all()[1]);
    clickCell(0, SurfaceTable::Name);
    EXPECT_EQ(surfaces().active(), &all()[0]);
    EXPECT_EQ(session_->isovalue().requested(), -12.0);
    // The box is at the left of its cell.
    const QRect box = table()->visualRect(cell(1, SurfaceTable::Shown));
    QTest::mouseClick(table()->viewport(), Qt::LeftButton, {}, QPoint(box.left() + 10, box.center().y()));
    EXPECT_FALSE(all()[1].isVisible);
    EXPECT_EQ(surfaces().active(), &all()[0]) << "showing and hiding makes nothing active";
    type(0, SurfaceTable::Name, QStringLiteral("Skin"));
    EXPECT_EQ(all()[0].name, "Skin");
    type(1, SurfaceTable::Opacity, QStringLiteral("35"));
    EXPECT_EQ(all()[1].opacity, 0.35);
    type(1, SurfaceTable::Opacity, QStringLiteral("0"));
    EXPECT_EQ(all()[1].opacity, model::kLeastOpacity);
    type(1, SurfaceTable::Isovalue, QStringLiteral("-7,5"));
    EXPECT_EQ(all()[1].isovalue, -7.5);
    type(1, SurfaceTable::Isovalue, QStringLiteral("soft"));
    EXPECT_EQ(all()[1].isovalue, -7.5);
    type(1, SurfaceTable::Isovalue, QStringLiteral("-1 sigma"));
    const ValueSpread spread = session_->dataset()->values->spread;
    EXPECT_EQ(all()[1].isovalue, spread.mean - spread.deviation);
    settle();
    EXPECT_EQ(session_->pictureOf(all()[1].id) == nullptr, false);
    keepPicture(*window_, "surfaces_list");
}

// Qt asks for the text of what is current, even where nothing is.
TEST_F(SurfacesTest, CopyingWithoutARowSaysNothing) {
    table()->selectionModel()->clearCurrentIndex();
    ASSERT_FALSE(table()->currentIndex().isValid());
    table()->setFocus();
    QTest::keyClick(table(), Qt::Key_Insert, Qt::ControlModifier); // a warning of Qt fails every test
}

TEST_F(SurfacesTest, TheListIsCopiedAsATable) {
    open();
    addAt(-6.0);
    ASSERT_EQ(table()->contextMenuPolicy(), Qt::ActionsContextMenu);
    const auto copied = [] { return QGuiApplication::clipboard()->text().toStdString(); };
    const std::string headings = "Surface\tIsovalue\tOpacity\n";
    const std::string first = "Surface 1\t-12\t100 %\n", second = "Surface 2\t-6\t40 %\n";
    clickCell(1, SurfaceTable::Name);
    QTest::keyClick(table(), Qt::Key_C, Qt::ControlModifier);
    EXPECT_EQ(copied(), headings + second) << "boxes are no text";
    table()->findChild<QAction*>(QStringLiteral("copyAllRows"))->trigger();
    EXPECT_EQ(copied(), headings + first + second);
}

TEST_F(SurfacesTest, EachEntryOfTheListsMenuHasALetterOfItsOwn) {
    std::set<QString> letters;
    for (const QAction* action : table()->actions()) {
        if (action->isSeparator())
            continue;
        const QString letter = QKeySequence::mnemonic(action->text()).toString();
        EXPECT_FALSE(letter.isEmpty()) << action->text().toStdString();
        EXPECT_TRUE(letters.insert(letter).second) << action->text().toStdString();
    }
    EXPECT_GE(letters.size(), 4u);
}

// Qt has something to say of editors that are gone, and what Qt says is a failure.
TEST_F(SurfacesTest, ANameThatIsEnteredWhileTheListChangesIsLostQuietly) {
    open();
    addAt(-6.0);
    QLineEdit* editor = renameByKey();
    ASSERT_NE(editor, nullptr);
    editor->setText(QStringLiteral("Bone"));
    QTest::keyClick(editor, Qt::Key_Return);
    surfaces().add(-3.0); // before Qt tells the list about the key
    QCoreApplication::processEvents();
    for (const auto& surface : all())
        EXPECT_NE(surface.name, "Bone");
    EXPECT_NE(renameByKey(), nullptr) << "the next one opens";
}

TEST_F(SurfacesTest, F2RenamesAndColourAndOpacityAreOfTheActiveOne) {
    open();
    addAt(-6.0);
    QLineEdit* editor = renameByKey();
    ASSERT_NE(editor, nullptr);
    editor->selectAll();
    QTest::keyClicks(editor, QStringLiteral("Bone"));
    QTest::keyClick(editor, Qt::Key_Return);
    ASSERT_TRUE(waitUntil([this] { return all()[1].name == "Bone"; }));
    auto* opacity = child<QSlider>("surfaceOpacity");
    surfaces().change(all()[0].id, [](ListedSurface& surface) { surface.opacity = 1.0; });
    const double opacityBefore = all()[1].opacity;
    QTest::keyClick(opacity, Qt::Key_PageDown);
    EXPECT_NEAR(all()[1].opacity, opacityBefore - 0.1, 1e-9);
    EXPECT_EQ(all()[0].opacity, 1.0);
    auto* panel = window_->findChild<widgets::SurfacesPanel*>();
    panel->colourMenu()->actions().at(3)->trigger();
    EXPECT_EQ(all()[1].colour, model::kSurfaceColours[3].colour);
    panel->colourMenu()->actions().last()->trigger();
    auto* dialog = child<QColorDialog>("surfaceColourDialog");
    ASSERT_NE(dialog, nullptr);
    dialog->setCurrentColor(QColor(1, 2, 3));
    dialog->accept();
    EXPECT_EQ(all()[1].colour, (model::SurfaceColour{1, 2, 3}));
}

TEST_F(SurfacesTest, ABarOnTheHistogramIsTakenAndDragged) {
    open();
    addAt(-6.0);
    const auto first = all()[0].id;
    ASSERT_TRUE(bars().gripOf(first));
    EXPECT_FALSE(bars().gripOf(all()[1].id)) << "the active one has the handle";
    const QPoint grip = bars().gripOf(first)->toPoint();
    EXPECT_NEAR(plot().valueAtPixel(grip.x()), -12.0, plot().resolutionAt(-12.0) * 2.0);
    EXPECT_TRUE(bars().tipAt(grip).contains(QStringLiteral("-12"))) << bars().tipAt(grip).toStdString();
    const int y = plot().axisRect()->center().y(), x = grip.x();
    // Apart from a bar, the active surface's handle comes to the pointer.
    QTest::mouseClick(&plot(), Qt::LeftButton, {}, QPoint(x + 30, y));
    EXPECT_EQ(surfaces().active(), &all()[1]);
    EXPECT_NEAR(all()[1].isovalue, plot().valueAtPixel(x + 30), 2.0 * plot().resolutionAt(-10.0));
    letStepEnd();
    QTest::mousePress(&plot(), Qt::LeftButton, {}, QPoint(x + 2, y));
    EXPECT_EQ(surfaces().active(), &all()[0]);
    EXPECT_EQ(session_->isovalue().requested(), -12.0) << "what is taken stays where it is";
    for (int step = 1; step <= 4; ++step) {
        moveTo(plot(), QPoint(x + 2 + 15 * step, y), Qt::LeftButton);
        QTest::qWait(120);
    }
    QTest::mouseRelease(&plot(), Qt::LeftButton, {}, QPoint(x + 62, y));
    const double dragged = all()[0].isovalue;
    EXPECT_NEAR(dragged, plot().valueAtPixel(x + 60), 3.0 * plot().resolutionAt(-10.0));
    settle();
    EXPECT_EQ(session_->frame()->isovalue, dragged);
    letStepEnd();
    undo(); // the drag, however long
    EXPECT_EQ(all()[0].isovalue, -12.0);
    EXPECT_EQ(surfaces().active(), &all()[0]);
    undo();
    EXPECT_EQ(surfaces().active(), &all()[1]);
}

TEST_F(SurfacesTest, UndoAndRedoRestoreTheSceneExactly) {
    open();
    std::vector<model::SurfaceList> scenes{surfaces().list()};
    const auto note = [&] {
        settle();
        letStepEnd();
        scenes.push_back(surfaces().list());
        ASSERT_NE(scenes.back(), scenes[scenes.size() - 2]);
    };
    QTest::keyClick(window_.get(), Qt::Key_Insert);
    note();
    session_->isovalue().request(-5.5);
    note();
    type(1, SurfaceTable::Name, QStringLiteral("Core"));
    note();
    QTest::keyClick(child<QSlider>("surfaceOpacity"), Qt::Key_PageDown);
    note();
    QTest::keyClick(window_.get(), Qt::Key_S);
    note();
    QTest::keyClick(window_.get(), Qt::Key_N);
    note();
    QTest::keyClick(window_.get(), Qt::Key_Insert);
    note();
    QTest::keyClick(window_.get(), Qt::Key_N);
    note();
    QTest::keyClick(window_.get(), Qt::Key_Delete, Qt::ShiftModifier);
    note();
    for (std::size_t i = scenes.size() - 1; i-- > 0;) {
        undo();
        EXPECT_EQ(surfaces().list(), scenes[i]) << i;
        EXPECT_EQ(session_->isovalue().requested(), surfaces().active()->isovalue) << i;
    }
    for (std::size_t i = 1; i < scenes.size(); ++i) {
        redo();
        EXPECT_EQ(surfaces().list(), scenes[i]) << i;
    }
    settle();
    for (const ListedSurface& surface : all())
        if (surface.isVisible) {
            ASSERT_NE(session_->pictureOf(surface.id), nullptr) << surface.name;
            EXPECT_EQ(session_->pictureOf(surface.id)->isovalue, surface.isovalue);
        }
}

TEST_F(SurfacesTest, WhatFollowsAtOnceIsAStepOfItsOwn) {
    open();
    session_->isovalue().request(-9.0);
    QTest::keyClick(window_.get(), Qt::Key_Insert);
    QTest::keyClick(window_.get(), Qt::Key_Insert);
    ASSERT_EQ(all().size(), 3u);
    const double added = all()[2].isovalue;
    session_->isovalue().request(-3.25);
    undo();
    ASSERT_EQ(all().size(), 3u) << "what it slid since is a step for itself";
    EXPECT_EQ(all()[2].isovalue, added);
    undo();
    EXPECT_EQ(all().size(), 2u);
    undo();
    ASSERT_EQ(all().size(), 1u);
    EXPECT_EQ(all()[0].isovalue, -9.0);
    undo();
    EXPECT_EQ(all()[0].isovalue, -12.0);
}

TEST_F(SurfacesTest, ASessionKeepsThem) {
    open();
    addAt(-6.0);
    type(0, SurfaceTable::Name, QStringLiteral("Skin")); // active from the first click on
    surfaces().change(all()[1].id, [](ListedSurface& surface) { surface.colour = {10, 20, 30}; });
    settle();
    const auto before = all();
    const auto path = folder_ / "two.isosession";
    dialogs_.answers.push_back(QString::fromStdString(path.string()));
    trigger("file.saveSession");
    ASSERT_TRUE(waitUntil([this] { return window_->messageBar().isVisible(); }));
    trigger("file.close");
    EXPECT_EQ(table()->model()->rowCount(), 0);
    drop(path);
    ASSERT_TRUE(waitUntil([this] { return session_->frame() != nullptr && session_->isSettled(); }));
    ASSERT_EQ(all().size(), 2u);
    for (std::size_t i = 0; i < 2; ++i) {
        ListedSurface surface = all()[i];
        surface.id = before[i].id;
        EXPECT_EQ(surface, before[i]);
    }
    EXPECT_EQ(surfaces().active(), &all()[0]);
    EXPECT_EQ(session_->isovalue().requested(), -12.0);
    ASSERT_NE(session_->pictureOf(all()[1].id), nullptr);
    EXPECT_EQ(session_->pictureOf(all()[1].id)->isovalue, -6.0);
    letStepEnd();
    EXPECT_FALSE(window_->actions().action("edit.undo")->isEnabled()) << "opening is no step";
}

TEST_F(SurfacesTest, TheActiveOneIsExportedAndTheDialogNamesIt) {
    open();
    addAt(-6.0);
    const auto path = folder_ / "active.ply";
    dialogs_.answers.push_back(QString::fromStdString(path.string()));
    trigger("mesh.export");
    EXPECT_TRUE(dialogs_.asked.title.contains(QStringLiteral("Surface 2"))) << dialogs_.asked.title.toStdString();
    ASSERT_TRUE(waitUntil([this] { return session_->certificate().has_value(); }));
    EXPECT_EQ(session_->certificate()->report.triangles, session_->frame()->stats.triangles);
}

TEST_F(SurfacesTest, SavedPicturesShowAllOfThemThroughEachOther) {
    open();
    auto* viewport = window_->viewportHost().viewport();
    if (viewport == nullptr)
        GTEST_SKIP() << "no OpenGL 3.3 here";
    const QImage one = window_->viewportHost().picture();
    addAt(-6.0);
    surfaces().change(all()[0].id, [](ListedSurface& surface) { surface.opacity = 0.4; });
    surfaces().change(all()[1].id, [](ListedSurface& surface) {
        surface.colour = {40, 90, 250};
        surface.opacity = 1.0;
    });
    const QImage two = window_->viewportHost().picture();
    const auto blueness = [](const QImage& image) {
        const QColor middle = image.pixelColor(image.width() / 2, image.height() / 2);
        return middle.blue() - middle.red();
    };
    EXPECT_LT(blueness(one), 0);
    EXPECT_GT(blueness(two), 20) << "the inner one through the outer one";
    surfaces().change(all()[0].id, [](ListedSurface& surface) { surface.opacity = 1.0; });
    EXPECT_LT(blueness(window_->viewportHost().picture()), 0) << "it is hidden now";
    surfaces().change(all()[0].id, [](ListedSurface& surface) { surface.isVisible = false; });
    EXPECT_GT(blueness(window_->viewportHost().picture()), 60);
    keepPicture(*window_, "surfaces_inner");
}

TEST_F(SurfacesTest, InactiveOnesAreNotSentAgainWhileTheHandleMovesAndComeBackWithANewContext) {
    open();
    auto* viewport = window_->viewportHost().viewport();
    if (viewport == nullptr)
        GTEST_SKIP() << "no OpenGL 3.3 here";
    addAt(-3.0); // a small one beside a large one that stays
    (void)viewport->grabFramebuffer();
    const auto before = viewport->uploadedBytes();
    const auto bytes = extract::pictureBytes(*session_->pictureOf(all()[0].id));
    for (const double isovalue : {-3.1, -3.2, -3.3, -3.4}) {
        session_->isovalue().request(isovalue);
        settle();
        (void)viewport->grabFramebuffer();
    }
    EXPECT_LT(viewport->uploadedBytes() - before, bytes);
    const QImage picture = viewport->grabFramebuffer();
    viewport->setDriver(std::make_shared<render::GlDriver>()); // all is gone
    ASSERT_TRUE(waitUntil([&] { return viewport->context() != nullptr; }));
    EXPECT_EQ(viewport->grabFramebuffer(), picture);
}

} // namespace
} // namespace isoslider::test
