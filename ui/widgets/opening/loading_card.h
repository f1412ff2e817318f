#pragma once

#include <QFrame>

#include "ui/model/observers.h"

class QLabel;
class QProgressBar;
class QPushButton;

namespace isoslider::model {
class Session;
}

namespace isoslider::widgets {

/// Over the view while a volume is being opened: which, how far, and a button that stops it. Then, until the
/// first surface is there, a word that it is being made. Shows and hides itself.
class LoadingCard : public QFrame {
    Q_OBJECT
public:
    explicit LoadingCard(model::Session& session, QWidget* parent = nullptr);
    /// As the session is now.
    void showState();
    QSize sizeHint() const override;

protected:
    void paintEvent(QPaintEvent* event) override;

private:
    void showProgress();

    model::Session& session_;
    QLabel* text_;
    QProgressBar* bar_;
    QPushButton* cancel_;
    model::Subscription jobsSubscription_;
};

} // namespace isoslider::widgets
