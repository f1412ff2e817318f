#include "ui/widgets/opening/loading_card.h"

#include <QApplication>
#include <QKeyEvent>
#include <QLabel>
#include <QPainter>
#include <QProgressBar>
#include <QPushButton>
#include <QVBoxLayout>

#include "ui/model/jobs/job_words.h"
#include "ui/model/session/session.h"
#include "ui/widgets/common/text_colour.h"

namespace isoslider::widgets {
namespace {

constexpr int kWidth = 300;

} // namespace

LoadingCard::LoadingCard(model::Session& session, QWidget* parent)
    : QFrame(parent),
      session_(session),
      text_(new QLabel(this)),
      bar_(new QProgressBar(this)),
      stage_(new QLabel(this)),
      button_(new QPushButton(this)) {
    setObjectName(QStringLiteral("loadingCard"));
    setMaximumWidth(kWidth);
    auto* layout = new QVBoxLayout(this);
    layout->setContentsMargins(18, 14, 18, 14);
    layout->setSpacing(10);
    text_->setObjectName(QStringLiteral("loadingLabel"));
    stage_->setObjectName(QStringLiteral("loadingStage"));
    for (QLabel* label : {text_, stage_}) {
        label->setTextFormat(Qt::PlainText);
        label->setAlignment(Qt::AlignHCenter);
        label->setSizePolicy(QSizePolicy::Ignored, QSizePolicy::Preferred);
    }
    makeQuiet(stage_);
    bar_->setObjectName(QStringLiteral("loadingProgress"));
    bar_->setTextVisible(false);
    bar_->setFixedHeight(8);
    button_->setObjectName(QStringLiteral("cancelOpening"));
    layout->addWidget(text_);
    layout->addWidget(bar_);
    layout->addWidget(stage_);
    layout->addWidget(button_, 0, Qt::AlignHCenter);
    connect(button_, &QPushButton::clicked, this, &LoadingCard::press);
    jobsSubscription_ = session_.jobs().observe([this] { showProgress(); });
    progressSubscription_ = session_.moveProgressChanged().observe([this] { showProgress(); });
    showState();
}

QSize LoadingCard::sizeHint() const { return {kWidth, QFrame::sizeHint().height()}; }

LoadingCard::State LoadingCard::state() const {
    if (session_.isLoading())
        return State::Opening;
    if (session_.dataset() == nullptr || session_.frame())
        return State::Nothing;
    return session_.isMoving() ? State::Extracting : State::NoSurface;
}

void LoadingCard::press() {
    switch (state()) {
        case State::Opening: button_->setEnabled(false); return session_.cancelOpening();
        case State::Extracting: return session_.stopMove();
        case State::NoSurface: return session_.moveAgain();
        case State::Nothing: return;
    }
}

void LoadingCard::showState() {
    const State state = this->state();
    const bool isAtWork = state == State::Opening || state == State::Extracting;
    if (state != State::Extracting)
        extracting_.invalidate();
    else if (!extracting_.isValid())
        extracting_.start();
    bar_->setVisible(isAtWork);
    bar_->setAccessibleName(state == State::Opening ? tr("Opening") : tr("Extracting"));
    stage_->setVisible(isAtWork);
    button_->setText(isAtWork ? tr("Cancel") : tr("Extract Surface"));
    button_->setToolTip(state == State::Opening      ? tr("Stop opening (Esc); what is open now stays")
                        : state == State::Extracting ? tr("Stop extracting (Esc); the volume stays open")
                                                     : tr("Extract the surface at this isovalue"));
    button_->setEnabled(true);
    if (state == State::Extracting)
        text_->setText(tr("Extracting the first surface…"));
    if (state == State::NoSurface)
        text_->setText(tr("No surface was extracted at this isovalue"));
    if (!isAtWork || state == State::Extracting)
        text_->setToolTip({});
    showProgress();
    setVisible(state != State::Nothing);
    adjustSize();
    qApp->removeEventFilter(this);
    if (isAtWork)
        qApp->installEventFilter(this);
}

// A menu or a dialog that is open closes first.
bool LoadingCard::eventFilter(QObject* watched, QEvent* event) {
    const bool isPressed = event->type() == QEvent::KeyPress;
    if (!isPressed && event->type() != QEvent::ShortcutOverride)
        return QFrame::eventFilter(watched, event);
    const auto* widget = qobject_cast<const QWidget*>(watched);
    const auto* key = static_cast<const QKeyEvent*>(event);
    if (key->key() != Qt::Key_Escape || key->modifiers() != Qt::NoModifier || widget == nullptr ||
        widget->window() != window() || QApplication::activePopupWidget() != nullptr)
        return QFrame::eventFilter(watched, event);
    event->accept(); // it is no shortcut
    if (isPressed && button_->isEnabled())
        press();
    return true;
}

void LoadingCard::showProgress() {
    const auto show = [this](double fraction, const QString& stage) {
        bar_->setRange(0, fraction > 0.0 ? 1000 : 0); // how far is not known yet
        bar_->setValue(qRound(fraction * 1000.0));
        stage_->setText(fontMetrics().elidedText(stage, Qt::ElideRight, kWidth - 36));
    };
    if (const auto* job = session_.loading()) {
        const QString text =
            job->isCancelling ? tr("Cancelling…") : QString::fromStdString(job->title) + QStringLiteral("…");
        text_->setText(fontMetrics().elidedText(text, Qt::ElideMiddle, kWidth - 36));
        text_->setToolTip(text);
        show(job->fraction, job->stage.empty() ? QString() : QString::fromStdString(model::runningText(*job)));
        button_->setEnabled(!job->isCancelling);
    } else if (extracting_.isValid()) {
        const double fraction = session_.moveProgress();
        show(fraction,
             fraction > 0.0
                 ? QString::fromStdString(model::runningText(
                       {{}, {}, "extracting", fraction, {}, false, {}, static_cast<double>(extracting_.elapsed())}))
                 : QString());
    }
}

void LoadingCard::paintEvent(QPaintEvent*) {
    QPainter painter(this);
    painter.setRenderHint(QPainter::Antialiasing);
    painter.setPen(Qt::NoPen);
    painter.setBrush(palette().window());
    painter.drawRoundedRect(rect(), 10.0, 10.0);
}

} // namespace isoslider::widgets
