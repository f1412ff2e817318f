#include "ui/widgets/window/job_status.h"

#include <algorithm>

#include <QHBoxLayout>
#include <QProgressBar>
#include <QToolButton>

#include "ui/model/jobs/job_words.h"
#include "ui/model/session/session.h"
#include "ui/widgets/common/small_widgets.h"

namespace isoslider::widgets {
namespace {

constexpr int kTextWidth = 320, kBarWidth = 110; // pixels
constexpr double kMomentMs = 400.0; // what is over sooner would only flicker

} // namespace

JobStatus::JobStatus(model::Session& session, QWidget* parent)
    : QWidget(parent), session_(session), text_(new QToolButton(this)), bar_(new QProgressBar(this)) {
    setObjectName(QStringLiteral("jobStatus"));
    auto* layout = new QHBoxLayout(this);
    layout->setContentsMargins(8, 0, 8, 0);
    text_->setAutoRaise(true);
    text_->setFocusPolicy(Qt::TabFocus);
    bar_->setRange(0, 1000);
    bar_->setTextVisible(false);
    bar_->setFixedSize(kBarWidth, 8);
    layout->addStretch(1); // at the right end also while there are no counts to its left
    layout->addWidget(text_);
    layout->addWidget(bar_);
    connect(text_, &QToolButton::clicked, this, &JobStatus::clicked);
    subscription_ = session_.jobs().observe([this] { showJobs(); });
    showJobs();
}

void JobStatus::showJobs() {
    const model::JobEntry* shown = nullptr;
    int others = -1;
    for (const model::JobEntry& job : session_.jobs().entries())
        if (job.state == model::JobState::Running && job.elapsedMs >= kMomentMs) {
            shown = &job;
            ++others;
        }
    setVisible(shown != nullptr);
    if (shown == nullptr)
        return;
    const QString title = QString::fromStdString(shown->title);
    const QString more = others > 0 ? tr(" and %n more", nullptr, others) : QString();
    const int room = kTextWidth - text_->fontMetrics().horizontalAdvance(more);
    text_->setText(text_->fontMetrics().elidedText(title, Qt::ElideMiddle, room).replace(u'&', QStringLiteral("&&")) +
                   more);
    text_->setToolTip(plainTip(title + u'\n' + QString::fromStdString(model::runningText(*shown))));
    text_->setAccessibleName(tr("Show jobs: %1").arg(title + more));
    bar_->setValue(qRound(std::max(0.0, shown->fraction) * 1000.0)); // negative: unknown
}

} // namespace isoslider::widgets
