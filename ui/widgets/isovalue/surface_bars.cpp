#include "ui/widgets/isovalue/surface_bars.h"

#include <cmath>

#include <QHelpEvent>
#include <QToolTip>

#include "ui/model/isovalue/number_text.h"
#include "ui/widgets/common/text_colour.h"
#include "ui/widgets/isovalue/histogram_plot.h"

namespace isoslider::widgets {
namespace {

constexpr double kHitPixels = 5.0; // within what the plot takes for a press on its handle
constexpr double kGripWidth = 11.0, kGripHeight = 12.0; // above the upper edge
const QString kLayer = QStringLiteral("marks");

QColor colourOf(const model::ListedSurface& surface) {
    return {surface.colour[0], surface.colour[1], surface.colour[2]};
}

} // namespace

SurfaceBars::SurfaceBars(HistogramPlot& plot) : QCPLayerable(&plot, kLayer), plot_(plot) {
    setParent(&plot);
    plot_.installEventFilter(this);
}

void SurfaceBars::show(const model::SurfaceList& list) {
    std::vector<model::ListedSurface> inactive;
    for (const model::ListedSurface& surface : list.surfaces)
        if (surface.id != list.active)
            inactive.push_back(surface);
    if (inactive == inactive_)
        return; // the handle moves: nothing here does
    inactive_ = std::move(inactive);
    plot_.layer(kLayer)->replot();
}

std::optional<QPointF> SurfaceBars::gripOf(model::SurfaceId id) const {
    for (const model::ListedSurface& surface : inactive_)
        if (const auto pixel = plot_.visiblePixelOf(surface.isovalue); pixel && surface.id == id)
            return QPointF(*pixel, plot_.axisRect()->top() - kGripHeight / 2.0);
    return std::nullopt;
}

const model::ListedSurface* SurfaceBars::surfaceAt(QPointF place) const {
    if (place.y() < plot_.axisRect()->top() - kGripHeight || place.y() > plot_.axisRect()->bottom())
        return nullptr;
    const model::ListedSurface* nearest = nullptr;
    // Where a bar is as close as the handle, the handle is meant.
    double least = std::min(kHitPixels, std::abs(plot_.pixelOf(plot_.requested()) - place.x()));
    for (const model::ListedSurface& surface : inactive_) {
        const auto pixel = plot_.visiblePixelOf(surface.isovalue);
        if (pixel && std::abs(*pixel - place.x()) < least) {
            nearest = &surface;
            least = std::abs(*pixel - place.x());
        }
    }
    return nearest;
}

QString SurfaceBars::tipAt(QPointF place) const {
    const auto* surface = surfaceAt(place);
    if (surface == nullptr)
        return {};
    return tr("%1, isovalue %2\nDrag to slide it")
        .arg(QString::fromStdString(surface->name), QString::fromStdString(model::valueText(surface->isovalue, 7)));
}

bool SurfaceBars::eventFilter(QObject* watched, QEvent* event) {
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
    const bool isPress = event->type() == QEvent::MouseButtonPress;
    if (!isPress && event->type() != QEvent::MouseMove)
        return false;
    const auto* mouse = static_cast<QMouseEvent*>(event);
    const auto* surface = surfaceAt(mouse->position());
    if (surface == nullptr)
        return false;
    if (!isPress) { // once the plot has set its own
        if (mouse->buttons() == Qt::NoButton)
            QMetaObject::invokeMethod(
                &plot_, [this] { plot_.setCursor(Qt::SizeHorCursor); }, Qt::QueuedConnection);
    } else if (mouse->button() == Qt::LeftButton && mouse->modifiers() == Qt::NoModifier) {
        Q_EMIT pressed(surface->id);
    }
    return false;
}

void SurfaceBars::applyDefaultAntialiasingHint(QCPPainter* painter) const { painter->setAntialiasing(true); }

QRect SurfaceBars::clipRect() const {
    const int above = static_cast<int>(kGripHeight) + 2;
    return plot_.axisRect()->rect().adjusted(-8, -above, 8, 0);
}

void SurfaceBars::draw(QCPPainter* painter) {
    const QRect rect = plot_.axisRect()->rect();
    const QColor rim = quietTextColour(plot_.palette(), QPalette::Text, QPalette::Base);
    for (const model::ListedSurface& surface : inactive_) {
        const auto pixel = plot_.visiblePixelOf(surface.isovalue);
        if (!pixel)
            continue;
        const QColor colour = colourOf(surface);
        const QPointF top(*pixel, rect.top()), bottom(*pixel, rect.bottom());
        const Qt::PenStyle style = surface.isVisible ? Qt::SolidLine : Qt::DotLine;
        QColor around = rim;
        around.setAlpha(120); // pale colours are seen on a pale plot, too
        painter->setPen(QPen(around, 4.0, style, Qt::FlatCap));
        painter->drawLine(top, bottom);
        painter->setPen(QPen(colour, 2.0, style, Qt::FlatCap));
        painter->drawLine(top, bottom);
        painter->setPen(QPen(rim, 1.0));
        painter->setBrush(surface.isVisible ? QBrush(colour) : QBrush(Qt::NoBrush));
        const QPointF left(-kGripWidth / 2.0, -kGripHeight), right(kGripWidth / 2.0, -kGripHeight);
        const QPointF down(0.0, kGripWidth / 2.0 - kGripHeight + 3.0);
        painter->drawPolygon(QPolygonF(
            {top + left, top + right, top + QPointF(right.x(), down.y()), top, top + QPointF(left.x(), down.y())}));
    }
}

} // namespace isoslider::widgets
