#include <algorithm>
#include <cmath>
#include <utility>

#include <QApplication>
#include <QHelpEvent>
#include <QRubberBand>
#include <QToolTip>

#include "ui/model/isovalue/value_steps.h"
#include "ui/widgets/isovalue/histogram_hints.h"
#include "ui/widgets/isovalue/histogram_plot.h"

namespace isoslider::widgets {
namespace {

constexpr int kGrabPixels = 6;
constexpr double kSnapPixels = 6.0;
constexpr double kZoomPerNotch = 1.25;
constexpr double kNotch = 120.0;
constexpr int kLeastSelection = 4;

} // namespace

std::optional<double> HistogramPlot::visiblePixelOf(double value) const {
    const QCPRange range = visibleRange();
    if (value < range.lower || value > range.upper || !xAxis->visible())
        return std::nullopt;
    const double pixel = pixelOf(value);
    return std::isfinite(pixel) ? std::optional(pixel) : std::nullopt;
}

// Where mark and handle are close, the nearer one is meant.
const EventMark* HistogramPlot::markToPress(QPointF place) const {
    const EventMark* mark = marks_->markAt(place);
    if (mark == nullptr)
        return nullptr;
    const double toHandle = std::abs(place.x() - pixelOf(requested_));
    return toHandle > kGrabPixels || std::abs(place.x() - pixelOf(mark->isovalue)) <= toHandle ? mark : nullptr;
}

void HistogramPlot::showCursor(QPointF place) {
    const bool isOnHandle = std::abs(place.x() - pixelOf(requested_)) <= kGrabPixels;
    setCursor(place.y() > axisRect()->bottom() ? Qt::OpenHandCursor
              : markToPress(place) != nullptr  ? Qt::PointingHandCursor
              : isOnHandle                     ? Qt::SizeHorCursor
                                               : Qt::ArrowCursor);
}

void HistogramPlot::showHover(QPointF place) {
    const QRect rect = axisRect()->rect();
    const bool isOver = hasHistogram_ && drag_ == Drag::None && place.x() >= rect.left() && place.x() <= rect.right() &&
                        place.y() >= rect.top() - 1 && place.y() <= rect.bottom();
    hoverLine_->setVisible(isOver);
    if (isOver) {
        hoverLine_->point1->setCoords(xAxis->pixelToCoord(place.x()), 0.0);
        hoverLine_->point2->setCoords(xAxis->pixelToCoord(place.x()), 1.0);
        hints_->showReadout(place.x());
    } else {
        hints_->hideReadout();
    }
    layer(QStringLiteral("handle"))->replot();
}

/// The value that a handle dragged to `value` takes: just past an event, a sample's own, or one with no more digits
/// than pixels tell apart. The ends of the range can be reached exactly.
double HistogramPlot::soughtValue(double value, bool isFine) const {
    if (value <= min_ || value >= max_)
        return std::clamp(value, min_, max_);
    if (!isFine) {
        if (options_.snapsToEvents)
            if (const EventMark* mark = marks_->markNear(pixelOf(value), kSnapPixels))
                return mark->justPast;
        if (options_.snapsToSamples)
            if (const auto sample = view_.nearestSample(value))
                return *sample;
    }
    const double resolution = resolutionAt(value) / (isFine ? model::kPrecisionFactor : 1.0);
    return std::clamp(model::nearestMultiple(value, model::roundStep(resolution)), min_, max_);
}

// What is dragged moves on below a snapped handle, so that it can leave the event again.
void HistogramPlot::requestDragged(bool isFine) {
    Q_EMIT isovalueRequested(soughtValue(scale_.valueAt(dragPlace_), isFine));
}

bool HistogramPlot::event(QEvent* event) {
    if (event->type() != QEvent::ToolTip)
        return QCustomPlot::event(event);
    const auto* help = static_cast<QHelpEvent*>(event);
    const EventMark* mark = drag_ == Drag::None ? marks_->markAt(help->pos()) : nullptr;
    if (mark != nullptr && describeEvent_)
        QToolTip::showText(help->globalPos(), describeEvent_(mark->event), this,
                           QRect(help->pos() - QPoint(3, 3), QSize(7, 7)));
    else
        QToolTip::hideText();
    return true;
}

void HistogramPlot::mousePressEvent(QMouseEvent* event) {
    if (!hasHistogram_)
        return;
    const bool isOnAxis = event->position().y() > axisRect()->bottom();
    if (std::exchange(drag_, Drag::None) == Drag::Handle)
        Q_EMIT handleHeld(false); // another button takes over
    selection_->hide();
    valueBeforePress_.reset();
    dragPoint_ = dragBegin_ = event->position();
    if (event->button() == Qt::MiddleButton || (event->button() == Qt::LeftButton && isOnAxis)) {
        drag_ = Drag::Pan;
        setCursor(Qt::ClosedHandCursor);
    } else if (event->button() == Qt::LeftButton && event->modifiers().testFlag(Qt::ControlModifier)) {
        drag_ = Drag::Zoom;
    } else if (event->button() == Qt::LeftButton) {
        drag_ = Drag::Handle;
        valueBeforePress_ = requested_;
        sincePress_.start();
        const bool isOnHandle = std::abs(event->position().x() - pixelOf(requested_)) <= kGrabPixels;
        const bool isFine = event->modifiers().testFlag(Qt::ShiftModifier);
        const EventMark* mark = isFine ? nullptr : markToPress(event->position());
        dragPlace_ = mark != nullptr        ? scale_.placeOf(mark->justPast)
                     : isOnHandle || isFine ? scale_.placeOf(requested_)
                                            : xAxis->pixelToCoord(event->position().x());
        Q_EMIT handleHeld(true);
        if (mark != nullptr)
            Q_EMIT eventPressed(mark->event);
        else if (!isOnHandle && !isFine)
            requestDragged(isFine);
    }
    showHover(event->position());
}

void HistogramPlot::mouseMoveEvent(QMouseEvent* event) {
    const double moved = event->position().x() - dragPoint_.x();
    dragPoint_ = event->position();
    switch (drag_) {
        case Drag::Handle: {
            const bool isFine = event->modifiers().testFlag(Qt::ShiftModifier);
            dragPlace_ += moved * placePerPixel() / (isFine ? model::kPrecisionFactor : 1.0);
            if (moved != 0.0)
                requestDragged(isFine);
            break;
        }
        case Drag::Pan: {
            const double shift = moved * placePerPixel();
            isAtUsualRange_ = isAtUsualRange_ && moved == 0.0;
            showPlaces({xAxis->range().lower - shift, xAxis->range().upper - shift});
            break;
        }
        case Drag::Zoom: {
            const QRect rect = axisRect()->rect();
            const auto within = [&](double x) {
                return static_cast<int>(
                    std::clamp(x, static_cast<double>(rect.left()), static_cast<double>(rect.right())));
            };
            const int from = within(dragBegin_.x()), to = within(dragPoint_.x());
            selection_->setGeometry(std::min(from, to), rect.top(), std::abs(to - from) + 1, rect.height());
            selection_->show();
            break;
        }
        case Drag::None:
            if (hasHistogram_)
                showCursor(event->position());
            break;
    }
    showHover(event->position());
}

void HistogramPlot::mouseReleaseEvent(QMouseEvent*) {
    const Drag ended = std::exchange(drag_, Drag::None);
    if (ended == Drag::Handle)
        Q_EMIT handleHeld(false);
    else if (ended == Drag::Zoom)
        zoomToSelection();
    unsetCursor();
}

void HistogramPlot::zoomToSelection() {
    const QRect selected = selection_->geometry();
    if (!selection_->isVisible() || selected.width() < kLeastSelection)
        return selection_->hide();
    selection_->hide();
    const double width = static_cast<double>(axisRect()->width()) / selected.width();
    const double centre = xAxis->pixelToCoord(selected.center().x() + 0.5);
    const double half = xAxis->range().size() / width / 2.0;
    isAtUsualRange_ = false;
    showPlaces({centre - half, centre + half});
}

// The first click of the two has moved the handle by now: waiting for a second one would make every press late.
void HistogramPlot::mouseDoubleClickEvent(QMouseEvent*) {
    if (!hasHistogram_)
        return;
    const auto before = std::exchange(valueBeforePress_, std::nullopt);
    if (before && !sincePress_.hasExpired(QApplication::doubleClickInterval()))
        Q_EMIT isovalueRequested(*before);
    isAtUsualRange_&& view_.hasOutliers() ? showWholeRange() : showUsualRange();
}

void HistogramPlot::leaveEvent(QEvent* event) {
    QCustomPlot::leaveEvent(event);
    showHover({-1.0, -1.0});
}

void HistogramPlot::wheelEvent(QWheelEvent* event) {
    if (!hasHistogram_)
        return;
    // Shift turns a vertical wheel into a horizontal one on some platforms.
    const QPoint angle = event->angleDelta();
    const double notches = (angle.y() != 0 ? angle.y() : angle.x()) / kNotch;
    const bool isOnAxis = event->position().y() > axisRect()->bottom();
    if (event->modifiers().testFlag(Qt::ControlModifier) || isOnAxis)
        zoomAt(xAxis->pixelToCoord(event->position().x()), std::pow(kZoomPerNotch, notches));
    else if (event->modifiers().testFlag(Qt::ShiftModifier))
        Q_EMIT stepRequested(notches * model::kFineStep / model::kPrecisionFactor);
    else
        Q_EMIT stepRequested(notches * model::kFineStep);
    showHover(event->position());
    event->accept();
}

void HistogramPlot::keyPressEvent(QKeyEvent* event) {
    const bool isFine = event->modifiers().testFlag(Qt::ShiftModifier);
    const bool isLarge = event->modifiers().testFlag(Qt::ControlModifier);
    const double arrow = model::kFineStep / (isFine ? model::kPrecisionFactor : 1.0);
    const double page = (isLarge ? model::kLargePageStep : model::kPageStep) / (isFine ? model::kPrecisionFactor : 1.0);
    switch (event->key()) {
        case Qt::Key_Left:
        case Qt::Key_Down: Q_EMIT stepRequested(-arrow); break;
        case Qt::Key_Right:
        case Qt::Key_Up: Q_EMIT stepRequested(arrow); break;
        case Qt::Key_PageUp: Q_EMIT stepRequested(page); break;
        case Qt::Key_PageDown: Q_EMIT stepRequested(-page); break;
        case Qt::Key_Home: Q_EMIT isovalueRequested(min_); break;
        case Qt::Key_End: Q_EMIT isovalueRequested(max_); break;
        case Qt::Key_Plus: zoom(kZoomPerNotch); break;
        case Qt::Key_Minus: zoom(1.0 / kZoomPerNotch); break;
        default: QCustomPlot::keyPressEvent(event); return;
    }
    event->accept();
}

} // namespace isoslider::widgets
