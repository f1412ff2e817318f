#pragma once

#include <QFrame>
#include <QTimer>

#include "ui/model/session.h"

class QLabel;
class QToolButton;

namespace isoslider::widgets {

/// What went wrong, or was done, on a bar over the view that stops nobody. Errors stay until closed
/// or replaced; other messages leave by themselves.
class MessageBar : public QFrame {
    Q_OBJECT
public:
    explicit MessageBar(QWidget* parent = nullptr);

    void showNotice(const model::Notice& notice);
    QString text() const;

protected:
    void keyPressEvent(QKeyEvent* event) override;

private:
    QLabel* icon_;
    QLabel* title_;
    QLabel* detail_;
    QToolButton* close_;
    QTimer hideTimer_;
};

} // namespace isoslider::widgets
