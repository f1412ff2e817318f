#pragma once

#include <QWidget>

#include "ui/model/observers.h"

class QProgressBar;
class QToolButton;

namespace isoslider::model {
class Session;
}

namespace isoslider::widgets {

/// What is worked on behind the surface, in the status bar: the newest job that has been running for a moment.
class JobStatus : public QWidget {
    Q_OBJECT
public:
    explicit JobStatus(model::Session& session, QWidget* parent = nullptr);

Q_SIGNALS:
    /// All of them are asked for.
    void clicked();

private:
    void showJobs();

    model::Session& session_;
    QToolButton* text_;
    QProgressBar* bar_;
    model::Subscription subscription_;
};

} // namespace isoslider::widgets
