#pragma once

#include <map>
#include <optional>

#include <QElapsedTimer>
#include <QTimer>
#include <QWidget>

#include "ui/model/jobs/job_model.h"
#include "ui/model/observers.h"

class QProgressBar;
class QToolButton;

namespace isoslider::model {
class Session;
}

namespace isoslider::widgets {

/// What is worked on behind the surface, in the status bar: the newest job that has been running for a moment, whether
/// it has reported anything by then or not. It can be cancelled there.
class JobStatus : public QWidget {
    Q_OBJECT
public:
    explicit JobStatus(model::Session& session, QWidget* parent = nullptr);

Q_SIGNALS:
    /// All of them are asked for.
    void clicked();

private:
    void showJobs();
    void noteBegins();

    model::Session& session_;
    std::map<model::JobId, QElapsedTimer> begins_; ///< of those that run: a job may be silent for long
    QTimer moment_; ///< until one of them has been running for a moment
    QToolButton* text_;
    QToolButton* cancel_;
    QProgressBar* bar_;
    std::optional<model::JobId> shown_;
    model::Subscription subscription_;
};

} // namespace isoslider::widgets
