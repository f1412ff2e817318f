#include "ui/widgets/viewport/picture_halo.h"

#include <cmath>
#include <numbers>

#include <QPainter>

namespace isoslider::widgets {
namespace {

constexpr int kHaloCopies = 12; // around each point

} // namespace

QImage withHalo(const QImage& drawn, const QColor& colour, double pixels) {
    QImage silhouette = drawn;
    {
        QPainter painter(&silhouette);
        painter.setCompositionMode(QPainter::CompositionMode_SourceIn);
        painter.fillRect(silhouette.rect(), colour);
    }
    QImage result(drawn.size(), QImage::Format_ARGB32_Premultiplied);
    result.fill(Qt::transparent);
    QPainter painter(&result);
    painter.setRenderHint(QPainter::SmoothPixmapTransform);
    for (const double radius : {pixels, pixels / 2.0})
        for (int i = 0; i < kHaloCopies; ++i) {
            const double angle = 2.0 * std::numbers::pi * i / kHaloCopies;
            painter.drawImage(QPointF(radius * std::cos(angle), radius * std::sin(angle)), silhouette);
        }
    painter.drawImage(0, 0, drawn);
    painter.end();
    return result;
}

} // namespace isoslider::widgets
