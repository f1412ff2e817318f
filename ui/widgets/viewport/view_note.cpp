#include "ui/widgets/viewport/view_note.h"

#include <algorithm>

#include <QEvent>

namespace isoslider::widgets {
namespace {

constexpr int kNoteMargin = 12;
constexpr int kAside = 124; // the orientation axes lie beside it
constexpr int kLeastWidth = 180;
constexpr int kLeastHeight = 220; // of the view

} // namespace

ViewNote::ViewNote(QWidget& view, Place place) : ViewReadout(&view), view_(view), place_(place) {
    setTextFormat(Qt::PlainText);
    setAlignment(Qt::AlignCenter);
    hide();
    view_.installEventFilter(this);
}

void ViewNote::say(const QString& text) {
    if (text == this->text())
        return;
    setText(text);
    setAccessibleName(text);
    settle();
}

void ViewNote::settle() {
    const int room = view_.width() - 2 * kAside;
    setVisible(!text().isEmpty() && room >= kLeastWidth && view_.height() >= kLeastHeight);
    setWordWrap(false);
    QSize size = sizeHint();
    if (size.width() > room) {
        setWordWrap(true);
        size = {std::max(room, 1), heightForWidth(std::max(room, 1))};
    }
    const int above = view_.height() - size.height();
    setGeometry((view_.width() - size.width()) / 2, place_ == Place::Centre ? above / 2 : above - kNoteMargin,
                size.width(), size.height());
}

bool ViewNote::eventFilter(QObject* watched, QEvent* event) {
    if (watched == &view_ && event->type() == QEvent::Resize)
        settle();
    return ViewReadout::eventFilter(watched, event);
}

} // namespace isoslider::widgets
