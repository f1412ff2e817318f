#include "ui/widgets/isovalue/isovalue_edit.h"

#include <utility>

#include <QKeyEvent>
#include <QWheelEvent>

#include "ui/model/isovalue/deviation_text.h"
#include "ui/model/isovalue/isovalue_model.h"
#include "ui/model/isovalue/isovalue_words.h"
#include "ui/model/isovalue/number_text.h"

namespace isoslider::widgets {
namespace {

constexpr int kMostCharacters = 100; // more than any number that a person types

} // namespace

IsovalueEdit::IsovalueEdit(QWidget* parent) : QLineEdit(parent) {
    setObjectName(QStringLiteral("isovalueEdit"));
    setAccessibleName(tr("Requested isovalue"));
    setAlignment(Qt::AlignRight);
    setMaxLength(kMostCharacters);
    connect(this, &QLineEdit::inputRejected, this, [this] { isCut_ = true; });
    connect(this, &QLineEdit::textEdited, this,
            [this](const QString& text) { isCut_ = isCut_ && text.size() == kMostCharacters; });
    connect(this, &QLineEdit::textEdited, this, &IsovalueEdit::hideReason);
    connect(this, &QLineEdit::editingFinished, this, &IsovalueEdit::commit);
}

void IsovalueEdit::showValue(double value) {
    const QString text = QString::fromStdString(model::exactText(value));
    if (std::exchange(shownText_, text) != text)
        hideReason();
    if (!isModified() || !hasFocus())
        restore();
}

void IsovalueEdit::showNothing() {
    shownText_.clear();
    hideReason();
    restore();
}

void IsovalueEdit::restore() {
    setText(shownText_);
    setModified(false);
    isCut_ = false;
}

void IsovalueEdit::commit() {
    if (!isModified() || text() == shownText_)
        return setModified(false);
    hideReason();
    setModified(false);
    if (const auto value = typedValue()) {
        Q_EMIT valueCommitted(*value);
        restore(); // shows the clamped value if the request changed nothing
    }
    if (hasFocus())
        selectAll();
}

// Refuses what is none.
std::optional<double> IsovalueEdit::typedValue() {
    if (isCut_) {
        refuse(tr("“%1” is too long for a number").arg(quotedInput(text())));
        return std::nullopt;
    }
    const auto asked = model::isovalueFrom(text().trimmed().toStdString());
    if (!asked) {
        refuse(tr("“%1” is not a number").arg(quotedInput(text())));
        return std::nullopt;
    }
    const auto value = asked->in(spread_.value_or(ValueSpread()));
    if (!value.isOk()) {
        refuse(QString::fromUtf8(model::kNoDeviationText));
        return std::nullopt;
    }
    return value.value();
}

void IsovalueEdit::refuse(const QString& reason) {
    restore();
    if (!hasFocus())
        return; // a tip would stay there for a field that nobody is in
    refusal_.show(*this, reason);
}

void IsovalueEdit::hideReason() { refusal_.hide(); }

void IsovalueEdit::focusOutEvent(QFocusEvent* event) {
    hideReason();
    QLineEdit::focusOutEvent(event);
}

// Escape puts the value back, whatever it does elsewhere in the window. Until something is typed, letters that no
// number has do what they do when the field has not the keyboard; from then on they are text, as after a digit of "6
// sigma".
bool IsovalueEdit::event(QEvent* event) {
    if (event->type() == QEvent::ShortcutOverride) {
        const auto* pressed = static_cast<QKeyEvent*>(event);
        const int key = pressed->key();
        const bool isLetter = key >= Qt::Key_A && key <= Qt::Key_Z && key != Qt::Key_E;
        if (key == Qt::Key_Escape)
            event->accept();
        if (isLetter && !isModified() &&
            (pressed->modifiers() & ~Qt::ShiftModifier) == Qt::NoModifier) { // not to copy, nor to undo
            event->ignore();
            return true;
        }
    }
    return QLineEdit::event(event);
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
            hideReason();
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
