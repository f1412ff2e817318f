#pragma once

#include <functional>
#include <optional>
#include <vector>

#include <QElapsedTimer>
#include <qcustomplot.h>

#include "core/grid/histogram.h"
#include "core/grid/scalar_type.h"
#include "ui/widgets/isovalue/event_marks.h"

namespace isoslider::widgets {

/// The histogram with the isovalue handle on it. The whole plot is the slider: press anywhere and
/// drag; Shift makes a drag 10 times finer; the wheel and the keys step. Ctrl+wheel zooms about the
/// pointer, dragging the axis or the middle button pans, a double click shows the whole range and leaves the isovalue
/// where it was before its first click. Events of the topology stand on the axis as marks; pressing one chooses it.
/// Shows values only; whoever listens decides what becomes of a request.
class HistogramPlot : public QCustomPlot {
    Q_OBJECT
public:
    explicit HistogramPlot(QWidget* parent = nullptr);

    /// `activeEdgesPerBin` may be empty: then there is no curve of the surface's size.
    void setHistogram(const Histogram& histogram, ScalarType type, const std::vector<std::uint64_t>& activeEdgesPerBin);
    void clearHistogram();
    void setIsovalues(double requested, double displayed);
    void setLogCounts(bool isLog);
    /// Ascending by isovalue. `describe` gives the tool tip of one; empty if there are no marks.
    void setEventMarks(std::vector<EventMark> marks, std::function<QString(std::size_t event)> describe);
    void setChosenEvent(std::optional<std::size_t> event);
    /// Whether a drag near a mark goes just past its event; not while Shift is held.
    void setSnapping(bool isSnapping) { isSnapping_ = isSnapping; }
    const EventMarks& eventMarks() const { return *marks_; }
    void showWholeRange();

    double minimum() const { return min_; }
    double maximum() const { return max_; }
    double requested() const { return requested_; }
    /// Widget x of a value, for tests and the tag.
    double pixelOf(double value) const { return xAxis->coordToPixel(value); }
    QCPRange visibleRange() const { return xAxis->range(); }

Q_SIGNALS:
    void isovalueRequested(double isovalue);
    void stepRequested(double rangeFraction);
    /// A mark was pressed.
    void eventPressed(std::size_t event);
    /// The handle is held with the mouse, or no longer.
    void handleHeld(bool isHeld);

protected:
    bool event(QEvent* event) override;
    void mousePressEvent(QMouseEvent* event) override;
    void mouseMoveEvent(QMouseEvent* event) override;
    void mouseReleaseEvent(QMouseEvent* event) override;
    void mouseDoubleClickEvent(QMouseEvent* event) override;
    void wheelEvent(QWheelEvent* event) override;
    void keyPressEvent(QKeyEvent* event) override;
    void changeEvent(QEvent* event) override;
    void resizeEvent(QResizeEvent* event) override;
    void focusInEvent(QFocusEvent* event) override;
    void focusOutEvent(QFocusEvent* event) override;

private:
    enum class Drag { None, Handle, Pan };

    void setUpAxes();
    void setUpHandle();
    void applyPalette();
    void applyVerticalRange();
    void applyTickCounts();
    void applyFocus();
    void clampRange(const QCPRange& range);
    void placeHandle();
    void zoomAt(double pixel, double factor);
    void showCursor(QPointF place);
    void requestDragged(bool isFine);
    const EventMark* markToPress(QPointF place) const;
    double valuePerPixel() const;

    QCPGraph* counts_ = nullptr;
    QCPGraph* activeEdges_ = nullptr;
    QCPItemStraightLine* requestedLine_ = nullptr;
    QCPItemStraightLine* displayedLine_ = nullptr;
    QCPItemText* tag_ = nullptr;
    QCPItemText* emptyHint_ = nullptr;
    EventMarks* marks_ = nullptr;
    std::function<QString(std::size_t)> describeEvent_;
    double min_ = 0.0;
    double max_ = 0.0;
    double requested_ = 0.0;
    double displayed_ = 0.0;
    double dragValue_ = 0.0;
    QPointF dragPoint_;
    std::optional<double> valueBeforePress_; ///< of a press that may become a double click
    QElapsedTimer sincePress_;
    Drag drag_ = Drag::None;
    bool hasHistogram_ = false;
    bool isLog_ = true;
    bool isSnapping_ = false;
};

} // namespace isoslider::widgets
