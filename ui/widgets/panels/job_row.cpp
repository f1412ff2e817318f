#include "ui/widgets/panels/job_row.h"

#include <QGridLayout>
#include <QLabel>
#include <QProgressBar>
#include <QToolButton>

#include "ui/model/isovalue/number_text.h"
#include "ui/model/jobs/job_words.h"
#include "ui/widgets/common/icon_loader.h"
#include "ui/widgets/common/small_widgets.h"
#include "ui/widgets/common/text_colour.h"

namespace isoslider::widgets {
namespace {

QString detailOf(const model::JobEntry& job) {
    const QString elapsed = QString::fromStdString(model::millisecondsText(job.elapsedMs));
    switch (job.state) {
        case model::JobState::Running:
            if (job.isCancelling)
                return JobRow::tr("Cancelling…");
            return job.stage.empty() ? JobRow::tr("Starting…") : QString::fromStdString(model::runningText(job));
        case model::JobState::Finished: return JobRow::tr("Done in %1").arg(elapsed);
        case model::JobState::Failed: return JobRow::tr("Failed: %1").arg(QString::fromStdString(job.errorText));
        case model::JobState::Cancelled: return JobRow::tr("Cancelled after %1").arg(elapsed);
    }
    return {};
}

} // namespace

JobRow::JobRow(QWidget* parent)
    : QFrame(parent),
      title_(new ElidedLabel(this, Qt::ElideMiddle)),
      detail_(new QLabel(this)),
      bar_(new QProgressBar(this)),
      cancel_(new QToolButton(this)) {
    auto* layout = new QGridLayout(this);
    layout->setContentsMargins(0, 4, 0, 4);
    layout->setVerticalSpacing(3);
    layout->setColumnStretch(0, 1);
    title_->setSizePolicy(QSizePolicy::Ignored, QSizePolicy::Preferred);
    detail_->setTextFormat(Qt::PlainText);
    detail_->setWordWrap(true);
    makeQuiet(detail_);
    detail_->setTextInteractionFlags(Qt::TextSelectableByMouse);
    bar_->setRange(0, 1000);
    bar_->setTextVisible(false);
    bar_->setFixedHeight(8);
    cancel_->setObjectName(QStringLiteral("cancelJobButton"));
    cancel_->setIcon(themedIcon(QStringLiteral("cancel"), palette()));
    cancel_->setAutoRaise(true);
    cancel_->setToolTip(tr("Cancel this job"));
    cancel_->setAccessibleName(tr("Cancel job"));
    layout->addWidget(title_, 0, 0);
    layout->addWidget(cancel_, 0, 1, 2, 1, Qt::AlignTop);
    layout->addWidget(bar_, 1, 0);
    layout->addWidget(detail_, 2, 0, 1, 2);
    connect(cancel_, &QToolButton::clicked, this, &JobRow::cancelRequested);
}

void JobRow::showJob(const model::JobEntry& job) {
    const bool isRunning = job.state == model::JobState::Running;
    title_->setFullText(QString::fromStdString(job.title));
    detail_->setText(detailOf(job));
    bar_->setVisible(isRunning);
    bar_->setValue(qRound(job.fraction * 1000.0));
    cancel_->setVisible(isRunning);
    cancel_->setEnabled(!job.isCancelling);
}

} // namespace isoslider::widgets
