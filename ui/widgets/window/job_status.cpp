#include "ui/widgets/window/job_status.h"

#include <algorithm>

#include <QHBoxLayout>
#include <QProgressBar>
#include <QToolButton>

#include "ui/model/jobs/job_words.h"
#include "ui/model/session/session.h"
#include "ui/widgets/common/icon_loader.h"
#include "ui/widgets/common/small_widgets.h"

namespace isoslider::widgets {
namespace {

constexpr int kTextWidth = 320, kBarWidth = 110; // pixels
constexpr qint64 kMomentMs = 400; // what is over sooner would only flicker

} // namespace

JobStatus::JobStatus(model::Session& session, QWidget* parent)
    : QWidget(parent),
      session_(session),
      text_(new QToolButton(this)),
      cancel_(new QToolButton(this)),
      bar_(new QProgressBar(this)) {
    setObjectName(QStringLiteral("jobStatus"));
    // It takes the height that there is: the view does not jump when it comes and goes.
    setSizePolicy(QSizePolicy::Preferred, QSizePolicy::Ignored);
    auto* layout = new QHBoxLayout(this);
    layout->setContentsMargins(8, 0, 8, 0);
    text_->setAutoRaise(true);
    text_->setFocusPolicy(Qt::TabFocus);
    bar_->setRange(0, 1000);
    bar_->setTextVisible(false);
    bar_->setFixedSize(kBarWidth, 8);
    layout->addStretch(1); // at the right end also while there are no counts to its left
    layout->addWidget(text_);
    layout->addWidget(cancel_);
    layout->addWidget(bar_);
    cancel_->setObjectName(QStringLiteral("cancelShownJob"));
    cancel_->setIcon(themedIcon(QStringLiteral("cancel"), palette()));
    cancel_->setAutoRaise(true);
    cancel_->setFocusPolicy(Qt::TabFocus);
    cancel_->setIconSize(QSize(12, 12));
    connect(cancel_, &QToolButton::clicked, this, [this] {
        if (shown_)
            session_.cancelJob(*shown_);
    });
    moment_.setSingleShot(true);
    connect(&moment_, &QTimer::timeout, this, &JobStatus::showJobs);
    connect(text_, &QToolButton::clicked, this, &JobStatus::clicked);
    subscription_ = session_.jobs().observe([this] { showJobs(); });
    showJobs();
}

void JobStatus::noteBegins() {
    const model::JobModel& jobs = session_.jobs();
    std::erase_if(begins_, [&](const auto& begin) {
        const model::JobEntry* job = jobs.find(begin.first);
        return job == nullptr || job->state != model::JobState::Running;
    });
    for (const model::JobEntry& job : jobs.entries())
        if (job.state == model::JobState::Running && !begins_.contains(job.id))
            begins_[job.id].start();
    qint64 next = kMomentMs; // of the youngest that is still too young
    bool isAnyYoung = false;
    for (const auto& [id, since] : begins_)
        if (const qint64 left = kMomentMs - since.elapsed(); left > 0) {
            next = std::min(next, left);
            isAnyYoung = true;
        }
    if (isAnyYoung)
        moment_.start(static_cast<int>(next));
    else
        moment_.stop();
}

void JobStatus::showJobs() {
    noteBegins();
    const model::JobEntry* shown = nullptr;
    int others = -1;
    for (const model::JobEntry& job : session_.jobs().entries())
        if (job.state == model::JobState::Running &&
            (job.elapsedMs >= kMomentMs || begins_.at(job.id).elapsed() >= kMomentMs)) {
            shown = &job;
            ++others;
        }
    setVisible(shown != nullptr);
    shown_ = shown != nullptr ? std::optional(shown->id) : std::nullopt;
    if (shown == nullptr)
        return;
    const QString title = QString::fromStdString(shown->title);
    const QString more = others > 0 ? tr(" and %n more", nullptr, others) : QString();
    const int room = kTextWidth - text_->fontMetrics().horizontalAdvance(more);
    text_->setText(text_->fontMetrics().elidedText(title, Qt::ElideMiddle, room).replace(u'&', QStringLiteral("&&")) +
                   more);
    const QString progress =
        shown->stage.empty() ? tr("Starting…") : QString::fromStdString(model::runningText(*shown));
    text_->setToolTip(plainTip(title + u'\n' + progress));
    cancel_->setEnabled(!shown->isCancelling);
    cancel_->setToolTip(plainTip(tr("Cancel: %1").arg(title)));
    cancel_->setAccessibleName(tr("Cancel: %1").arg(title));
    text_->setAccessibleName(tr("Show jobs: %1").arg(title + more));
    bar_->setValue(qRound(std::max(0.0, shown->fraction) * 1000.0)); // 0 until it reports
}

} // namespace isoslider::widgets
