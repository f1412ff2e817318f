#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include <QElapsedTimer>
#include <qcustomplot.h>

#include "core/grid/histogram.h"
#include "ui/model/isovalue/histogram_options.h"
#include "ui/model/isovalue/histogram_view.h"
#include "ui/model/isovalue/isovalue_model.h"
#include "ui/widgets/isovalue/event_marks.h"

class QRubberBand;

namespace isoslider::widgets {

class HistogramHints;
class ScaleTicker;

/// The histogram with the isovalue handle on it. The whole plot is the slider: press anywhere and drag; Shift makes a
/// drag 10 times finer; the wheel and the keys step. Ctrl+wheel zooms about the pointer, Ctrl+drag zooms to what it
/// covers, dragging the axis or the middle button pans, a double click shows the usual range and leaves the isovalue
/// where it was before its first click. Values stand along the axis as options().valueScale has it; extreme outliers
/// are out of view at first, and stated at the border, as the handle is. Events of the topology stand on the axis as
/// marks; pressing one chooses it. Shows values only; whoever listens decides what becomes of a request.
class HistogramPlot : public QCustomPlot {
    Q_OBJECT
public:
    explicit HistogramPlot(QWidget* parent = nullptr);

    /// `activeEdges`: over the whole range, in equal bins; empty: there is no curve of the surface's size.
    void setValues(std::shared_ptr<const ValueDistribution> values, const std::vector<std::uint64_t>& activeEdges);
    void clearHistogram();
    void setIsovalues(double requested, double displayed);
    void setOptions(const model::HistogramOptions& options);
    /// Ascending by isovalue. `describe` gives the tool tip of one; empty if there are no marks.
    void setEventMarks(std::vector<EventMark> marks, std::function<QString(std::size_t event)> describe);
    void setChosenEvent(std::optional<std::size_t> event);
    const EventMarks& eventMarks() const { return *marks_; }
    HistogramHints& hints() { return *hints_; }
    /// Leaves so many pixels above the handle's tag to what stands over the plot.
    void setRoomAbove(int pixels);
    int roomAbove() const;

    /// Without extreme outliers and fill values.
    void showUsualRange();
    void showWholeRange();
    void showHandle();
    /// As far as there are such values.
    void showRange(const model::HistogramRange& range);
    /// What the user chose to see; none: the usual range.
    std::optional<model::HistogramRange> chosenRange() const;
    /// About the handle if it is in view, the middle otherwise. Above 1: closer.
    void zoom(double factor);

    const model::HistogramView& view() const { return view_; }
    const model::ValueScale& scale() const { return scale_; }
    double minimum() const { return min_; }
    double maximum() const { return max_; }
    double requested() const { return requested_; }
    bool hasHistogram() const { return hasHistogram_; }
    double pixelOf(double value) const { return xAxis->coordToPixel(scale_.placeOf(value)); }
    /// None where the value is out of view, or has no place on the axis.
    std::optional<double> visiblePixelOf(double value) const;
    double valueAtPixel(double pixel) const { return scale_.valueAt(xAxis->pixelToCoord(pixel)); }
    QCPRange visibleRange() const {
        return {scale_.valueAt(xAxis->range().lower), scale_.valueAt(xAxis->range().upper)};
    }
    /// Of the step that is drawn there.
    std::optional<model::HistogramView::Readout> readoutAt(double pixel) const {
        return view_.readout(outline_, scale_, xAxis->pixelToCoord(pixel));
    }
    /// How much the value changes from pixel to pixel at it.
    double resolutionAt(double value) const;
    /// What a step is at the present zoom and handle.
    model::StepRule stepRule() const;
    /// 0 to 1 along the usual range, or the whole one for a handle outside; and back.
    double shareOf(double value) const;
    double valueAtShare(double share) const;

Q_SIGNALS:
    void isovalueRequested(double isovalue);
    void stepRequested(double rangeFraction);
    void eventPressed(std::size_t event); ///< its mark was
    /// The handle is held with the mouse, or no longer.
    void handleHeld(bool isHeld);
    /// Range, scale or size are others.
    void viewChanged();
    void scaleChanged();

protected:
    bool event(QEvent* event) override;
    void paintEvent(QPaintEvent* event) override;
    void mousePressEvent(QMouseEvent* event) override;
    void mouseMoveEvent(QMouseEvent* event) override;
    void mouseReleaseEvent(QMouseEvent* event) override;
    void mouseDoubleClickEvent(QMouseEvent* event) override;
    void leaveEvent(QEvent* event) override;
    void wheelEvent(QWheelEvent* event) override;
    void keyPressEvent(QKeyEvent* event) override;
    void changeEvent(QEvent* event) override;
    void resizeEvent(QResizeEvent* event) override;
    void focusInEvent(QFocusEvent* event) override;
    void focusOutEvent(QFocusEvent* event) override;

private:
    enum class Drag { None, Handle, Pan, Zoom };

    void setUpAxes();
    void setUpHandle();
    void applyPalette();
    void applyScale();
    void applyOutline();
    void applyTickCounts();
    void markClipped(const model::HistogramView::Outline& outline);
    void applyFocus();
    QCPRange endsOf(const model::HistogramView::Range& range) const;
    /// The same with some room at both ends.
    QCPRange placesOf(const model::HistogramView::Range& range) const;
    void showPlaces(const QCPRange& places);
    void clampRange(const QCPRange& range);
    void placeHandle();
    void zoomAt(double place, double factor);
    void zoomToSelection();
    void showCursor(QPointF place);
    void showHover(QPointF place);
    void requestDragged(bool isFine);
    double soughtValue(double value, bool isFine) const;
    const EventMark* markToPress(QPointF place) const;
    double placePerPixel() const;

    QCPGraph* counts_ = nullptr;
    QCPGraph* activeEdges_ = nullptr;
    QCPItemStraightLine* requestedLine_ = nullptr;
    QCPItemStraightLine* displayedLine_ = nullptr;
    QCPItemStraightLine* hoverLine_ = nullptr;
    QCPItemText* tag_ = nullptr;
    std::vector<QCPItemText*> clipped_; ///< one for each tower that is cut, the highest ones
    QCPItemText* emptyHint_ = nullptr;
    EventMarks* marks_ = nullptr;
    HistogramHints* hints_ = nullptr;
    QRubberBand* selection_ = nullptr;
    QSharedPointer<ScaleTicker> ticker_;
    std::function<QString(std::size_t)> describeEvent_;
    model::HistogramView view_;
    model::HistogramView::Outline outline_; ///< as it is drawn
    model::HistogramOptions options_;
    model::ValueScale scale_;
    std::vector<std::uint64_t> activeEdgeCounts_;
    std::shared_ptr<const std::vector<double>> sampleValues_; ///< if they are known and few
    double min_ = 0.0, max_ = 0.0, requested_ = 0.0, displayed_ = 0.0;
    double dragPlace_ = 0.0;
    QPointF dragPoint_, dragBegin_;
    std::optional<double> valueBeforePress_; ///< of a press that may become a double click
    QElapsedTimer sincePress_;
    Drag drag_ = Drag::None;
    bool hasHistogram_ = false;
    bool isAtUsualRange_ = true; ///< until the user chooses another
};

} // namespace isoslider::widgets
