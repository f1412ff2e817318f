// Lengths and angles between places on the surface, picked in the view.
#include <cmath>

#include <QAction>
#include <QtTest>

#include <glm/geometric.hpp>

#include "tests/gui/window_fixture.h"
#include "ui/model/isovalue/number_text.h"
#include "ui/widgets/viewport/measure_tool.h"
#include "ui/widgets/viewport/viewport_host.h"
#include "ui/widgets/viewport/viewport_widget.h"
#include "ui/widgets/window/action_registry.h"
#include "ui/widgets/window/message_bar.h"

namespace isoslider::test {
namespace {

constexpr double kBallRadius = 8.0;

class MeasureTest : public WindowTest {
protected:
    void SetUp() override {
        if (window_->viewportHost().viewport() == nullptr)
            GTEST_SKIP() << "no OpenGL 3.3 here";
        openBall();
        ASSERT_TRUE(session_->isovalue().request(-kBallRadius));
        QTest::keyClick(window_.get(), Qt::Key_1);
        ASSERT_TRUE(waitUntilSettled());
        QTest::keyClick(window_.get(), Qt::Key_M);
        ASSERT_TRUE(action().isChecked());
    }
    QAction& action() { return *window_->actions().action("view.measure"); }
    widgets::ViewportWidget& viewport() { return *window_->viewportHost().viewport(); }
    widgets::MeasureView& measures() { return *child<widgets::MeasureView>("measureView"); }
    const model::MeasuredPlaces& places() { return window_->viewportHost().viewState().options().measured; }
    /// So far right of the ball's middle and above it, in parts of its radius.
    QPoint at(double right, double above) {
        const auto& camera = viewport().camera();
        return measures().pointOf(kBallRadius * (right * camera.right() + above * camera.up()))->toPoint();
    }
    void click(QPoint point) { QTest::mouseClick(&viewport(), Qt::LeftButton, {}, point); }
    std::string lengthText(std::size_t first) {
        return model::valueText(glm::distance(places()[first], places()[first + 1]), 4) +
               "\xc2\xa0units"; // a space that does not break
    }
};

TEST_F(MeasureTest, PlacesLieOnWhicheverSurfaceIsSeen) {
    QTest::keyClick(window_.get(), Qt::Key_Insert);
    ASSERT_TRUE(session_->isovalue().request(-kBallRadius / 2.0));
    ASSERT_TRUE(waitUntilSettled());
    auto& surfaces = session_->surfaces();
    const auto outer = surfaces.list().surfaces[0].id;
    surfaces.change(surfaces.list().active, [](model::ListedSurface& inner) { inner.opacity = 1.0; });
    const auto radiusAt = [&](double opacity, bool isVisible) {
        surfaces.change(outer, [&](model::ListedSurface& surface) {
            surface.opacity = opacity;
            surface.isVisible = isVisible;
        });
        click(at(0.2, 0.1));
        return places().empty() ? 0.0 : glm::length(places().back());
    };
    EXPECT_NEAR(radiusAt(1.0, true), kBallRadius, 0.1);
    EXPECT_NEAR(radiusAt(0.4, true), kBallRadius / 2.0, 0.1) << "through the outer one";
    EXPECT_NEAR(radiusAt(1.0, false), kBallRadius / 2.0, 0.1);
}

TEST_F(MeasureTest, ClicksGiveLengthsAndAnAngle) {
    EXPECT_EQ(viewport().cursor().shape(), Qt::CrossCursor);
    EXPECT_FALSE(measures().isVisible());
    const std::array<QPoint, 3> points{at(-0.6, 0.0), at(0.0, 0.5), at(0.6, 0.1)};
    for (const QPoint& point : points)
        click(point);
    ASSERT_EQ(places().size(), 3u);
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_NEAR(glm::length(places()[i]), kBallRadius, 0.1) << "on the ball";
        EXPECT_GT(glm::dot(places()[i], viewport().camera().backward()), 0.0) << "on the side that is seen";
        EXPECT_LT(QLineF(*measures().pointOf(places()[i]), points[i]).length(), 1.0);
    }
    const QStringList texts = measures().texts();
    ASSERT_EQ(texts.size(), 3);
    EXPECT_EQ(texts[0].toStdString(), lengthText(0));
    EXPECT_EQ(texts[1].toStdString(), lengthText(1));
    EXPECT_EQ(texts[2], QStringLiteral("%1°").arg(*model::measuredAngle(places()), 0, 'f', 1));
    EXPECT_TRUE(measures().isVisible());
    keepPicture(*window_, "measure");
    click(at(0.3, 0.3));
    EXPECT_EQ(places().size(), 1u) << "begins again";
    click(QPoint(3, viewport().height() / 2));
    EXPECT_EQ(places().size(), 1u) << "beside the surface there is nothing to measure";
}

TEST_F(MeasureTest, ADragOrbitsAndTheLinesGoAlong) {
    click(at(-0.5, 0.0));
    click(at(0.5, 0.0));
    const auto before = *measures().pointOf(places()[0]);
    const QPoint from = at(0.0, 0.0);
    QTest::mousePress(&viewport(), Qt::LeftButton, {}, from);
    for (int step = 1; step <= 8; ++step)
        QTest::mouseMove(&viewport(), from + QPoint(10 * step, 0));
    QTest::mouseRelease(&viewport(), Qt::LeftButton, {}, from + QPoint(80, 0));
    EXPECT_EQ(places().size(), 2u);
    EXPECT_GT(QLineF(*measures().pointOf(places()[0]), before).length(), 10.0);
}

TEST_F(MeasureTest, IsUndoneKeptInSessionsAndForgottenWhenSwitchedOff) {
    click(at(-0.5, 0.0));
    click(at(0.5, 0.2));
    const auto measured = places();
    ASSERT_EQ(measured.size(), 2u);
    ASSERT_TRUE(waitUntil([this] { return window_->actions().action("edit.undo")->isEnabled(); }));
    trigger("edit.undo");
    EXPECT_LT(places().size(), 2u);
    trigger("edit.redo");
    EXPECT_EQ(places(), measured);
    dialogs_.answers.push_back(QString::fromStdString((folder_ / "a.isosession").string()));
    trigger("file.saveSession");
    ASSERT_TRUE(waitUntil([this] { return window_->messageBar().isVisible(); }));
    QTest::keyClick(window_.get(), Qt::Key_M);
    EXPECT_TRUE(places().empty());
    EXPECT_FALSE(measures().isVisible());
    click(at(0.0, 0.0));
    EXPECT_TRUE(places().empty()) << "switched off";
    trigger("file.close");
    drop(folder_ / "a.isosession");
    ASSERT_TRUE(waitUntil([this] { return session_->frame() != nullptr && session_->isSettled(); }));
    EXPECT_EQ(places(), measured);
    EXPECT_TRUE(action().isChecked());
    openBall(20);
    EXPECT_TRUE(waitUntil([this] { return places().empty(); })) << "another volume";
    EXPECT_FALSE(action().isChecked());
}

TEST_F(MeasureTest, IsInSavedPictures) {
    const QImage without = window_->viewportHost().picture();
    click(at(-0.5, 0.0));
    click(at(0.5, 0.0));
    const QImage with = window_->viewportHost().picture();
    ASSERT_EQ(with.size(), without.size());
    const double ratio = static_cast<double>(with.width()) / viewport().width();
    const QPoint middle =
        ((*measures().pointOf(places()[0]) + *measures().pointOf(places()[1])) / 2.0 * ratio).toPoint();
    int changed = 0;
    for (int y = -2; y <= 2; ++y)
        changed += with.pixel(middle + QPoint(0, y)) != without.pixel(middle + QPoint(0, y));
    EXPECT_GT(changed, 0);
}

} // namespace
} // namespace isoslider::test
