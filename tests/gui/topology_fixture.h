#pragma once

#include <cmath>
#include <vector>

#include <QApplication>
#include <QMouseEvent>
#include <QTest>

#include "core/topology/topology_curve.h"
#include "tests/gui/cones.h"
#include "tests/gui/window_fixture.h"
#include "ui/widgets/isovalue/histogram_plot.h"
#include "ui/widgets/isovalue/isovalue_panel.h"

namespace isoslider::test {

/// A window with the volume of cones.h, whose topology is ready.
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

} // namespace isoslider::test
