#include "ui/widgets/isovalue_edit.h"

#include <cmath>

#include <QKeyEvent>
#include <QLocale>
#include <QToolTip>
#include <QWheelEvent>

#include "ui/model/isovalue_model.h"
#include "ui/model/number_text.h"

namespace isoslider::widgets {

IsovalueEdit::IsovalueEdit(QWidget* parent) : QLineEdit(parent) {
    setObjectName(QStringLiteral("isovalueEdit"));
    setAccessibleName(tr("Requested isovalue"));
    setAlignment(Qt::AlignRight);
    connect(this, &QLineEdit::editingFinished, this, &IsovalueEdit::commit);
}

void IsovalueEdit::showValue(double value) {
    shownText_ = QString::fromStdString(model::valueText(value, 8));
    if (!isModified() || !hasFocus())
        restore();
}

void IsovalueEdit::showNothing() {
    shownText_.clear();
    restore();
}

void IsovalueEdit::restore() {
    setText(shownText_);
    setModified(false);
}

void IsovalueEdit::commit() {
    if (!isModified() || text() == shownText_)
        return setModified(false);
    bool isNumber = false;
    // Both the point and the locale's comma are understood.
    double value = text().trimmed().toDouble(&isNumber);
    if (!isNumber)
        value = locale().toDouble(text().trimmed(), &isNumber);
    const QString refused = text();
    setModified(false);
    if (isNumber && !std::isnan(value)) {
        Q_EMIT valueCommitted(value);
        restore(); // shows the clamped value if the request changed nothing
    } else {
        restore();
        QToolTip::showText(mapToGlobal(QPoint(0, height())), tr("“%1” is not a number").arg(refused), this);
    }
    if (hasFocus())
        selectAll();
}

void IsovalueEdit::keyPressEvent(QKeyEvent* event) {
    const double fine = event->modifiers().testFlag(Qt::ShiftModifier) ? 1.0 / model::kPrecisionFactor : 1.0;
    const double page = event->modifiers().testFlag(Qt::ControlModifier) ? model::kLargePageStep : model::kPageStep;
    switch (event->key()) {
        case Qt::Key_Up: Q_EMIT stepRequested(model::kFineStep * fine); return;
        case Qt::Key_Down: Q_EMIT stepRequested(-model::kFineStep * fine); return;
        case Qt::Key_PageUp: Q_EMIT stepRequested(page * fine); return;
        case Qt::Key_PageDown: Q_EMIT stepRequested(-page * fine); return;
        case Qt::Key_Escape:
            restore();
            selectAll();
            return;
        default: QLineEdit::keyPressEvent(event);
    }
}

void IsovalueEdit::wheelEvent(QWheelEvent* event) {
    const QPoint angle = event->angleDelta();
    const double notches = (angle.y() != 0 ? angle.y() : angle.x()) / 120.0;
    const double fine = event->modifiers().testFlag(Qt::ShiftModifier) ? 1.0 / model::kPrecisionFactor : 1.0;
    Q_EMIT stepRequested(notches * model::kFineStep * fine);
    event->accept();
}

} // namespace isoslider::widgets
