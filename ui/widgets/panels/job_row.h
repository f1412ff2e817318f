#pragma once

#include <QFrame>

#include "ui/model/jobs/job_model.h"

class QLabel;
class QProgressBar;
class QToolButton;

namespace isoslider::widgets {

class ElidedLabel;

/// One job in the list.
class JobRow : public QFrame {
    Q_OBJECT
public:
    explicit JobRow(QWidget* parent = nullptr);
    void showJob(const model::JobEntry& job);

Q_SIGNALS:
    void cancelRequested();

private:
    ElidedLabel* title_;
    QLabel* detail_;
    QProgressBar* bar_;
    QToolButton* cancel_;
};

} // namespace isoslider::widgets
