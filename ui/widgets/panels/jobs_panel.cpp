#include "ui/widgets/panels/jobs_panel.h"

#include <QLabel>
#include <QPushButton>
#include <QVBoxLayout>

#include "ui/model/session/session.h"
#include "ui/widgets/common/small_widgets.h"
#include "ui/widgets/common/text_colour.h"
#include "ui/widgets/panels/job_row.h"

namespace isoslider::widgets {

JobsPanel::JobsPanel(model::Session& session, QWidget* parent)
    : QWidget(parent),
      session_(session),
      rowsLayout_(nullptr),
      empty_(new QLabel(tr("No jobs."), this)),
      clear_(new QPushButton(tr("Clear Finished"), this)) {
    QVBoxLayout* layout = fillWithScrollPage(this).rows;
    rowsLayout_ = new QVBoxLayout;
    rowsLayout_->setSpacing(4);
    makeQuiet(empty_);
    layout->addWidget(empty_);
    layout->addLayout(rowsLayout_);
    layout->addWidget(clear_, 0, Qt::AlignLeft);
    layout->addStretch(1);
    connect(clear_, &QPushButton::clicked, this, [this] { session_.jobs().clearFinished(); });
    subscription_ = session_.jobs().observe([this] { showJobs(); });
    showJobs();
}

void JobsPanel::showJobs() {
    const auto& entries = session_.jobs().entries();
    for (auto row = rows_.begin(); row != rows_.end();) {
        if (session_.jobs().find(row->first) != nullptr) {
            ++row;
            continue;
        }
        row->second->deleteLater();
        row = rows_.erase(row);
    }
    for (const auto& entry : entries) {
        JobRow*& row = rows_[entry.id];
        if (row == nullptr) {
            row = new JobRow(this);
            rowsLayout_->insertWidget(0, row);
            connect(row, &JobRow::cancelRequested, this, [this, id = entry.id] { session_.cancelJob(id); });
        }
        row->showJob(entry);
    }
    empty_->setVisible(entries.empty());
    clear_->setVisible(entries.size() > session_.jobs().runningCount());
}

} // namespace isoslider::widgets
