#include "ui/widgets/opening/slice_view.h"

#include "ui/widgets/common/text_colour.h"

#include <array>
#include <cmath>

#include <QPainter>

namespace isoslider::widgets {
namespace {

constexpr int kCaptionSpace = 6;
const QColor kGround(22, 24, 28);
const QColor kMissing(92, 52, 112); // no grey: cannot be taken for a sample
/// Thinner than this, a plane of a long volume is drawn out of proportion rather than as a line.
constexpr double kMostAspect = 12.0;

QString nameOf(int axis) { return QString(QLatin1Char("XYZ"[axis])); }

QImage pictureOf(const model::SliceImage& slice) {
    QImage image(slice.width, slice.height, QImage::Format_RGB32);
    auto shade = slice.shades.begin();
    for (int row = 0; row < slice.height; ++row) {
        const int line = slice.axis == 2 ? row : slice.height - 1 - row;
        auto* pixels = reinterpret_cast<QRgb*>(image.scanLine(line));
        for (int column = 0; column < slice.width; ++column, ++shade)
            pixels[column] = *shade == model::SliceImage::kMissing ? kMissing.rgb() : qRgb(*shade, *shade, *shade);
    }
    return image;
}

} // namespace

SliceView::SliceView(int axis, QWidget* parent) : QWidget(parent), axis_(axis) {
    setObjectName(QStringLiteral("slice") + nameOf(axis));
    setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Expanding);
    clear();
}

void SliceView::setSlice(const model::SliceImage& slice, const model::AxisNames& names) {
    image_ = pictureOf(slice);
    aspect_ = slice.width * slice.pixelWidth / (slice.height * slice.pixelHeight);
    if (!std::isfinite(aspect_))
        aspect_ = 1.0;
    aspect_ = std::clamp(aspect_, 1.0 / kMostAspect, kMostAspect);
    const auto nameOf = [&names](int axis) { return QString::fromStdString(names.nameOf(axis)); };
    const QString across = nameOf(axis_), right = nameOf(axis_ == 0 ? 1 : 0).toLower(),
                  upright = nameOf(axis_ == 2 ? 1 : 2).toLower();
    const QString ways = (axis_ == 2 ? tr("%1 → %2 ↓") : tr("%1 → %2 ↑")).arg(right, upright);
    const bool isKnown = slice.position >= 0;
    const QString plane = isKnown ? tr("%1 = %2").arg(across).arg(slice.position) : tr("middle of %1").arg(across);
    caption_ = QStringLiteral("%1    %2").arg(plane, ways);
    setAccessibleName(tr("Middle slice, %1").arg(plane));
    setToolTip(isKnown ? tr("Slice through the middle: grid point %1 along %2").arg(slice.position).arg(across)
                       : QString());
    update();
}

void SliceView::clear() {
    image_ = QImage();
    caption_ = nameOf(axis_);
    setAccessibleName(tr("Middle slice across %1, not there yet").arg(nameOf(axis_)));
    setToolTip(QString());
    update();
}

void SliceView::setStale(bool isStale) {
    if (std::exchange(isStale_, isStale) != isStale)
        update();
}

QRectF SliceView::imageRect() const {
    const int top = fontMetrics().height() + kCaptionSpace;
    const QRectF room = QRectF(rect()).adjusted(0, top, 0, 0);
    QSizeF size(aspect_, 1.0);
    size.scale(room.size() - QSizeF(8.0, 8.0), Qt::KeepAspectRatio);
    QRectF place(QPointF(), size);
    place.moveCenter(room.center());
    return place;
}

void SliceView::paintEvent(QPaintEvent*) {
    QPainter painter(this);
    painter.setRenderHint(QPainter::Antialiasing);
    painter.setPen(quietTextColour(palette()));
    painter.drawText(QRect(0, 0, width(), fontMetrics().height()), Qt::AlignHCenter | Qt::AlignVCenter, caption_);
    const QRectF ground = QRectF(rect()).adjusted(0, fontMetrics().height() + kCaptionSpace, 0, 0);
    painter.setPen(Qt::NoPen);
    painter.setBrush(kGround);
    painter.drawRoundedRect(ground, 4.0, 4.0);
    if (image_.isNull())
        return;
    const QRectF place = imageRect();
    // Enlarged a lot, samples are shown as what they are.
    painter.setRenderHint(QPainter::SmoothPixmapTransform, place.width() < 3.0 * image_.width());
    painter.setOpacity(isStale_ ? 0.45 : 1.0);
    painter.drawImage(place, image_);
}

} // namespace isoslider::widgets
