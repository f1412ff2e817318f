// Pieces that are picked in the view: selected, hidden, shown alone, measured, exported.
#include "tests/gui/pieces_fixture.h"
#include "ui/model/isovalue/number_text.h"
#include "ui/widgets/window/message_bar.h"

namespace isoslider::test {
namespace {

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

TEST_F(PickTest, ANewVolumeHasPiecesOfOneColour) {
    trigger("pieces.colour");
    ASSERT_TRUE(pieces().isColoured);
    window_->openFile(QString::fromStdString(writeSeparateCones(folder_).string()));
    ASSERT_TRUE(waitUntilSettled());
    EXPECT_FALSE(pieces().isColoured);
    EXPECT_FALSE(action("pieces.colour")->isChecked());
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
    const double range = session_->dataset()->max - session_->dataset()->min;
    const auto persistence = [&] { return facts()[9]; }; // the highest peak joins no higher one
    EXPECT_TRUE(waitUntil([&] { return std::abs(persistence().toDouble() - range) < 0.01; }))
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

TEST_F(PickTest, PanelsStateThatHiddenAndClippedPartsAreCounted) {
    for (const char* name : {"countsShown", "meshShown"}) {
        child<QDockWidget>(name[0] == 'c' ? "countsDock" : "meshDock")->raise();
        auto* label = window_->findChild<QLabel*>(QLatin1String(name));
        ASSERT_NE(label, nullptr) << name;
        const auto says = [&](const std::string& text) {
            const auto shown = [&] { return label->isVisible() ? label->text().toStdString() : std::string(); };
            EXPECT_TRUE(waitUntil([&] { return shown() == text; }, std::chrono::seconds(5))) << name << ": " << shown();
        };
        says("");
        pick(pixelOf(1));
        ASSERT_TRUE(waitUntil([&] { return pieces().selected.has_value(); }));
        action("pieces.hide")->trigger();
        const auto left = piece(0).triangles + piece(2).triangles;
        says("Shown: 2 of 3 pieces, " + model::groupedText(left) + " triangles");
        if (name[0] == 'm')
            keepPicture(*window_, "whole_surface");
        trigger("clip.plane");
        says("Hidden pieces and what is clipped are counted too.");
        action("pieces.all")->trigger();
        says("What is clipped is counted too.");
        trigger("clip.plane");
        says("");
        trigger("surfaces.show");
        says("The surface is hidden; it is counted all the same.");
        trigger("surfaces.show");
        says("");
    }
}

TEST_F(PickTest, AnExportOfTheWholeStatesThatHiddenPartsAreInIt) {
    const auto exportAs = [this](const char* name, const char* file) {
        dialogs_.answers.push_back(qpath(folder_ / file));
        action(name)->trigger();
        EXPECT_TRUE(waitUntil([&] { return std::filesystem::exists(folder_ / file); })) << file;
        EXPECT_TRUE(waitUntilSettled());
        return dialogs_.asked.title.toStdString() + '|' + window_->messageBar().text().toStdString();
    };
    const auto has = [](const std::string& text, const char* part) { return text.find(part) != std::string::npos; };
    const std::string whole = exportAs("mesh.export", "all.obj");
    EXPECT_TRUE(has(whole, "Export Mesh|")) << whole;
    EXPECT_FALSE(has(whole, "hidden")) << whole;
    EXPECT_FALSE(has(readText(folder_ / "all.obj"), "# part:"));
    pick(pixelOf(1));
    ASSERT_TRUE(waitUntil([&] { return pieces().selected.has_value(); }));
    action("pieces.hide")->trigger();
    const std::string hidden = exportAs("mesh.export", "hidden.obj");
    EXPECT_TRUE(has(hidden, "Export Whole Surface|")) << hidden;
    EXPECT_TRUE(has(hidden, "The hidden pieces are in it. Export What Is Shown leaves them out.")) << hidden;
    trigger("clip.plane");
    const std::string both = exportAs("mesh.export", "both.obj");
    EXPECT_TRUE(has(both, "The hidden and clipped parts are in it. Export What Is Shown leaves them out.")) << both;
    keepPicture(*window_, "whole_surface_exported");
    EXPECT_FALSE(has(exportAs("pieces.exportShown", "shown.obj"), "are in it"));
    EXPECT_TRUE(has(readText(folder_ / "shown.obj"),
                    "# part: 2 of the pieces; the others are left out; what is clipped is left out"));
    action("pieces.all")->trigger();
    const std::string clipped = exportAs("mesh.export", "clipped.obj");
    EXPECT_TRUE(has(clipped, "The clipped parts are in it. Export What Is Shown leaves them out.")) << clipped;
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

} // namespace
} // namespace isoslider::test
