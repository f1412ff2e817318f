#include "ui/widgets/viewport/box_ticks_view.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <QFontMetricsF>
#include <QPainter>

namespace isoslider::widgets {
namespace {

constexpr double kTickLength = 6.0;
constexpr double kTickGap = 4.0; // from a tick to its number
const QColor kInk(226, 230, 236), kInkOnLight(40, 44, 50);

/// The box of a text whose near side lies at `place`.
QRectF beside(QPointF place, QPointF outwards, QSizeF size) {
    const QPointF middle = place + QPointF(outwards.x() * size.width() / 2.0, outwards.y() * size.height() / 2.0);
    return {middle.x() - size.width() / 2.0, middle.y() - size.height() / 2.0, size.width(), size.height()};
}

} // namespace

BoxTicksView::BoxTicksView(QWidget* parent) : QWidget(parent) {
    setObjectName(QStringLiteral("boxTicks"));
    setAttribute(Qt::WA_TransparentForMouseEvents);
}

void BoxTicksView::setEdges(std::vector<Edge> edges, bool isOnLight) {
    if (edges == edges_ && isOnLight == isOnLight_)
        return;
    edges_ = std::move(edges);
    isOnLight_ = isOnLight;
    QString all;
    for (const Edge& edge : edges_)
        all += (all.isEmpty() ? QString() : QStringLiteral(", ")) + edge.title;
    setAccessibleName(tr("Axes with ticks: %1").arg(all));
    update();
}

void BoxTicksView::paint(QPainter& painter) const {
    painter.save();
    painter.setRenderHint(QPainter::Antialiasing);
    painter.setFont(font());
    painter.setPen(QPen(isOnLight_ ? kInkOnLight : kInk, 1.2));
    for (const Edge& edge : edges_)
        paintEdge(painter, edge);
    painter.restore();
}

void BoxTicksView::paintEdge(QPainter& painter, const Edge& edge) const {
    const QFontMetricsF metrics(font());
    painter.drawLine(edge.from, edge.to);
    double widest = 0.0;
    for (const auto& [place, number] : edge.ticks) {
        painter.drawLine(place, place + edge.outwards * kTickLength);
        const QSizeF size(metrics.horizontalAdvance(number), metrics.height());
        painter.drawText(beside(place + edge.outwards * (kTickLength + kTickGap), edge.outwards, size), Qt::AlignCenter,
                         number);
        widest =
            std::max(widest, std::abs(edge.outwards.x()) * size.width() + std::abs(edge.outwards.y()) * size.height());
    }
    QFont bold = font();
    bold.setBold(true);
    painter.setFont(bold);
    const QSizeF size(QFontMetricsF(bold).horizontalAdvance(edge.title), metrics.height());
    painter.drawText(beside((edge.from + edge.to) / 2.0 + edge.outwards * (kTickLength + 2.0 * kTickGap + widest),
                            edge.outwards, size),
                     Qt::AlignCenter, edge.title);
    painter.setFont(font());
}

void BoxTicksView::paintEvent(QPaintEvent*) {
    QPainter painter(this);
    paint(painter);
}

} // namespace isoslider::widgets
