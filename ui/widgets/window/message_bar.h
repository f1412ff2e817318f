#pragma once

#include <functional>
#include <vector>

#include <QFrame>
#include <QTimer>

#include "ui/model/session/session.h"

class QHBoxLayout;
class QLabel;
class QToolButton;

namespace isoslider::widgets {

/// What went wrong, or was done, on a bar over the view that interrupts nothing. Errors stay until closed
/// or replaced; other messages leave by themselves.
class MessageBar : public QFrame {
    Q_OBJECT
public:
    explicit MessageBar(QWidget* parent = nullptr);

    void showNotice(const model::Notice& notice);
    /// Something to press, and what it does. The bar hides first.
    struct Offer {
        QString text;
        std::function<void()> run;
    };
    /// Stays until one is taken or the bar is closed.
    void showOffer(const model::Notice& notice, const std::vector<Offer>& offers);
    QString text() const;

protected:
    bool event(QEvent* event) override;
    void keyPressEvent(QKeyEvent* event) override;

private:
    QLabel* icon_;
    QLabel* title_;
    QLabel* detail_;
    QHBoxLayout* offers_;
    QToolButton* close_;
    QTimer hideTimer_;
};

} // namespace isoslider::widgets
