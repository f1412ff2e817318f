#include "ui/widgets/window/message_bar.h"

#include <QHBoxLayout>
#include <QKeyEvent>
#include <QLabel>
#include <QPushButton>
#include <QRegularExpression>
#include <QToolButton>
#include <QVBoxLayout>

#include "ui/widgets/common/icon_loader.h"
#include "ui/widgets/common/small_widgets.h"

namespace isoslider::widgets {
namespace {

constexpr int kInformationMs = 6000;

/// Names of files that no line has room for, without their middle.
QString withoutLongWords(QString text) {
    static const QRegularExpression longWord(QStringLiteral("(\\S{30})\\S{20,}(\\S{30})"));
    return text.replace(longWord, QStringLiteral("\\1…\\2"));
}

} // namespace

MessageBar::MessageBar(QWidget* parent)
    : QFrame(parent),
      icon_(new QLabel(this)),
      title_(new QLabel(this)),
      detail_(new QLabel(this)),
      close_(new QToolButton(this)) {
    setObjectName(QStringLiteral("messageBar"));
    setAutoFillBackground(true);
    auto* layout = new QHBoxLayout(this);
    layout->setContentsMargins(12, 8, 8, 8);
    layout->setSpacing(10);
    auto* texts = new QVBoxLayout;
    texts->setSpacing(1);
    QFont bold = title_->font();
    bold.setBold(true);
    title_->setFont(bold);
    for (QLabel* label : {title_, detail_}) {
        label->setTextFormat(Qt::PlainText);
        label->setWordWrap(true);
        label->setTextInteractionFlags(Qt::TextSelectableByMouse);
        label->setMinimumWidth(1); // a word as long as a file's name makes no wide window
        texts->addWidget(label);
    }
    close_->setObjectName(QStringLiteral("messageBarClose"));
    close_->setAutoRaise(true);
    close_->setToolTip(tr("Close this message"));
    close_->setAccessibleName(tr("Close message"));
    connect(close_, &QToolButton::clicked, this, &QWidget::hide);
    layout->addWidget(icon_, 0, Qt::AlignTop);
    layout->addLayout(texts, 1);
    offers_ = new QHBoxLayout;
    offers_->setSpacing(6);
    layout->addLayout(offers_);
    layout->addWidget(close_, 0, Qt::AlignTop);
    hideTimer_.setSingleShot(true);
    hideTimer_.setInterval(kInformationMs);
    connect(&hideTimer_, &QTimer::timeout, this, &QWidget::hide);
    hide();
}

void MessageBar::showOffer(const model::Notice& notice, const std::vector<Offer>& offers) {
    showNotice(notice);
    hideTimer_.stop();
    for (const Offer& offer : offers) {
        auto* button = new QPushButton(offer.text, this);
        button->setObjectName(QStringLiteral("messageBarOffer%1").arg(offers_->count()));
        connect(button, &QPushButton::clicked, this, [this, run = offer.run] {
            hide();
            run();
        });
        offers_->addWidget(button, 0, Qt::AlignVCenter);
    }
}

void MessageBar::showNotice(const model::Notice& notice) {
    while (QLayoutItem* item = offers_->takeAt(0)) {
        item->widget()->hide();
        item->widget()->deleteLater(); // one of them may be the sender
        delete item;
    }
    const bool isError = notice.severity == model::Notice::Severity::Error;
    title_->setText(withoutLongWords(QString::fromStdString(notice.title)));
    detail_->setText(QString::fromStdString(notice.detail));
    detail_->setVisible(!notice.detail.empty());
    setAccessibleName(text());
    const QString whole = QString::fromStdString(notice.title + '\n' + notice.detail);
    setToolTip(withoutLongWords(whole) != whole ? plainTip(whole) : QString()); // something may be cut off
    const bool isDark = parentWidget()->palette().color(QPalette::Window).lightness() < 128;
    const QColor accent = isError ? (isDark ? QColor(255, 138, 122) : QColor(176, 32, 20))
                                  : (isDark ? QColor(130, 190, 255) : QColor(20, 92, 170));
    QPalette colours = parentWidget()->palette();
    colours.setColor(QPalette::Window, isError ? (isDark ? QColor(74, 34, 32) : QColor(253, 228, 224))
                                               : (isDark ? QColor(32, 48, 68) : QColor(226, 239, 253)));
    setPalette(colours);
    close_->setIcon(themedIcon(QStringLiteral("close"), colours));
    icon_->setPixmap(
        themedPixmap(isError ? QStringLiteral("error") : QStringLiteral("info"), accent, 22, devicePixelRatioF()));
    if (isError)
        hideTimer_.stop();
    else
        hideTimer_.start();
    show();
}

QString MessageBar::text() const { return title_->text() + QStringLiteral("\n") + detail_->text(); }

// Escape closes the bar that has the focus, whatever it does elsewhere in the window.
bool MessageBar::event(QEvent* event) {
    if (event->type() == QEvent::ShortcutOverride && static_cast<QKeyEvent*>(event)->key() == Qt::Key_Escape)
        event->accept();
    return QFrame::event(event);
}

void MessageBar::keyPressEvent(QKeyEvent* event) {
    if (event->key() == Qt::Key_Escape)
        hide();
    else
        QFrame::keyPressEvent(event);
}

} // namespace isoslider::widgets
