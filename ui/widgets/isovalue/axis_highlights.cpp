#include "ui/widgets/isovalue/axis_highlights.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <QHelpEvent>
#include <QToolTip>

#include "ui/model/isovalue/number_text.h"
#include "ui/widgets/isovalue/histogram_plot.h"
#include "ui/widgets/isovalue/plot_style.h"

namespace isoslider::widgets {
namespace {

constexpr double kStarRadius = 5.5;
constexpr double kStarDepth = 7.0; // of its middle below the upper edge
constexpr double kHitPixels = 7.0;
constexpr double kHandlePixels = 6.0; // there, a press takes the handle
constexpr double kFlagPixels = 7.0;
constexpr double kLeastBandPixels = 2.0;
const QString kLayer = QStringLiteral("marks");

QPolygonF star(QPointF centre) {
    QPolygonF shape;
    for (int corner = 0; corner < 10; ++corner) {
        const double angle = (corner - 2.5) * std::numbers::pi / 5.0;
        const double radius = corner % 2 == 0 ? kStarRadius : 0.42 * kStarRadius;
        shape << centre + radius * QPointF(std::cos(angle), std::sin(angle));
    }
    return shape;
}

} // namespace

AxisHighlights::AxisHighlights(HistogramPlot& plot) : QCPLayerable(&plot, kLayer), plot_(plot) {
    setParent(&plot);
    plot_.installEventFilter(this);
}

void AxisHighlights::setFound(std::vector<topology::IsovalueInterval> intervals) {
    found_ = std::move(intervals);
    redraw();
}

void AxisHighlights::setSuggestions(std::vector<model::SuggestedIsovalue> suggestions) {
    suggestions_ = std::move(suggestions);
    redraw();
}

void AxisHighlights::setReference(std::optional<double> isovalue) {
    if (isovalue == reference_)
        return;
    reference_ = isovalue;
    redraw();
}

void AxisHighlights::redraw() { plot_.layer(kLayer)->replot(); }

std::optional<QPointF> AxisHighlights::placeOf(std::size_t suggestion) const {
    const auto pixel =
        suggestion < suggestions_.size() ? plot_.visiblePixelOf(suggestions_[suggestion].isovalue) : std::nullopt;
    return pixel ? std::optional(QPointF(*pixel, plot_.axisRect()->top() + kStarDepth)) : std::nullopt;
}

const model::SuggestedIsovalue* AxisHighlights::suggestionAt(QPointF place) const {
    const model::SuggestedIsovalue* nearest = nullptr;
    double least = kHitPixels;
    for (std::size_t i = 0; i < suggestions_.size(); ++i) {
        const auto centre = placeOf(i);
        if (!centre || std::abs(centre->y() - place.y()) > kHitPixels)
            continue;
        const double away = std::abs(centre->x() - place.x());
        if (away < least || (nearest == nullptr && away <= least)) { // of two in one place, the better
            nearest = &suggestions_[i];
            least = away;
        }
    }
    return nearest;
}

QString AxisHighlights::tipAt(QPointF place) const {
    if (const auto* suggestion = suggestionAt(place))
        return tr("Suggested isovalue\n%1").arg(QString::fromStdString(model::suggestionText(*suggestion)));
    const auto pixel = reference_ ? plot_.visiblePixelOf(*reference_) : std::nullopt;
    if (pixel && std::abs(*pixel - place.x()) <= kHitPixels && place.y() >= plot_.axisRect()->top() - 2 &&
        place.y() <= plot_.axisRect()->top() + 2 * kFlagPixels)
        return tr("Reference isovalue %1").arg(QString::fromStdString(model::valueText(*reference_, 7)));
    return {};
}

bool AxisHighlights::eventFilter(QObject* watched, QEvent* event) {
    if (watched != &plot_)
        return QCPLayerable::eventFilter(watched, event);
    if (event->type() == QEvent::ToolTip) {
        const auto* help = static_cast<QHelpEvent*>(event);
        const QString tip = tipAt(help->pos());
        if (tip.isEmpty())
            return false;
        QToolTip::showText(help->globalPos(), tip, &plot_, QRect(help->pos() - QPoint(4, 4), QSize(9, 9)));
        return true;
    }
    const bool isPress = event->type() == QEvent::MouseButtonPress || event->type() == QEvent::MouseButtonDblClick;
    if (!isPress && event->type() != QEvent::MouseMove)
        return false;
    const auto* mouse = static_cast<QMouseEvent*>(event);
    const auto* suggestion = suggestionAt(mouse->position());
    const bool isOnHandle = std::abs(plot_.pixelOf(plot_.requested()) - mouse->position().x()) <= kHandlePixels;
    if (suggestion == nullptr || isOnHandle)
        return false;
    if (!isPress) { // once the plot has set its own
        if (mouse->buttons() == Qt::NoButton)
            QMetaObject::invokeMethod(
                &plot_, [this] { plot_.setCursor(Qt::PointingHandCursor); }, Qt::QueuedConnection);
        return false;
    }
    if (mouse->button() != Qt::LeftButton || mouse->modifiers().testFlag(Qt::ShiftModifier))
        return false;
    Q_EMIT suggestionPressed(suggestion->isovalue);
    return true;
}

void AxisHighlights::applyDefaultAntialiasingHint(QCPPainter* painter) const { painter->setAntialiasing(true); }

QRect AxisHighlights::clipRect() const { return plot_.axisRect()->rect().adjusted(-8, -2, 8, 2); }

void AxisHighlights::draw(QCPPainter* painter) {
    drawFound(painter);
    drawReference(painter);
    for (std::size_t i = suggestions_.size(); i-- > 0;) // the best on top
        if (const auto centre = placeOf(i))
            drawStar(painter, *centre);
}

void AxisHighlights::drawFound(QCPPainter* painter) {
    const QRect rect = plot_.axisRect()->rect();
    const QCPRange range = plot_.visibleRange();
    QColor band = plot_.palette().color(QPalette::Highlight), edge = band;
    band.setAlpha(46);
    edge.setAlpha(210);
    painter->setPen(Qt::NoPen);
    for (const auto& interval : found_) {
        if (interval.above < range.lower || interval.below > range.upper)
            continue;
        double left = plot_.pixelOf(std::max(interval.below, range.lower));
        double width = plot_.pixelOf(std::min(interval.above, range.upper)) - left;
        if (!std::isfinite(left) || !std::isfinite(width))
            continue;
        if (width < kLeastBandPixels) {
            left -= 0.5 * (kLeastBandPixels - width);
            width = kLeastBandPixels;
        }
        painter->setBrush(band);
        painter->drawRect(QRectF(left, rect.top(), width, rect.height()));
        painter->setBrush(edge);
        painter->drawRect(QRectF(left, rect.bottom() - 2.0, width, 4.0));
    }
}

void AxisHighlights::drawReference(QCPPainter* painter) {
    const auto pixel = reference_ ? plot_.visiblePixelOf(*reference_) : std::nullopt;
    if (!pixel)
        return;
    const QRect rect = plot_.axisRect()->rect();
    const QColor colour = plot_.palette().color(QPalette::Text);
    painter->setPen(QPen(colour, 1.2));
    painter->drawLine(QPointF(*pixel, rect.top()), QPointF(*pixel, rect.bottom()));
    painter->setBrush(colour);
    const QPointF top(*pixel, rect.top());
    painter->drawPolygon(
        QPolygonF({top, top + QPointF(1.3 * kFlagPixels, 0.5 * kFlagPixels), top + QPointF(0.0, kFlagPixels)}));
}

void AxisHighlights::drawStar(QCPPainter* painter, QPointF centre) {
    painter->setPen(QPen(plot_.palette().color(QPalette::Base), 1.0));
    painter->setBrush(plotColours(plot_.palette()).handle);
    painter->drawPolygon(star(centre));
}

} // namespace isoslider::widgets
