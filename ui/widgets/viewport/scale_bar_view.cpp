#include "ui/widgets/viewport/scale_bar_view.h"

#include <algorithm>
#include <cmath>

#include <QEvent>
#include <QFontMetrics>
#include <QPainter>

namespace isoslider::widgets {
namespace {

constexpr int kPadding = 7;
constexpr int kBarGap = 4; // between the text and the bar
constexpr double kThickness = 2.0;
constexpr double kTick = 7.0; // height of the ends
const QColor kPlate(20, 22, 26, 200); // words are legible on it whatever is behind
const QColor kInk(238, 241, 245);

} // namespace

ScaleBarView::ScaleBarView(QWidget* parent) : QWidget(parent) {
    setObjectName(QStringLiteral("scaleBar"));
    setAttribute(Qt::WA_TransparentForMouseEvents);
}

void ScaleBarView::setBar(const model::ScaleBar& bar, const QString& text) {
    bar_ = bar;
    text_ = text;
    setAccessibleName(tr("Scale bar, %1").arg(text_));
    resize(sizeHint());
    update();
}

QSize ScaleBarView::sizeHint() const {
    const QFontMetrics metrics = fontMetrics();
    const int length = static_cast<int>(std::ceil(bar_.pixels));
    return {std::max(length, metrics.horizontalAdvance(text_)) + 2 * kPadding,
            metrics.height() + kBarGap + static_cast<int>(kTick) + 2 * kPadding - 2};
}

void ScaleBarView::paint(QPainter& painter) const {
    painter.save();
    painter.setRenderHint(QPainter::Antialiasing);
    painter.setPen(Qt::NoPen);
    painter.setBrush(kPlate);
    painter.drawRoundedRect(rect(), 5.0, 5.0);
    const double bottom = height() - kPadding, left = std::floor((width() - bar_.pixels) / 2.0);
    painter.setBrush(kInk);
    painter.drawRect(QRectF(left, bottom - kThickness, bar_.pixels, kThickness));
    for (const double end : {left, left + bar_.pixels - kThickness})
        painter.drawRect(QRectF(end, bottom - kTick, kThickness, kTick));
    painter.setPen(kInk);
    painter.setFont(font());
    painter.drawText(QRect(0, kPadding - 2, width(), fontMetrics().height()), Qt::AlignCenter, text_);
    painter.restore();
}

void ScaleBarView::paintEvent(QPaintEvent*) {
    QPainter painter(this);
    paint(painter);
}

void ScaleBarView::changeEvent(QEvent* event) {
    QWidget::changeEvent(event);
    if (event->type() == QEvent::FontChange)
        resize(sizeHint());
}

} // namespace isoslider::widgets
