#include "ui/widgets/isovalue/histogram_plot.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <QApplication>
#include <QHelpEvent>
#include <QToolTip>

#include "ui/model/isovalue/histogram_model.h"
#include "ui/model/isovalue/isovalue_model.h"
#include "ui/model/isovalue/number_text.h"
#include "ui/widgets/common/text_colour.h"
#include "ui/widgets/isovalue/isovalue_accessible.h"
#include "ui/widgets/isovalue/plot_style.h"

namespace isoslider::widgets {
namespace {

constexpr int kGrabPixels = 6;
constexpr double kSnapPixels = 6.0;
constexpr double kZoomPerNotch = 1.25;
constexpr double kNotch = 120.0;
constexpr double kSmallestRange = 1e-6; // of the whole
constexpr int kMostTicks = 9;
constexpr int kLowHeight = 90; // below it, there is room for the curve but not for its scale

} // namespace

HistogramPlot::HistogramPlot(QWidget* parent) : QCustomPlot(parent) {
    installIsovalueAccessibility(); // before assistive technology hears of this: what it is then, it stays
    setObjectName(QStringLiteral("histogramPlot"));
    setFocusPolicy(Qt::StrongFocus);
    setMinimumSize(120, 40);
    setAccessibleName(tr("Isovalue"));
    setWhatsThis(tr("Drag to move the isosurface; Shift makes the drag finer; Ctrl with the wheel zooms."));
    setUpAxes();
    setUpHandle();
    applyPalette();
    clearHistogram();
}

void HistogramPlot::setUpAxes() {
    plotLayout()->setMargins(QMargins(0, 0, 4, 0));
    axisRect()->setAutoMargins(QCP::msLeft | QCP::msRight | QCP::msBottom);
    axisRect()->setMargins(QMargins(0, 20, 0, 0));
    axisRect()->setMinimumMargins(QMargins(44, 20, 44, 0));
    axisRect()->setRangeDrag(Qt::Orientations());
    counts_ = addGraph(xAxis, yAxis);
    counts_->setLineStyle(QCPGraph::lsStepLeft);
    activeEdges_ = addGraph(xAxis, yAxis2);
    yAxis->setTicker(QSharedPointer<CompactTicker>::create());
    yAxis2->setTicker(QSharedPointer<CompactTicker>::create());
    xAxis->ticker()->setTickCount(kMostTicks);
    connect(xAxis, qOverload<const QCPRange&>(&QCPAxis::rangeChanged), this, &HistogramPlot::clampRange);
}

void HistogramPlot::setUpHandle() {
    // Each has a buffer: when the handle moves, neither the histogram nor the marks are drawn again.
    QString below = QStringLiteral("overlay");
    for (const QString& name : {QStringLiteral("marks"), QStringLiteral("handle")}) {
        addLayer(name, layer(std::exchange(below, name)));
        layer(name)->setMode(QCPLayer::lmBuffered);
    }
    marks_ = new EventMarks(*this, QStringLiteral("marks"));
    displayedLine_ = new QCPItemStraightLine(this);
    requestedLine_ = new QCPItemStraightLine(this);
    tag_ = new QCPItemText(this);
    for (QCPAbstractItem* item : {static_cast<QCPAbstractItem*>(displayedLine_),
                                  static_cast<QCPAbstractItem*>(requestedLine_), static_cast<QCPAbstractItem*>(tag_)})
        item->setLayer(QStringLiteral("handle"));
    tag_->setClipToAxisRect(false);
    tag_->position->setTypeY(QCPItemPosition::ptAxisRectRatio);
    tag_->setPositionAlignment(Qt::AlignHCenter | Qt::AlignBottom);
    tag_->setPadding(QMargins(6, 1, 6, 2));
    emptyHint_ = new QCPItemText(this);
    emptyHint_->position->setType(QCPItemPosition::ptViewportRatio);
    emptyHint_->position->setCoords(0.5, 0.5);
}

void HistogramPlot::setHistogram(const Histogram& histogram, ScalarType type,
                                 const std::vector<std::uint64_t>& activeEdgesPerBin) {
    const bool isSameRange = hasHistogram_ && min_ == histogram.min && max_ == histogram.max;
    min_ = histogram.min;
    max_ = histogram.max;
    hasHistogram_ = true;
    auto outline = model::outlineOf(histogram, model::drawableBins(histogram, type));
    QVector<double> values(outline.values.begin(), outline.values.end());
    QVector<double> counts(outline.counts.begin(), outline.counts.end());
    if (!counts.isEmpty()) {
        values.append(max_);
        counts.append(counts.last());
    }
    counts_->setData(values, counts, true);
    QVector<double> places, edges;
    for (std::size_t bin = 0; bin < activeEdgesPerBin.size(); ++bin) {
        places.append(std::lerp(min_, max_, static_cast<double>(bin) / static_cast<double>(activeEdgesPerBin.size())));
        edges.append(static_cast<double>(activeEdgesPerBin[bin]));
    }
    activeEdges_->setData(places, edges, true);
    for (QCPAxis* axis : {xAxis, yAxis})
        axis->setVisible(true);
    yAxis2->setVisible(!edges.isEmpty());
    emptyHint_->setVisible(false);
    applyVerticalRange();
    if (!isSameRange)
        showWholeRange();
    placeHandle();
    replot();
}

void HistogramPlot::clearHistogram() {
    hasHistogram_ = false;
    min_ = max_ = requested_ = displayed_ = 0.0;
    counts_->data()->clear();
    activeEdges_->data()->clear();
    for (QCPAxis* axis : {xAxis, yAxis, yAxis2})
        axis->setVisible(false);
    emptyHint_->setVisible(true);
    placeHandle();
    replot();
}

void HistogramPlot::setIsovalues(double requested, double displayed) {
    requested_ = requested;
    displayed_ = displayed;
    placeHandle();
    layer(QStringLiteral("handle"))->replot();
}

void HistogramPlot::setLogCounts(bool isLog) {
    isLog_ = isLog;
    applyVerticalRange();
    replot();
}

void HistogramPlot::setEventMarks(std::vector<EventMark> marks, std::function<QString(std::size_t)> describe) {
    marks_->setMarks(std::move(marks));
    describeEvent_ = std::move(describe);
    layer(QStringLiteral("marks"))->replot();
}

void HistogramPlot::setChosenEvent(std::optional<std::size_t> event) {
    marks_->setChosen(event);
    layer(QStringLiteral("marks"))->replot();
}

void HistogramPlot::applyVerticalRange() {
    const auto largest = [](const QCPGraph* graph) {
        double most = 1.0;
        for (const auto& point : *graph->data())
            most = std::max(most, point.value);
        return most;
    };
    if (isLog_) {
        yAxis->setScaleType(QCPAxis::stLogarithmic);
        yAxis->setTicker(QSharedPointer<CompactLogTicker>::create());
        yAxis->setRange(0.7, largest(counts_) * 2.0);
    } else {
        yAxis->setScaleType(QCPAxis::stLinear);
        yAxis->setTicker(QSharedPointer<CompactTicker>::create());
        yAxis->setRange(0.0, largest(counts_) * 1.05);
    }
    applyTickCounts();
    yAxis2->setRange(0.0, largest(activeEdges_) * 1.08);
}

void HistogramPlot::applyTickCounts() {
    const QString hint = tr("The histogram of a volume stands here, with the isovalue handle on it.");
    emptyHint_->setText(fontMetrics().horizontalAdvance(hint) < width() ? hint : tr("Histogram"));
    const int labels = std::clamp(height() / (2 * fontMetrics().height()), 2, 6);
    const bool isLow = height() < kLowHeight;
    for (QCPAxis* axis : {yAxis, yAxis2}) {
        axis->ticker()->setTickCount(labels);
        axis->setTickLabels(!isLow);
    }
    yAxis->setLabel(isLow ? QString() : tr("samples"));
    yAxis2->setLabel(isLow ? QString() : tr("active edges"));
    const int widest = fontMetrics().horizontalAdvance(QStringLiteral("-0000000"));
    xAxis->ticker()->setTickCount(std::clamp(axisRect()->width() / (2 * widest), 1, kMostTicks));
}

void HistogramPlot::showWholeRange() {
    // A volume of one value still gets an axis to stand on.
    const double pad = max_ > min_ ? 0.005 * (max_ - min_) : std::max(std::abs(max_) * 0.01, 0.5);
    xAxis->setRange(min_ - pad, max_ + pad);
    placeHandle();
    replot(QCustomPlot::rpQueuedReplot);
}

void HistogramPlot::clampRange(const QCPRange& range) {
    if (!hasHistogram_ || !(max_ > min_))
        return;
    const double pad = 0.005 * (max_ - min_);
    const double size = std::min(range.size(), max_ - min_ + 2.0 * pad);
    const double lower = std::clamp(range.lower, min_ - pad, std::max(min_ - pad, max_ + pad - size));
    if (range.lower != lower || range.size() != size)
        xAxis->setRange(lower, lower + size);
}

void HistogramPlot::placeHandle() {
    const bool isLagging = hasHistogram_ && displayed_ != requested_;
    requestedLine_->setVisible(hasHistogram_);
    displayedLine_->setVisible(isLagging);
    tag_->setVisible(hasHistogram_ && xAxis->range().contains(requested_));
    requestedLine_->point1->setCoords(requested_, 0.0);
    requestedLine_->point2->setCoords(requested_, 1.0);
    displayedLine_->point1->setCoords(displayed_, 0.0);
    displayedLine_->point2->setCoords(displayed_, 1.0);
    const QString text = QString::fromStdString(model::valueText(requested_, 7));
    tag_->setText(text);
    tag_->position->setCoords(requested_, -0.01);
    // Near an end the tag leans inwards instead of being cut off.
    const double place = hasHistogram_ ? pixelOf(requested_) : 0.0;
    const double half = fontMetrics().horizontalAdvance(text) / 2.0 + 10.0;
    const Qt::AlignmentFlag lean = place - half < 0         ? Qt::AlignLeft
                                   : place + half > width() ? Qt::AlignRight
                                                            : Qt::AlignHCenter;
    tag_->setPositionAlignment(lean | Qt::AlignBottom);
    setAccessibleDescription(hasHistogram_ ? text : tr("no volume"));
    announceValue(*this);
}

double HistogramPlot::valuePerPixel() const { return xAxis->range().size() / std::max(1, axisRect()->width()); }

void HistogramPlot::zoomAt(double pixel, double factor) {
    const QCPRange range = xAxis->range();
    if (factor > 1.0 && range.size() / factor < (max_ - min_) * kSmallestRange)
        return;
    const double fixed = xAxis->pixelToCoord(pixel);
    xAxis->setRange(fixed - (fixed - range.lower) / factor, fixed + (range.upper - fixed) / factor);
    placeHandle();
    replot(QCustomPlot::rpQueuedReplot);
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

// What is dragged moves on below a snapped handle, so that it can leave the event again.
void HistogramPlot::requestDragged(bool isFine) {
    double value = std::clamp(dragValue_, min_, max_);
    if (isSnapping_ && !isFine)
        if (const EventMark* mark = marks_->markNear(pixelOf(value), kSnapPixels))
            value = mark->justPast;
    Q_EMIT isovalueRequested(value);
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
    valueBeforePress_.reset();
    dragPoint_ = event->position();
    if (event->button() == Qt::MiddleButton || (event->button() == Qt::LeftButton && isOnAxis)) {
        drag_ = Drag::Pan;
        setCursor(Qt::ClosedHandCursor);
    } else if (event->button() == Qt::LeftButton) {
        drag_ = Drag::Handle;
        valueBeforePress_ = requested_;
        sincePress_.start();
        const bool isOnHandle = std::abs(event->position().x() - pixelOf(requested_)) <= kGrabPixels;
        const bool isFine = event->modifiers().testFlag(Qt::ShiftModifier);
        const EventMark* mark = isFine ? nullptr : markToPress(event->position());
        dragValue_ = mark != nullptr        ? mark->justPast
                     : isOnHandle || isFine ? requested_
                                            : xAxis->pixelToCoord(event->position().x());
        Q_EMIT handleHeld(true);
        if (mark != nullptr)
            Q_EMIT eventPressed(mark->event);
        else if (!isOnHandle && !isFine)
            requestDragged(isFine);
    }
}

void HistogramPlot::mouseMoveEvent(QMouseEvent* event) {
    const double moved = event->position().x() - dragPoint_.x();
    dragPoint_ = event->position();
    if (drag_ == Drag::Handle) {
        const bool isFine = event->modifiers().testFlag(Qt::ShiftModifier);
        dragValue_ += moved * valuePerPixel() / (isFine ? model::kPrecisionFactor : 1.0);
        requestDragged(isFine);
    } else if (drag_ == Drag::Pan) {
        const double shift = moved * valuePerPixel();
        xAxis->setRange(xAxis->range().lower - shift, xAxis->range().upper - shift);
        placeHandle();
        replot(QCustomPlot::rpQueuedReplot);
    } else if (hasHistogram_) {
        showCursor(event->position());
    }
}

void HistogramPlot::mouseReleaseEvent(QMouseEvent*) {
    if (std::exchange(drag_, Drag::None) == Drag::Handle)
        Q_EMIT handleHeld(false);
    unsetCursor();
}

// The first click of the two has moved the handle by now: waiting for a second one would make every press late.
void HistogramPlot::mouseDoubleClickEvent(QMouseEvent*) {
    if (!hasHistogram_)
        return;
    const auto before = std::exchange(valueBeforePress_, std::nullopt);
    if (before && !sincePress_.hasExpired(QApplication::doubleClickInterval()))
        Q_EMIT isovalueRequested(*before);
    showWholeRange();
}

void HistogramPlot::wheelEvent(QWheelEvent* event) {
    if (!hasHistogram_)
        return;
    // Shift turns a vertical wheel into a horizontal one on some platforms.
    const QPoint angle = event->angleDelta();
    const double notches = (angle.y() != 0 ? angle.y() : angle.x()) / kNotch;
    const bool isOnAxis = event->position().y() > axisRect()->bottom();
    if (event->modifiers().testFlag(Qt::ControlModifier) || isOnAxis)
        zoomAt(event->position().x(), std::pow(kZoomPerNotch, notches));
    else if (event->modifiers().testFlag(Qt::ShiftModifier))
        Q_EMIT stepRequested(notches * model::kFineStep / model::kPrecisionFactor);
    else
        Q_EMIT stepRequested(notches * model::kFineStep);
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
        default: QCustomPlot::keyPressEvent(event); return;
    }
    event->accept();
}

void HistogramPlot::changeEvent(QEvent* event) {
    QCustomPlot::changeEvent(event);
    if (event->type() == QEvent::PaletteChange && counts_ != nullptr) {
        applyPalette();
        replot(QCustomPlot::rpQueuedReplot);
    }
}

void HistogramPlot::resizeEvent(QResizeEvent* event) {
    QCustomPlot::resizeEvent(event);
    applyTickCounts();
    placeHandle();
}

void HistogramPlot::focusInEvent(QFocusEvent* event) {
    QCustomPlot::focusInEvent(event);
    applyFocus();
}

void HistogramPlot::focusOutEvent(QFocusEvent* event) {
    QCustomPlot::focusOutEvent(event);
    applyFocus();
}

void HistogramPlot::applyFocus() {
    tag_->setPen(hasFocus() ? QPen(palette().color(QPalette::Text), 1.0) : Qt::NoPen);
    layer(QStringLiteral("handle"))->replot();
}

void HistogramPlot::applyPalette() {
    const PlotColours colours = plotColours(palette());
    setBackground(palette().brush(QPalette::Base));
    counts_->setPen(QPen(colours.counts, 1.0));
    counts_->setBrush(colours.countsFill);
    activeEdges_->setPen(QPen(colours.curve, 1.4));
    requestedLine_->setPen(QPen(colours.handle, 2.0));
    displayedLine_->setPen(QPen(colours.handle, 1.0, Qt::DashLine));
    tag_->setBrush(colours.handle);
    tag_->setColor(colours.handleText);
    emptyHint_->setColor(quietTextColour(palette(), QPalette::Text, QPalette::Base));
    for (QCPAxis* axis : {xAxis, yAxis, yAxis2})
        styleAxis(axis, palette());
    yAxis2->setLabelColor(colours.curve);
    yAxis2->setTickLabelColor(colours.curve);
    yAxis2->grid()->setVisible(false);
}

} // namespace isoslider::widgets
