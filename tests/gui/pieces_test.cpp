// Pieces of the surface in the window: counted and listed, in colours, the small ones hidden.
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>

#include <QAbstractItemModelTester>
#include <QAction>
#include <QDockWidget>
#include <QLabel>
#include <QMenu>
#include <QSlider>
#include <QSpinBox>
#include <QTableView>
#include <QTest>

#include "core/extract/pieces/surface_pieces.h"
#include "tests/gui/float_volume.h"
#include "tests/gui/window_fixture.h"
#include "ui/model/slices/slice_model.h"
#include "ui/model/surface/view_state.h"
#include "ui/render/scene_renderer.h"
#include "ui/widgets/common/small_widgets.h"
#include "ui/widgets/panels/piece_table.h"
#include "ui/widgets/viewport/viewport_host.h"
#include "ui/widgets/viewport/viewport_widget.h"
#include "ui/widgets/window/action_registry.h"

namespace isoslider::test {
namespace {

/// Three cones along x; the surface at 1.5 is three pieces, 9, 5 and 3 long or so.
std::filesystem::path writeSeparateCones(const TemporaryFolder& folder) {
    return writeFloats(folder, "cones.mha", {40, 20, 20}, [](int x, int y, int z) {
        float value = -30.0f;
        for (int cone = 0; cone < 3; ++cone)
            value = std::max(value, 6.0f - 1.5f * static_cast<float>(cone) -
                                        std::hypot(static_cast<float>(x) - 7.0f - 12.5f * static_cast<float>(cone),
                                                   static_cast<float>(y) - 10.0f, static_cast<float>(z) - 10.0f));
        return value;
    });
}

class PiecesTest : public WindowTest {
protected:
    void open() {
        window_->openFile(QString::fromStdString(writeSeparateCones(folder_).string()));
        ASSERT_TRUE(waitUntil([this] { return session_->frame() != nullptr; }));
        ASSERT_TRUE(waitUntilSettled());
        slideTo(1.5);
    }
    void slideTo(double isovalue) {
        ASSERT_TRUE(session_->isovalue().request(isovalue));
        ASSERT_TRUE(waitUntil([&] { return session_->frame()->isovalue == isovalue; }));
    }
    void showPanel() {
        child<QDockWidget>("piecesDock")->raise();
        ASSERT_TRUE(waitUntil([this] { return session_->frame()->pieces != nullptr; }));
        ASSERT_TRUE(waitUntil([this] { return table()->model()->rowCount() == 3; }));
    }
    QTableView* table() { return child<QTableView>("pieceTable"); }
    QSlider* size() { return child<QSlider>("pieceSize"); }
    QString count() { return child<widgets::ElidedLabel>("pieceCount")->fullText(); }
    model::ViewState& view() { return window_->viewportHost().viewState(); }
};

TEST_F(PiecesTest, AreFoundOnlyWhileSomebodyLooks) {
    open();
    EXPECT_EQ(session_->frame()->pieces, nullptr);
    showPanel();
    EXPECT_TRUE(waitUntil([this] { return count() == QStringLiteral("3 pieces"); })) << count().toStdString();
    ASSERT_EQ(table()->model()->rowCount(), 3);
    child<QDockWidget>("levelsDock")->raise();
    slideTo(1.4);
    EXPECT_EQ(session_->frame()->pieces, nullptr);
}

TEST_F(PiecesTest, AllHiddenIsSaidOnTheView) {
    open();
    const auto* note = child<QLabel>("hiddenPiecesNote");
    auto options = view().options();
    options.pieces.leastSize = 7.0; // the largest is about 9 long
    view().setOptions(options);
    ASSERT_TRUE(waitUntil([this] { return session_->frame()->pieces != nullptr; }));
    EXPECT_FALSE(note->isVisible());
    options.pieces.leastSize = 20.0;
    view().setOptions(options);
    EXPECT_TRUE(waitUntil([&] { return note->isVisible(); }));
    EXPECT_TRUE(note->text().contains(QStringLiteral("Ctrl+Shift+H"))) << note->text().toStdString();
    keepPicture(*window_, "all_pieces_hidden");
    QTest::keyClick(window_.get(), Qt::Key_H, Qt::ControlModifier | Qt::ShiftModifier);
    EXPECT_TRUE(waitUntil([&] { return !note->isVisible(); }));
    EXPECT_FALSE(view().options().pieces.hidesAny());
}

TEST_F(PiecesTest, AreListedTheLargestFirstAndFollowTheIsovalue) {
    open();
    showPanel();
    const QAbstractItemModelTester tester(table()->model(), QAbstractItemModelTester::FailureReportingMode::Fatal);
    const auto trianglesOf = [this](int row) {
        return table()
            ->model()
            ->index(row, widgets::PieceTable::Triangles)
            .data()
            .toString()
            .remove(QLatin1Char(','))
            .toInt();
    };
    EXPECT_GT(trianglesOf(0), trianglesOf(1));
    EXPECT_GT(trianglesOf(1), trianglesOf(2));
    slideTo(3.5);
    ASSERT_TRUE(waitUntil([this] { return table()->model()->rowCount() == 2; }));
    EXPECT_EQ(count(), QStringLiteral("2 pieces"));
    slideTo(1.5);
    ASSERT_TRUE(waitUntil([this] { return table()->model()->rowCount() == 3; }));
}

TEST_F(PiecesTest, SmallOnesAreHiddenByTheSlider) {
    open();
    showPanel();
    size()->setFocus();
    QTest::keyClick(size(), Qt::Key_End);
    EXPECT_EQ(view().options().pieces.leastSize, 39.0); // the volume's longest side
    EXPECT_EQ(count(), QStringLiteral("3 pieces, 3 hidden"));
    int steps = 0;
    while (count() != QStringLiteral("3 pieces, 2 hidden") && ++steps < 400)
        QTest::keyClick(size(), Qt::Key_Left);
    EXPECT_EQ(count(), QStringLiteral("3 pieces, 2 hidden"));
    EXPECT_GT(view().options().pieces.leastSize, 5.0);
    EXPECT_LT(view().options().pieces.leastSize, 12.0);
    EXPECT_EQ(table()->model()->index(2, 0).data(Qt::ToolTipRole).toString(), QStringLiteral("Hidden"));
    EXPECT_TRUE(table()->model()->index(0, 0).data(Qt::ToolTipRole).isNull());
    // Hidden pieces stay hidden when the panel is not looked at.
    child<QDockWidget>("levelsDock")->raise();
    slideTo(1.25);
    EXPECT_NE(session_->frame()->pieces, nullptr);
    child<QDockWidget>("piecesDock")->raise();
    size()->setFocus();
    QTest::keyClick(size(), Qt::Key_Home);
    EXPECT_EQ(view().options().pieces.leastSize, 0.0);
    EXPECT_EQ(count(), QStringLiteral("3 pieces"));
}

TEST_F(PiecesTest, ThoseThatLastShortlyAreHiddenByTheSlider) {
    open();
    showPanel();
    auto* persistence = child<QSlider>("piecePersistence");
    const auto* value = child<QLabel>("piecePersistenceValue");
    const auto known = [this] { return view().options().pieces.shortLived; };
    persistence->setFocus();
    QTest::keyClick(persistence, Qt::Key_End); // the range of the volume: the highest cone alone lasts as long
    EXPECT_GT(view().options().pieces.leastPersistence, 18.0);
    ASSERT_TRUE(waitUntil([this] { return count() == QStringLiteral("3 pieces, 2 hidden"); })) << count().toStdString();
    EXPECT_TRUE(table()->model()->index(0, 0).data(Qt::ToolTipRole).isNull());
    EXPECT_EQ(table()->model()->index(1, 0).data(Qt::ToolTipRole).toString(), QStringLiteral("Hidden"));
    EXPECT_TRUE(known()->isComplete);
    keepPicture(*window_, "short_lived_pieces_hidden");

    // Where cones meet, the lower one of a pair is 5.5 below its peak.
    int steps = 0;
    while (view().options().pieces.leastPersistence > 6.0 && ++steps < 400)
        QTest::keyClick(persistence, Qt::Key_Left);
    ASSERT_TRUE(waitUntil([&] { return known()->leastPersistence == view().options().pieces.leastPersistence; }));
    EXPECT_EQ(count(), QStringLiteral("3 pieces, 2 hidden"));
    EXPECT_FALSE(value->text().isEmpty());
    // They stay hidden while the surface moves; where it rests, the search runs again.
    slideTo(1.25);
    EXPECT_EQ(count(), QStringLiteral("3 pieces, 2 hidden"));
    ASSERT_TRUE(waitUntil([&] { return known()->isovalue == 1.25; }));
    slideTo(4.0);
    ASSERT_TRUE(waitUntil([&] { return known()->isovalue == 4.0; }));
    EXPECT_TRUE(waitUntil([this] { return count() == QStringLiteral("2 pieces, 1 hidden"); }));
    slideTo(1.25);
    EXPECT_TRUE(waitUntil([this] { return count() == QStringLiteral("3 pieces, 2 hidden"); }));

    steps = 0;
    while (view().options().pieces.leastPersistence > 4.0 && ++steps < 400)
        QTest::keyClick(persistence, Qt::Key_Left);
    EXPECT_TRUE(waitUntil([this] { return count() == QStringLiteral("3 pieces"); })) << count().toStdString();
    QTest::keyClick(persistence, Qt::Key_Home);
    EXPECT_EQ(view().options().pieces.leastPersistence, 0.0);
    EXPECT_EQ(value->text(), QStringLiteral("show all"));
    EXPECT_FALSE(view().options().pieces.hidesAny());

    // What is found is no separate step, and is not undone.
    QTest::keyClick(persistence, Qt::Key_End);
    ASSERT_TRUE(waitUntil([this] { return count() == QStringLiteral("3 pieces, 2 hidden"); }));
    auto* undo = window_->actions().action("edit.undo");
    undo->trigger();
    EXPECT_EQ(view().options().pieces.leastPersistence, 0.0);
    EXPECT_EQ(count(), QStringLiteral("3 pieces"));
    window_->actions().action("edit.redo")->trigger();
    EXPECT_TRUE(waitUntil([this] { return count() == QStringLiteral("3 pieces, 2 hidden"); }));
    QTest::qWait(600);
    EXPECT_FALSE(window_->actions().action("edit.redo")->isEnabled());
    undo->trigger();
    EXPECT_EQ(view().options().pieces.leastPersistence, 0.0) << "finding made a step";
}

TEST_F(PiecesTest, AreColouredByKeyAndTheListShowsTheColours) {
    open();
    QTest::keyClick(window_.get(), Qt::Key_P, Qt::ShiftModifier);
    EXPECT_TRUE(view().options().pieces.isColoured);
    ASSERT_TRUE(waitUntil([this] { return session_->frame()->pieces != nullptr; }));
    showPanel();
    const auto colourOf = [this](int row) {
        return table()->model()->index(row, 0).data(Qt::DecorationRole).value<QColor>();
    };
    EXPECT_NE(colourOf(0), colourOf(1));
    EXPECT_NE(colourOf(1), colourOf(2));
    const QColor second = colourOf(1);
    slideTo(1.0);
    EXPECT_EQ(colourOf(1), second);
    QTest::keyClick(window_.get(), Qt::Key_P, Qt::ShiftModifier);
    EXPECT_FALSE(view().options().pieces.isColoured);
}

class PickTest : public PiecesTest {
protected:
    void SetUp() override {
        if (window_->viewportHost().viewport() == nullptr)
            GTEST_SKIP() << "no OpenGL 3.3 here";
        open();
        session_->isovalue().request(1.5);
        QTest::keyClick(window_.get(), Qt::Key_1); // along y: the cones stand side by side
        ASSERT_TRUE(waitUntilSettled());
    }
    widgets::ViewportWidget& viewport() { return *window_->viewportHost().viewport(); }
    /// Where the middle of a cone is seen.
    QPoint pixelOf(int cone) {
        const glm::dvec3 at(7.0 + 12.5 * cone, 10.0, 10.0);
        const auto& frame = *session_->frame();
        const double aspect = static_cast<double>(viewport().width()) / viewport().height();
        const auto& camera = viewport().camera();
        const glm::dvec4 clip = camera.projectionMatrix(aspect) * camera.viewMatrix() *
                                render::indexToCentredWorld(frame.geometry, frame.geometry) * glm::dvec4(at, 1.0);
        return {static_cast<int>((1.0 + clip.x / clip.w) / 2.0 * viewport().width()),
                static_cast<int>((1.0 - clip.y / clip.w) / 2.0 * viewport().height())};
    }
    void pick(QPoint point) {
        doubleClick(viewport(), Qt::LeftButton, {}, point);
        ASSERT_TRUE(waitUntil([this] { return session_->frame()->pieces != nullptr; }));
    }
    const model::PieceOptions& pieces() { return view().options().pieces; }
    const extract::Piece& piece(std::size_t place) { return session_->frame()->pieces->pieces()[place]; }
    QAction* action(const char* name) { return window_->actions().action(name); }
};

TEST_F(PickTest, ADoubleClickSelectsThePieceBelowThePointer) {
    EXPECT_FALSE(action("pieces.hide")->isEnabled());
    for (const int cone : {0, 1, 2}) {
        pick(pixelOf(cone));
        ASSERT_TRUE(waitUntil([&] { return pieces().selected == piece(static_cast<std::size_t>(cone)).id; }))
            << cone; // the cones' sizes fall
    }
    EXPECT_TRUE(action("pieces.hide")->isEnabled());
    pick({4, 4});
    ASSERT_TRUE(waitUntil([&] { return !pieces().selected; })) << "nothing is there";
}

TEST_F(PickTest, AHiddenPieceIsSeenThroughAndComesBack) {
    pick(pixelOf(1));
    ASSERT_TRUE(waitUntil([&] { return pieces().selected.has_value(); }));
    const extract::PieceId second = *pieces().selected;
    QTest::keyClick(window_.get(), Qt::Key_H);
    EXPECT_EQ(pieces().hidden, std::vector{second});
    EXPECT_FALSE(pieces().selected);
    pick(pixelOf(1));
    EXPECT_FALSE(pieces().selected) << "there is nothing to be picked";
    slideTo(1.25); // it keeps its number, so it stays hidden
    showPanel();
    EXPECT_TRUE(waitUntil([this] { return count() == QStringLiteral("3 pieces, 1 hidden"); })) << count().toStdString();
    QTest::keyClick(window_.get(), Qt::Key_H, Qt::ControlModifier | Qt::ShiftModifier);
    EXPECT_TRUE(waitUntil([this] { return count() == QStringLiteral("3 pieces"); }));
    pick(pixelOf(1));
    EXPECT_TRUE(waitUntil([&] { return pieces().selected == second; }));
}

TEST_F(PickTest, OneIsShownAloneFromTheMenuOfTheView) {
    QTest::mouseClick(&viewport(), Qt::RightButton, {}, pixelOf(2));
    ASSERT_TRUE(waitUntil([] { return QApplication::activePopupWidget() != nullptr; }));
    auto* menu = qobject_cast<QMenu*>(QApplication::activePopupWidget());
    ASSERT_NE(menu, nullptr);
    ASSERT_TRUE(pieces().selected);
    const extract::PieceId third = *pieces().selected;
    EXPECT_EQ(third, piece(2).id);
    QTest::mouseClick(menu, Qt::LeftButton, {}, menu->actionGeometry(action("pieces.only")).center());
    ASSERT_TRUE(waitUntil([&] { return pieces().only == third; }));
    pick(pixelOf(0));
    EXPECT_FALSE(pieces().selected);
    pick(pixelOf(2));
    EXPECT_EQ(pieces().selected, third);
    // Another volume has other pieces.
    window_->openFile(QString::fromStdString(writeSeparateCones(folder_).string()));
    ASSERT_TRUE(waitUntilSettled());
    EXPECT_FALSE(pieces().only);
    EXPECT_FALSE(pieces().selected);
}

TEST_F(PickTest, TheMenuOfTheViewHidesSmallerOnesKeepsTheLargestAndUndoes) {
    pick(pixelOf(1));
    ASSERT_TRUE(waitUntil([&] { return pieces().selected.has_value(); }));
    QTest::qWait(600); // a step ends
    const auto choose = [&](QPoint place, const char* name) {
        QTest::mouseClick(&viewport(), Qt::RightButton, {}, place);
        ASSERT_TRUE(waitUntil([] { return QApplication::activePopupWidget() != nullptr; }));
        auto* menu = qobject_cast<QMenu*>(QApplication::activePopupWidget());
        ASSERT_NE(menu, nullptr);
        for (const char* entry :
             {"view.fit", "view.measure", "clip.plane", "clip.crop", "slices.isovalue", "edit.undo", "edit.redo"})
            EXPECT_TRUE(menu->actions().contains(action(entry))) << entry;
        keepPicture(*menu, "view_menu");
        QTest::mouseClick(menu, Qt::LeftButton, {}, menu->actionGeometry(action(name)).center());
        QTest::qWait(600);
    };
    showPanel();
    choose(pixelOf(1), "pieces.hideSmaller");
    EXPECT_TRUE(waitUntil([this] { return count() == QStringLiteral("3 pieces, 1 hidden"); })) << count().toStdString();
    choose(pixelOf(1), "pieces.largest");
    EXPECT_TRUE(waitUntil([this] { return count() == QStringLiteral("3 pieces, 2 hidden"); })) << count().toStdString();
    choose({4, 4}, "edit.undo");
    EXPECT_EQ(pieces().largest, 0u);
    choose({4, 4}, "edit.undo");
    EXPECT_FALSE(pieces().hidesAny());
}

TEST_F(PickTest, ARowSelectsThePieceAndTheLargestAreKept) {
    showPanel();
    QTest::mouseClick(table()->viewport(), Qt::LeftButton, {},
                      table()->visualRect(table()->model()->index(1, 0)).center());
    EXPECT_EQ(pieces().selected, piece(1).id);
    QTest::keyClick(table(), Qt::Key_Down);
    EXPECT_EQ(pieces().selected, piece(2).id);
    auto* largest = child<QSpinBox>("largestPieces");
    largest->setFocus();
    QTest::keyClick(largest, Qt::Key_Up);
    EXPECT_EQ(pieces().largest, 1u);
    EXPECT_TRUE(waitUntil([this] { return count() == QStringLiteral("3 pieces, 2 hidden"); })) << count().toStdString();
    action("pieces.all")->trigger();
    EXPECT_EQ(pieces().largest, 0u);
    EXPECT_EQ(largest->value(), 0);
}

// The cones are those of a ball: at 1.5 the first one is a ball of radius 4.5.
TEST_F(PickTest, TheSelectedOneIsMeasured) {
    showPanel();
    auto* form = child<QWidget>("pieceForm");
    EXPECT_FALSE(form->isVisible());
    const auto facts = [&] {
        QStringList texts;
        for (const auto* label : form->findChildren<QLabel*>())
            if (label->isVisible())
                texts << label->text();
        return texts;
    };
    pick(pixelOf(0));
    ASSERT_TRUE(waitUntil([&] { return form->isVisible() && form->isEnabled(); }));
    ASSERT_EQ(facts().size(), 10) << facts().join(QLatin1Char('|')).toStdString();
    const auto numberOf = [&](int row) { return facts()[2 * row + 1].section(QChar(QChar::Nbsp), 0, 0).toDouble(); };
    constexpr double kArea = 4.0 * 3.14159265 * 4.5 * 4.5, kVolume = kArea * 4.5 / 3.0;
    EXPECT_NEAR(numberOf(2), kArea, 0.03 * kArea) << facts()[5].toStdString();
    EXPECT_NEAR(numberOf(3), kVolume, 0.03 * kVolume) << facts()[7].toStdString();
    const auto [least, greatest] = std::pair(session_->dataset()->min, session_->dataset()->max);
    const auto persistence = [&] { return facts()[9]; }; // the highest peak joins no higher one
    EXPECT_TRUE(waitUntil([&] { return std::abs(persistence().toDouble() - (greatest - least)) < 0.01; }))
        << persistence().toStdString();
    keepPicture(*window_, "piece_measured");
    pick(pixelOf(1)); // between both cones the greatest sample is at x = 14
    EXPECT_TRUE(waitUntil([&] { return persistence() == QStringLiteral("5 (from -1 to 4)"); }))
        << persistence().toStdString();
    pick(pixelOf(0));
    slideTo(2.5);
    ASSERT_TRUE(waitUntil([&] { return form->isEnabled() && numberOf(2) < 0.7 * kArea; }));
    action("pieces.hide")->trigger();
    EXPECT_TRUE(waitUntil([&] { return !form->isVisible(); }));
}

TEST_F(PickTest, ASessionHidesAgainWhatWasHidden) {
    pick(pixelOf(1));
    ASSERT_TRUE(waitUntil([&] { return pieces().selected.has_value(); }));
    QTest::keyClick(window_.get(), Qt::Key_H);
    const auto saveAs = [&](const char* name) {
        const auto path = folder_ / name;
        dialogs_.answers.push_back(QString::fromStdString(path.string()));
        trigger("file.saveSession");
        EXPECT_TRUE(waitUntil([&] { return std::filesystem::exists(path); }));
        return path;
    };
    const auto hidden = saveAs("hidden.isosession");
    action("pieces.all")->trigger();
    pick(pixelOf(2));
    ASSERT_TRUE(waitUntil([&] { return pieces().selected.has_value(); }));
    action("pieces.only")->trigger();
    const auto only = saveAs("only.isosession");
    const auto openSession = [&](const std::filesystem::path& path) {
        trigger("file.close");
        window_->openFile(QString::fromStdString(path.string()));
        ASSERT_TRUE(waitUntil([this] { return session_->frame() != nullptr; }));
        ASSERT_TRUE(waitUntilSettled());
        ASSERT_TRUE(waitUntil([this] { return session_->frame()->pieces && pieces().awaited.isEmpty(); }));
    };
    ASSERT_NO_FATAL_FAILURE(openSession(hidden));
    EXPECT_EQ(pieces().hidden, std::vector{piece(1).id});
    EXPECT_FALSE(pieces().only);
    QTest::qWait(600); // longer than steps are joined
    EXPECT_FALSE(action("edit.undo")->isEnabled()) << "nobody did it";
    ASSERT_NO_FATAL_FAILURE(openSession(only));
    EXPECT_EQ(pieces().hidden, std::vector<extract::PieceId>());
    EXPECT_EQ(pieces().only, piece(2).id);
    action("pieces.all")->trigger();
    EXPECT_FALSE(pieces().hidesAny());
}

TEST_F(PickTest, WhatIsShownIsExported) {
    EXPECT_FALSE(action("pieces.exportShown")->isEnabled());
    EXPECT_FALSE(action("pieces.exportSelected")->isEnabled());
    pick(pixelOf(1));
    ASSERT_TRUE(waitUntil([&] { return pieces().selected.has_value(); }));
    const std::uint64_t first = piece(0).triangles, second = piece(1).triangles, third = piece(2).triangles;
    const auto trianglesWrittenBy = [&](const char* name, const char* file) {
        dialogs_.answers.push_back(QString::fromStdString((folder_ / file).string()));
        action(name)->trigger();
        EXPECT_TRUE(waitUntil([&] { return std::filesystem::exists(folder_ / file); })) << file;
        EXPECT_TRUE(waitUntilSettled());
        std::ifstream text(folder_ / file);
        std::string line;
        std::uint64_t faces = 0;
        while (std::getline(text, line))
            faces += line.rfind("f ", 0) == 0;
        return faces;
    };
    EXPECT_EQ(trianglesWrittenBy("pieces.exportSelected", "one.obj"), second);
    QTest::keyClick(window_.get(), Qt::Key_H);
    EXPECT_EQ(trianglesWrittenBy("pieces.exportShown", "shown.obj"), first + third);
    EXPECT_EQ(trianglesWrittenBy("mesh.export", "whole.obj"), first + second + third);
    EXPECT_FALSE(action("pieces.exportSelected")->isEnabled());
}

// Two surfaces, each with a piece that is hidden.
class SurfacesWithPiecesTest : public PickTest {
protected:
    static void letStepEnd() { QTest::qWait(600); }
    model::SurfacesModel& surfaces() { return session_->surfaces(); }
    const model::HiddenPieces& hiddenOf(std::size_t place) { return surfaces().list().surfaces[place].hiddenPieces; }
    void hide(int cone) {
        pick(pixelOf(cone));
        ASSERT_TRUE(waitUntil([&] { return pieces().selected.has_value(); }));
        QTest::keyClick(window_.get(), Qt::Key_H);
        letStepEnd();
    }
    void addAt(double isovalue) {
        QTest::keyClick(window_.get(), Qt::Key_Insert);
        slideTo(isovalue);
        ASSERT_TRUE(waitUntilSettled());
        letStepEnd();
    }
    void activateNext() {
        QTest::keyClick(window_.get(), Qt::Key_N);
        const double isovalue = session_->isovalue().requested();
        ASSERT_TRUE(waitUntil([&] { return session_->frame()->isovalue == isovalue; }));
        ASSERT_TRUE(waitUntilSettled());
        letStepEnd();
    }
    void showOnly(std::size_t place) {
        for (std::size_t k = 0; k < surfaces().list().surfaces.size(); ++k)
            surfaces().change(surfaces().list().surfaces[k].id, [&](model::ListedSurface& surface) {
                surface.isVisible = k == place;
                surface.opacity = 1.0;
            });
        ASSERT_TRUE(waitUntilSettled());
    }
    /// Which of the cones are seen.
    std::vector<bool> seen() {
        const QImage picture = window_->viewportHost().picture();
        const QRgb background = picture.pixel(pixelOf(0).x(), 12);
        std::vector<bool> seen;
        for (const int cone : {0, 1, 2})
            seen.push_back(qGray(picture.pixel(pixelOf(cone))) > qGray(background) + 40);
        return seen;
    }
    using Seen = std::vector<bool>;
};

TEST_F(SurfacesWithPiecesTest, AnotherOneHidesAndShowsNothingOfTheFirst) {
    EXPECT_EQ(seen(), (Seen{true, true, true}));
    hide(1);
    EXPECT_EQ(seen(), (Seen{true, false, true}));
    addAt(1.0);
    EXPECT_FALSE(pieces().hidesAny()) << "the new one is whole";
    showOnly(0);
    EXPECT_EQ(seen(), (Seen{true, false, true}));
    showOnly(1);
    EXPECT_EQ(seen(), (Seen{true, true, true}));
    letStepEnd();
    hide(0);
    EXPECT_EQ(seen(), (Seen{false, true, true}));
    showOnly(0);
    EXPECT_EQ(seen(), (Seen{true, false, true}));
    activateNext();
    EXPECT_EQ(seen(), (Seen{true, false, true})) << "it keeps its numbers while another one slides";
    ASSERT_EQ(pieces().hidden.size(), 1u);
    EXPECT_EQ(pieces().hidden.front(), piece(1).id);
    showOnly(1);
    EXPECT_EQ(seen(), (Seen{false, true, true}));
    keepPicture(*window_, "pieces_of_two_surfaces");
}

TEST_F(SurfacesWithPiecesTest, ADoubleClickOnAnotherSurfaceMakesItActiveAndSelectsItsPiece) {
    addAt(1.0); // larger cones around the first ones
    for (const model::ListedSurface& surface : surfaces().list().surfaces)
        surfaces().change(surface.id, [](model::ListedSurface& changed) { changed.opacity = 1.0; });
    activateNext();
    ASSERT_EQ(session_->frame()->isovalue, 1.5);
    letStepEnd();
    pick(pixelOf(1));
    ASSERT_TRUE(waitUntil([&] { return session_->frame()->isovalue == 1.0 && pieces().selected.has_value(); }))
        << "the outer one is in front";
    EXPECT_EQ(*pieces().selected, piece(1).id);
    surfaces().change(surfaces().list().active, [](model::ListedSurface& outer) { outer.opacity = 0.4; });
    pick(pixelOf(2));
    ASSERT_TRUE(waitUntil([&] { return session_->frame()->isovalue == 1.5 && pieces().selected.has_value(); }))
        << "what is seen through it is meant";
    EXPECT_EQ(*pieces().selected, piece(2).id);
}

TEST_F(SurfacesWithPiecesTest, AllThatIsShownIsExportedAFileForEach) {
    hide(1);
    const auto ofFirst = piece(0).triangles + piece(2).triangles;
    addAt(1.0);
    ASSERT_TRUE(action("pieces.exportShown")->isEnabled());
    dialogs_.answers.push_back(qpath(folder_ / "shown.obj"));
    folder_.write("shown_Surface_1.obj", "not to be replaced");
    action("pieces.exportShown")->trigger();
    EXPECT_TRUE(dialogs_.asked.title.contains(QLatin1Char('2'))) << dialogs_.asked.title.toStdString();
    const auto second = folder_ / "shown_Surface_1_2.obj";
    ASSERT_TRUE(waitUntil([&] { return std::filesystem::exists(second); }));
    ASSERT_TRUE(waitUntilSettled());
    const auto facesOf = [](const std::filesystem::path& path) {
        std::ifstream text(path);
        std::string line;
        std::uint64_t faces = 0;
        while (std::getline(text, line))
            faces += line.rfind("f ", 0) == 0;
        return faces;
    };
    EXPECT_EQ(facesOf(folder_ / "shown.obj"), session_->frame()->stats.triangles);
    EXPECT_EQ(facesOf(second), ofFirst);
    EXPECT_EQ(std::filesystem::file_size(folder_ / "shown_Surface_1.obj"), 18u);
    showOnly(1);
    dialogs_.answers.push_back(qpath(folder_ / "only.obj"));
    EXPECT_FALSE(action("pieces.exportShown")->isEnabled()) << "the whole of one surface: that is Export Mesh";
    dialogs_.answers.clear();
}

TEST_F(SurfacesWithPiecesTest, FitShowsAllSurfacesThatAreShown) {
    addAt(2.5); // small tips of the cones
    const auto radiusOf = [this] {
        const auto before = viewport().camera().pose();
        QTest::keyClick(window_.get(), Qt::Key_F);
        EXPECT_TRUE(waitUntil([&] { return viewport().camera().pose() != before; }));
        QTest::qWait(600); // the camera flies
        return viewport().camera().distance();
    };
    const double both = radiusOf();
    showOnly(1);
    const double one = radiusOf();
    EXPECT_LT(one, 0.95 * both);
    showOnly(0);
    EXPECT_NEAR(radiusOf(), both, 0.02 * both) << "the larger one holds the smaller one";
}

TEST_F(SurfacesWithPiecesTest, UndoBringsEachBackAsItWas) {
    hide(1);
    addAt(1.0);
    showOnly(1); // else the smaller cones of the first, seen through it, are meant
    letStepEnd();
    hide(2);
    const auto first = hiddenOf(0), second = hiddenOf(1);
    ASSERT_EQ(second.hidden.size(), 1u);
    QTest::keyClick(window_.get(), Qt::Key_Delete, Qt::ShiftModifier);
    letStepEnd();
    ASSERT_EQ(surfaces().list().surfaces.size(), 1u);
    EXPECT_EQ(pieces().hiddenPieces(), first);
    const auto undo = [this] {
        QTest::keyClick(window_.get(), Qt::Key_Z, Qt::ControlModifier);
        ASSERT_TRUE(waitUntilSettled());
    };
    undo(); // the removal
    EXPECT_EQ(pieces().hiddenPieces(), second);
    EXPECT_EQ(hiddenOf(0), first);
    EXPECT_EQ(seen(), (Seen{true, true, false}));
    EXPECT_EQ(action("edit.undo")->text(), QStringLiteral("&Undo Pieces"));
    undo();
    EXPECT_FALSE(pieces().hidesAny());
    undo(); // showing one only
    undo(); // the slide
    undo(); // adding it
    ASSERT_EQ(surfaces().list().surfaces.size(), 1u);
    ASSERT_TRUE(waitUntil([&] { return session_->frame()->isovalue == 1.5; }));
    EXPECT_EQ(pieces().hiddenPieces(), first);
    EXPECT_EQ(seen(), (Seen{true, false, true}));
    undo();
    EXPECT_FALSE(pieces().hidesAny());
    EXPECT_EQ(seen(), (Seen{true, true, true}));
}

TEST_F(SurfacesWithPiecesTest, ASessionKeepsWhatEachHides) {
    hide(1);
    addAt(1.0);
    showOnly(1); // as above
    letStepEnd();
    hide(0);
    surfaces().change(surfaces().list().surfaces[0].id, [](model::ListedSurface& first) { first.isVisible = true; });
    ASSERT_TRUE(waitUntilSettled());
    const auto path = folder_ / "two.isosession";
    dialogs_.answers.push_back(QString::fromStdString(path.string()));
    trigger("file.saveSession");
    ASSERT_TRUE(waitUntil([&] { return std::filesystem::exists(path); }));
    trigger("file.close");
    window_->openFile(QString::fromStdString(path.string()));
    ASSERT_TRUE(waitUntil([this] { return session_->frame() != nullptr; }));
    ASSERT_TRUE(waitUntilSettled());
    ASSERT_TRUE(waitUntil([this] { return hiddenOf(0).awaited.isEmpty() && hiddenOf(1).awaited.isEmpty(); }));
    ASSERT_TRUE(waitUntilSettled());
    letStepEnd();
    EXPECT_FALSE(action("edit.undo")->isEnabled()) << "nobody did it";
    EXPECT_EQ(hiddenOf(0).hidden.size(), 1u);
    EXPECT_EQ(hiddenOf(1).hidden.size(), 1u);
    QTest::keyClick(window_.get(), Qt::Key_1);
    showOnly(0);
    EXPECT_EQ(seen(), (Seen{true, false, true}));
    showOnly(1);
    EXPECT_EQ(seen(), (Seen{false, true, true}));
}

TEST_F(SurfacesWithPiecesTest, SlicesHaveContoursOfWhatIsShown) {
    window_->slices().change([](model::SliceOptions& options) { options.layout = model::SliceLayout::Three; });
    hide(1);
    addAt(1.0);
    ASSERT_TRUE(waitUntil([this] { return window_->slices().isSettled(); }));
    const auto contour = window_->slices().contour(model::SliceKind::Z);
    ASSERT_NE(contour, nullptr);
    ASSERT_EQ(contour->parts.size(), 2u);
    const auto pointsNear = [&](int cone, std::size_t part) {
        int count = 0;
        const std::size_t begin = part == 0 ? 0 : contour->parts[part - 1].pointEnd;
        for (std::size_t k = begin; k < contour->parts[part].pointEnd; ++k)
            count += std::abs(contour->points[k].x - 7.0f - 12.5f * static_cast<float>(cone)) < 5.0f;
        return count;
    };
    EXPECT_GT(pointsNear(0, 0), 10);
    EXPECT_EQ(pointsNear(1, 0), 0) << "it is hidden";
    EXPECT_GT(pointsNear(2, 0), 10);
    EXPECT_GT(pointsNear(1, 1), 10) << "of the other surface it is shown";
    EXPECT_NE(contour->parts[0].colour, contour->parts[1].colour);
    keepPicture(*window_, "contours_of_two_surfaces");
}

// "Show all" takes the numbers of pieces with it only if nobody asks for them.
TEST_F(SurfacesWithPiecesTest, ShowingAllIsUndone) {
    hide(1);
    QTest::keyClick(window_.get(), Qt::Key_H, Qt::ControlModifier | Qt::ShiftModifier);
    letStepEnd();
    EXPECT_EQ(seen(), (Seen{true, true, true}));
    slideTo(1.6);
    letStepEnd();
    QTest::keyClick(window_.get(), Qt::Key_Z, Qt::ControlModifier);
    QTest::keyClick(window_.get(), Qt::Key_Z, Qt::ControlModifier);
    ASSERT_TRUE(waitUntilSettled());
    EXPECT_EQ(seen(), (Seen{true, false, true}));
}

} // namespace
} // namespace isoslider::test
