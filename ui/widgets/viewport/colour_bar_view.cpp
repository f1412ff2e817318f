#include "ui/widgets/viewport/colour_bar_view.h"

#include <algorithm>
#include <cmath>

#include <QEvent>
#include <QFontMetrics>
#include <QLinearGradient>
#include <QPainter>

#include "ui/model/isovalue/number_text.h"

namespace isoslider::widgets {
namespace {

constexpr int kPadding = 8;
constexpr int kScaleGap = 5;
constexpr int kStrip = 16; // width
constexpr int kTick = 5;
constexpr int kMostTitle = 150; // a name of a field may be long
constexpr int kPixelsPerTick = 28;
constexpr int kMostTicks = 9;
constexpr int kStops = 33; // of the gradient
const QColor kPlate(20, 22, 26, 200); // words are legible on it whatever is behind
const QColor kInk(238, 241, 245);
const QColor kQuietInk(188, 194, 202);

QColor toQt(const model::SeenColour& colour) { return QColor::fromRgbF(colour[0], colour[1], colour[2]); }

} // namespace

ColourBarView::ColourBarView(QWidget* parent) : QWidget(parent) {
    setObjectName(QStringLiteral("colourBar"));
    setAttribute(Qt::WA_TransparentForMouseEvents);
}

void ColourBarView::setBar(const Content& content, int height) {
    if (content == content_ && height == wantedHeight_)
        return;
    content_ = content;
    wantedHeight_ = height;
    const auto text = [](double value) { return QString::fromStdString(model::valueText(value, 4)); };
    setAccessibleName(tr("Colour bar, %1, %2 to %3 %4")
                          .arg(content_.title, text(content_.range.low), text(content_.range.high), content_.unit));
    layOut();
    update();
}

void ColourBarView::layOut() {
    const QFontMetrics metrics = fontMetrics();
    resize(width(), wantedHeight_);
    const int room = static_cast<int>(strip().height()) / kPixelsPerTick + 1;
    ticks_ = model::colourTicks(content_.range.low, content_.range.high, std::clamp(room, 2, kMostTicks));
    textWidth_ = 0;
    for (const model::ColourTick& tick : ticks_)
        textWidth_ = std::max(textWidth_, metrics.horizontalAdvance(QString::fromStdString(tick.text)));
    int wanted = kStrip + kTick + kScaleGap + textWidth_;
    for (const QString& line : {content_.title, content_.unit})
        wanted = std::max(wanted, std::min(kMostTitle, metrics.horizontalAdvance(line) + 1));
    if (content_.hasMissing)
        wanted = std::max(wanted, kStrip + kTick + kScaleGap + metrics.horizontalAdvance(tr("no value")) + 1);
    resize(wanted + 2 * kPadding, wantedHeight_);
}

QRectF ColourBarView::strip() const {
    const int line = fontMetrics().height();
    const int above = kPadding + line * (content_.unit.isEmpty() ? 1 : 2) + kScaleGap + line / 2 - 2;
    const int below = kPadding + (content_.hasMissing ? line + kScaleGap : 0) + line / 2 - 2;
    return QRectF(kPadding, above, kStrip, std::max(1, wantedHeight_ - above - below));
}

double ColourBarView::yOf(double value) const {
    const QRectF bar = strip();
    const auto& range = content_.range;
    return bar.bottom() - (value - range.low) / (range.high - range.low) * bar.height();
}

void ColourBarView::paint(QPainter& painter) const {
    painter.save();
    painter.setRenderHint(QPainter::Antialiasing);
    painter.setPen(Qt::NoPen);
    painter.setBrush(kPlate);
    painter.drawRoundedRect(rect(), 5.0, 5.0);
    painter.setFont(font());
    const QFontMetrics metrics = fontMetrics();
    const int line = metrics.height(), room = width() - 2 * kPadding;
    painter.setPen(kInk);
    painter.drawText(QRect(kPadding, kPadding, room, line), Qt::AlignLeft | Qt::AlignVCenter,
                     metrics.elidedText(content_.title, Qt::ElideMiddle, room));
    painter.setPen(kQuietInk);
    painter.drawText(QRect(kPadding, kPadding + line, room, line), Qt::AlignLeft | Qt::AlignVCenter, content_.unit);
    const QRectF bar = strip();
    QLinearGradient gradient(bar.bottomLeft(), bar.topLeft());
    const auto colours = model::coloursOf(content_.map, content_.isReversed, kStops);
    for (int stop = 0; stop < kStops; ++stop)
        gradient.setColorAt(static_cast<double>(stop) / (kStops - 1), toQt(colours[static_cast<std::size_t>(stop)]));
    painter.setPen(QPen(kQuietInk, 1.0));
    painter.setBrush(gradient);
    painter.drawRect(bar);
    painter.setPen(QPen(kInk, 1.0));
    for (const model::ColourTick& tick : ticks_) {
        const double y = std::round(yOf(tick.value)) + 0.5;
        painter.drawLine(QPointF(bar.right() + 1.0, y), QPointF(bar.right() + kTick, y));
        painter.drawText(QRectF(bar.right() + kTick + kScaleGap, y - line / 2.0, textWidth_ + 2, line),
                         Qt::AlignLeft | Qt::AlignVCenter, QString::fromStdString(tick.text));
    }
    if (content_.hasMissing) {
        const double top = height() - kPadding - line;
        painter.setPen(QPen(kQuietInk, 1.0));
        painter.setBrush(toQt(model::kNoValueColour));
        painter.drawRect(QRectF(kPadding, top + 2.0, kStrip, line - 4.0));
        painter.drawText(QRectF(bar.right() + kTick + kScaleGap, top, width(), line), Qt::AlignLeft | Qt::AlignVCenter,
                         tr("no value"));
    }
    painter.restore();
}

void ColourBarView::paintEvent(QPaintEvent*) {
    QPainter painter(this);
    paint(painter);
}

void ColourBarView::changeEvent(QEvent* event) {
    QWidget::changeEvent(event);
    if (event->type() == QEvent::FontChange)
        layOut();
}

} // namespace isoslider::widgets
