#pragma once

#include <QElapsedTimer>
#include <QFrame>

#include "ui/model/observers.h"

class QLabel;
class QProgressBar;
class QPushButton;

namespace isoslider::model {
class Session;
}

namespace isoslider::widgets {

/// Over the view while a volume is being opened, and then until its first surface is there: which, how far, how long
/// still, and a button that stops it. Where the first surface was stopped, a button that asks for it again. Shows and
/// hides itself.
class LoadingCard : public QFrame {
    Q_OBJECT
public:
    explicit LoadingCard(model::Session& session, QWidget* parent = nullptr);
    /// As the session is now.
    void showState();
    QSize sizeHint() const override;

protected:
    void paintEvent(QPaintEvent* event) override;
    /// Of all of the program, while there is something to be stopped: Escape stops it wherever the keyboard is.
    bool eventFilter(QObject* watched, QEvent* event) override;

private:
    enum class State { Nothing, Opening, Extracting, NoSurface };
    State state() const;
    void press();
    void showProgress();

    model::Session& session_;
    QLabel* text_;
    QProgressBar* bar_;
    QLabel* stage_;
    QPushButton* button_;
    QElapsedTimer extracting_; ///< since the surface that is being made was asked for
    model::Subscription jobsSubscription_;
    model::Subscription progressSubscription_;
};

} // namespace isoslider::widgets
