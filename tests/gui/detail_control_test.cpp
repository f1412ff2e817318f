#include <QComboBox>
#include <QLabel>
#include <QSlider>
#include <QTest>

#include "core/volume_io/volume_reader.h"
#include "preprocess/build_index.h"
#include "tests/gui/window_fixture.h"
#include "tests/support/result_matchers.h"
#include "ui/widgets/isovalue/detail_control.h"
#include "ui/widgets/isovalue/histogram_plot.h"
#include "ui/widgets/window/action_registry.h"

namespace isoslider::test {
namespace {

class DetailControlTest : public WindowTest {
protected:
    void open(index::IndexKind kind) {
        builder_->kind = kind;
        openBall(40);
    }
    QSlider& slider() { return *child<QSlider>("detailSlider"); }
    QComboBox& measure() { return *child<QComboBox>("detailMeasure"); }
    QString value() { return child<QLabel>("detailValue")->text(); }
    std::uint64_t triangles() { return session_->frame()->stats.triangles; }
    void press(Qt::Key key, int times = 1) {
        for (int i = 0; i < times; ++i)
            QTest::keyClick(&slider(), key);
        ASSERT_TRUE(waitUntilSettled());
    }
};

TEST_F(DetailControlTest, TradesTrianglesForAnError) {
    open(index::IndexKind::Metacells);
    ASSERT_TRUE(slider().isEnabled());
    EXPECT_EQ(value().toStdString(), "none");
    const std::uint64_t all = triangles();
    press(Qt::Key_Right, 5);
    EXPECT_EQ(value().toStdString(), "0.25 cells");
    EXPECT_EQ(session_->frame()->mergeBound, (extract::MergeBound{extract::MergeBound::Measure::Distance, 0.25}));
    EXPECT_LT(triangles(), all / 2);
    const std::uint64_t merged = triangles();

    // It stays while the isovalue moves, and percent are of the range.
    session_->isovalue().request(-9.0);
    ASSERT_TRUE(waitUntilSettled());
    EXPECT_LT(triangles(), merged * 2);
    measure().setCurrentIndex(1);
    ASSERT_TRUE(waitUntilSettled());
    EXPECT_EQ(value().toStdString(), "0.5 %");
    const auto& domain = session_->isovalue();
    EXPECT_NEAR(session_->frame()->mergeBound.limit, 0.005 * (domain.max() - domain.min()), 1e-9);
    keepPicture(*window_, "detail");

    const auto path = folder_ / "merged.obj";
    session_->exportMesh(path, session_->datasetGeneration());
    ASSERT_TRUE(waitUntilSettled());
    EXPECT_NE(readText(path).find("within 0.5 % of the value range"), std::string::npos);

    press(Qt::Key_Home);
    EXPECT_EQ(value().toStdString(), "none");
    EXPECT_GT(triangles(), merged);
    EXPECT_EQ(session_->frame()->mergeBound.limit, 0.0);
}

TEST_F(DetailControlTest, ANewVolumeBeginsWithoutAnError) {
    open(index::IndexKind::Metacells);
    press(Qt::Key_Right, 7);
    EXPECT_EQ(value().toStdString(), "0.5 cells");
    EXPECT_EQ(session_->frame()->mergeBound.limit, 0.5);
    const auto merged = session_->frame()->stats.activeLeaves;
    EXPECT_GT(merged[1] + merged[2] + merged[3], merged[0]);
    openBall(30);
    session_->isovalue().request(-10.0);
    ASSERT_TRUE(waitUntil([this] { return session_->frame()->isovalue == -10.0; }));
    EXPECT_EQ(value().toStdString(), "none");
    EXPECT_EQ(session_->frame()->mergeBound.limit, 0.0);
    EXPECT_FALSE(window_->actions().action("edit.undo")->text().contains(QStringLiteral("Error"))) << "nobody set it";
}

TEST_F(DetailControlTest, IsCoarserWhileTheHandleIsHeld) {
    open(index::IndexKind::Metacells);
    const std::uint64_t all = triangles();
    const double isovalue = session_->frame()->isovalue;
    auto* plot = child<widgets::HistogramPlot>("histogramPlot");
    const QPoint place(plot->width() / 2, plot->height() / 2);
    QTest::mousePress(plot, Qt::LeftButton, {}, place);
    ASSERT_TRUE(waitUntilSettled());
    EXPECT_EQ(session_->frame()->mergeBound.limit, 0.0) << "not unless it is wanted";
    QTest::mouseRelease(plot, Qt::LeftButton, {}, place);
    session_->isovalue().request(isovalue);
    window_->actions().action("isovalue.coarserWhileMoving")->trigger();
    ASSERT_TRUE(waitUntilSettled());
    EXPECT_EQ(session_->frame()->mergeBound.limit, 0.0);

    QTest::mousePress(plot, Qt::LeftButton, {}, place);
    QTest::mouseMove(plot, place + QPoint(3, 0));
    ASSERT_TRUE(waitUntilSettled());
    EXPECT_EQ(session_->frame()->mergeBound, (extract::MergeBound{extract::MergeBound::Measure::Distance, 0.5}));
    const auto& leaves = session_->frame()->stats.activeLeaves;
    EXPECT_GT(leaves[1] + leaves[2] + leaves[3], 0u);
    EXPECT_EQ(value().toStdString(), "none") << "what was chosen stays";
    QTest::mouseRelease(plot, Qt::LeftButton, {}, place + QPoint(3, 0));
    ASSERT_TRUE(waitUntilSettled());
    EXPECT_EQ(session_->frame()->mergeBound.limit, 0.0);
    // Another button ends it, too.
    QTest::mousePress(plot, Qt::LeftButton, {}, place);
    QTest::mousePress(plot, Qt::RightButton, {}, place);
    ASSERT_TRUE(waitUntilSettled());
    EXPECT_EQ(session_->frame()->mergeBound.limit, 0.0);
    QTest::mouseRelease(plot, Qt::RightButton, {}, place);
    QTest::mouseRelease(plot, Qt::LeftButton, {}, place);
    session_->isovalue().request(isovalue);
    ASSERT_TRUE(waitUntilSettled());
    EXPECT_EQ(triangles(), all);
}

TEST_F(DetailControlTest, ColoursCellsByTheirSize) {
    open(index::IndexKind::Metacells);
    auto* legend = child<QLabel>("legend");
    window_->actions().action("view.levels")->trigger();
    EXPECT_TRUE(legend->isHidden()) << "there are no merged cells";
    press(Qt::Key_Right, 5);
    EXPECT_TRUE(legend->isVisible());
    keepPicture(*window_, "levels");
    window_->actions().action("view.levels")->trigger();
    EXPECT_TRUE(legend->isHidden());
}

TEST_F(DetailControlTest, TakesTheErrorThatAnIndexWasBuiltWith) {
    const auto source = io::openVolume(writeBall(folder_, "ball.mha", 24));
    ASSERT_THAT(source, IsOk());
    preprocess::BuildOptions options;
    options.mergeError = {extract::MergeBound::Measure::Distance, 0.5};
    ASSERT_THAT(preprocess::buildIndex(*source.value(), folder_ / "merged.isx", options), IsOk());
    window_->openFile(qpath(folder_ / "merged.isx"));
    ASSERT_TRUE(waitUntil([this] { return session_->frame() != nullptr && session_->isSettled(); }));
    EXPECT_EQ(value().toStdString(), "0.5 cells");
    EXPECT_EQ(session_->frame()->mergeBound, (extract::MergeBound{extract::MergeBound::Measure::Distance, 0.5}));
    const std::uint64_t merged = triangles();
    // It is the index's: another volume is seen as before.
    const auto isShownWhole = [this] {
        return session_->frame() != nullptr && session_->isSettled() && session_->frame()->mergeBound.limit == 0.0;
    };
    window_->openFile(qpath(folder_ / "ball.mha"));
    ASSERT_TRUE(waitUntil(isShownWhole));
    EXPECT_EQ(value().toStdString(), "none");
    window_->openFile(qpath(folder_ / "merged.isx"));
    ASSERT_TRUE(waitUntil([&] { return !isShownWhole() && session_->frame() != nullptr && session_->isSettled(); }));
    EXPECT_EQ(value().toStdString(), "0.5 cells");
    press(Qt::Key_Home);
    EXPECT_GT(triangles(), merged);
}

TEST_F(DetailControlTest, IsForAnIndexOfEdgesToo) {
    open(index::IndexKind::Edges);
    EXPECT_TRUE(slider().isEnabled());
    const auto all = triangles();
    session_->detail().setError({extract::MergeBound::Measure::Distance, 1.0});
    ASSERT_TRUE(waitUntilSettled());
    EXPECT_EQ(session_->frame()->mergeBound.limit, 1.0);
    EXPECT_LT(triangles(), all);
}

} // namespace
} // namespace isoslider::test
