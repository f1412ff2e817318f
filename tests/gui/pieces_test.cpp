// Pieces of the surface in the window: counted and listed, in colours, the small and short-lived ones hidden.
#include "tests/gui/pieces_fixture.h"

namespace isoslider::test {
namespace {

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
    QTest::qWait(600); // all before is one
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

TEST_F(PiecesTest, WhereSamplesAreGoneNoneIsHiddenByPersistenceAndWhyIsStated) {
    builder_->kind = index::IndexKind::Edges;
    open();
    ASSERT_EQ(session_->samples(), nullptr);
    std::filesystem::remove(session_->dataset()->indexPath);
    showPanel();
    auto* persistence = child<QSlider>("piecePersistence");
    persistence->setFocus();
    QTest::keyClick(persistence, Qt::Key_End);
    const auto known = [this] { return view().options().pieces.shortLived; };
    ASSERT_TRUE(waitUntil([&] { return known() != nullptr; }));
    EXPECT_FALSE(known()->error.empty());
    EXPECT_EQ(count(), QStringLiteral("3 pieces"));
    EXPECT_EQ(child<QLabel>("piecePersistenceValue")->text(), QStringLiteral("–"));
    EXPECT_TRUE(persistence->toolTip().contains(QString::fromStdString(known()->error).toHtmlEscaped()))
        << persistence->toolTip().toStdString();
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

} // namespace
} // namespace isoslider::test
