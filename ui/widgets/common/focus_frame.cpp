#include "ui/widgets/common/focus_frame.h"

#include <QFocusEvent>
#include <QPainter>

namespace isoslider::widgets {
namespace {

constexpr double kWidth = 2.0; // pixels

bool isByKey(Qt::FocusReason reason) {
    return reason == Qt::TabFocusReason || reason == Qt::BacktabFocusReason || reason == Qt::ShortcutFocusReason;
}

} // namespace

FocusFrame::FocusFrame(QWidget& marked) : QWidget(&marked), marked_(marked) {
    setObjectName(QStringLiteral("focusFrame"));
    setAttribute(Qt::WA_TransparentForMouseEvents);
    setFocusPolicy(Qt::NoFocus);
    hide();
    marked_.installEventFilter(this);
}

void FocusFrame::paintEvent(QPaintEvent*) {
    QPainter painter(this);
    painter.setPen(QPen(palette().highlight().color(), kWidth));
    painter.drawRect(QRectF(rect()).adjusted(kWidth / 2, kWidth / 2, -kWidth / 2, -kWidth / 2));
}

bool FocusFrame::eventFilter(QObject* watched, QEvent* event) {
    if (watched == &marked_) {
        if (event->type() == QEvent::FocusIn && isByKey(static_cast<QFocusEvent*>(event)->reason())) {
            setGeometry(marked_.rect());
            raise();
            show();
        } else if (event->type() == QEvent::FocusOut || event->type() == QEvent::MouseButtonPress) {
            hide();
        } else if (event->type() == QEvent::Resize) {
            setGeometry(marked_.rect());
        }
    }
    return QWidget::eventFilter(watched, event);
}

} // namespace isoslider::widgets
