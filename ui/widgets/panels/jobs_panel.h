#pragma once

#include <map>

#include <QWidget>

#include "ui/model/jobs/job_model.h"

class QLabel;
class QPushButton;
class QVBoxLayout;

namespace isoslider::model {
class Session;
}

namespace isoslider::widgets {

class JobRow;

/// Running and finished jobs, newest first, each with progress, stage, cancel and error text.
class JobsPanel : public QWidget {
    Q_OBJECT
public:
    explicit JobsPanel(model::Session& session, QWidget* parent = nullptr);

private:
    void showJobs();

    model::Session& session_;
    QVBoxLayout* rowsLayout_;
    QLabel* empty_;
    QPushButton* clear_;
    std::map<model::JobId, JobRow*> rows_;
    model::Subscription subscription_;
};

} // namespace isoslider::widgets
