#include "ui/widgets/opening/loading_card.h"

#include <QLabel>
#include <QPainter>
#include <QProgressBar>
#include <QPushButton>
#include <QVBoxLayout>

#include "ui/model/session/session.h"

namespace isoslider::widgets {
namespace {

constexpr int kWidth = 300;

} // namespace

LoadingCard::LoadingCard(model::Session& session, QWidget* parent)
    : QFrame(parent),
      session_(session),
      text_(new QLabel(this)),
      bar_(new QProgressBar(this)),
      cancel_(new QPushButton(tr("Cancel"), this)) {
    setObjectName(QStringLiteral("loadingCard"));
    setMaximumWidth(kWidth);
    auto* layout = new QVBoxLayout(this);
    layout->setContentsMargins(18, 14, 18, 14);
    layout->setSpacing(10);
    text_->setObjectName(QStringLiteral("loadingLabel"));
    text_->setTextFormat(Qt::PlainText);
    text_->setAlignment(Qt::AlignHCenter);
    text_->setSizePolicy(QSizePolicy::Ignored, QSizePolicy::Preferred);
    bar_->setObjectName(QStringLiteral("loadingProgress"));
    bar_->setAccessibleName(tr("Opening"));
    bar_->setTextVisible(false);
    bar_->setFixedHeight(8);
    cancel_->setObjectName(QStringLiteral("cancelOpening"));
    cancel_->setToolTip(tr("Stop opening; what is open now stays"));
    layout->addWidget(text_);
    layout->addWidget(bar_);
    layout->addWidget(cancel_, 0, Qt::AlignHCenter);
    connect(cancel_, &QPushButton::clicked, this, [this] {
        cancel_->setEnabled(false);
        session_.cancelOpening();
    });
    jobsSubscription_ = session_.jobs().observe([this] { showProgress(); });
    showState();
}

QSize LoadingCard::sizeHint() const { return {kWidth, QFrame::sizeHint().height()}; }

void LoadingCard::showState() {
    const bool isLoading = session_.isLoading();
    const bool isExtracting = !isLoading && session_.isMoving() && !session_.frame();
    bar_->setVisible(isLoading);
    cancel_->setVisible(isLoading);
    if (isExtracting)
        text_->setText(tr("Extracting the first surface…"));
    showProgress();
    setVisible(isLoading || isExtracting);
    adjustSize();
}

void LoadingCard::showProgress() {
    const auto* job = session_.loading();
    if (job == nullptr)
        return;
    const QString text =
        job->isCancelling ? tr("Cancelling…") : QString::fromStdString(job->title) + QStringLiteral("…");
    text_->setText(fontMetrics().elidedText(text, Qt::ElideMiddle, kWidth - 36));
    text_->setToolTip(text);
    bar_->setRange(0, job->fraction > 0.0 ? 1000 : 0); // how far is not known yet
    bar_->setValue(qRound(job->fraction * 1000.0));
    cancel_->setEnabled(!job->isCancelling);
}

void LoadingCard::paintEvent(QPaintEvent*) {
    QPainter painter(this);
    painter.setRenderHint(QPainter::Antialiasing);
    painter.setPen(Qt::NoPen);
    painter.setBrush(palette().window());
    painter.drawRoundedRect(rect(), 10.0, 10.0);
}

} // namespace isoslider::widgets
