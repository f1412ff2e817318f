#include "ui/widgets/opening/start_page.h"

#include <algorithm>

#include <QAction>
#include <QCoreApplication>
#include <QDir>
#include <QEvent>
#include <QIcon>
#include <QLabel>
#include <QPainter>
#include <QPushButton>
#include <QVBoxLayout>

#include "ui/widgets/common/text_colour.h"
#include "ui/widgets/opening/recent_files.h"
#include "ui/widgets/window/action_registry.h"

namespace isoslider::widgets {
namespace {

constexpr std::size_t kMostRecent = 5;
constexpr int kRecentMargin = 78; // of a row: page and button
constexpr int kLeastFolderWidth = 40;
constexpr int kWidth = 440;

QPushButton* actionButton(QAction* action, const QString& text, QWidget* parent) {
    auto* button = new QPushButton(action->icon(), text, parent);
    button->setObjectName(QStringLiteral("start.") + action->objectName());
    button->setToolTip(action->toolTip());
    button->setMinimumHeight(34);
    button->setIconSize(QSize(20, 20));
    QObject::connect(button, &QPushButton::clicked, action, &QAction::trigger);
    return button;
}

} // namespace

StartPage::StartPage(const ActionRegistry& actions, QWidget* parent)
    : QFrame(parent),
      scroll_(fillWithScrollPage(this)),
      recentLayout_(new QVBoxLayout),
      recentHeading_(new QLabel(tr("Recent files"), scroll_.page)) {
    setObjectName(QStringLiteral("startPage"));
    setFrameShape(QFrame::NoFrame);
    setMaximumWidth(kWidth);
    scroll_.area->viewport()->setAutoFillBackground(false);
    scroll_.page->setAutoFillBackground(false);
    QVBoxLayout* layout = scroll_.rows;
    layout->setContentsMargins(34, 28, 34, 26);
    layout->setSpacing(8);
    auto* logo = new QLabel(scroll_.page);
    logo->setPixmap(
        QIcon(QStringLiteral(":/isoslider/icons/isoslider.svg")).pixmap(QSize(72, 72), devicePixelRatioF()));
    auto* name = new QLabel(QStringLiteral("ISOSLIDER"), scroll_.page);
    QFont font = name->font();
    font.setPointSizeF(font.pointSizeF() * 1.9);
    font.setWeight(QFont::DemiBold);
    font.setLetterSpacing(QFont::AbsoluteSpacing, 2.0);
    name->setFont(font);
    auto* claim = new QLabel(tr("Slide isosurfaces through large volumes"), scroll_.page);
    makeQuiet(claim);
    layout->addWidget(logo, 0, Qt::AlignHCenter);
    layout->addWidget(name, 0, Qt::AlignHCenter);
    layout->addWidget(claim, 0, Qt::AlignHCenter);
    layout->addSpacing(14);
    auto* open = actionButton(actions.action("file.open"), tr("Open volume…"), scroll_.page);
    open->setDefault(true);
    layout->addWidget(open);
    layout->addWidget(actionButton(actions.action("file.sampleBluntFin"), tr("Open sample: Blunt Fin"), scroll_.page));
    layout->addWidget(
        actionButton(actions.action("file.sampleShell"), tr("Open sample: Spherical Shell"), scroll_.page));
    auto* drop = new QLabel(tr("or drop a file or folder here"), scroll_.page);
    makeQuiet(drop);
    layout->addWidget(drop, 0, Qt::AlignHCenter);
    layout->addSpacing(8);
    QFont bold = recentHeading_->font();
    bold.setBold(true);
    recentHeading_->setFont(bold);
    layout->addWidget(recentHeading_);
    recentLayout_->setSpacing(0);
    layout->addLayout(recentLayout_);
    setRecentFiles({});
}

QSize StartPage::sizeHint() const { return {kWidth, scroll_.page->sizeHint().height()}; }

void StartPage::setRecentFiles(const std::vector<model::RecentFile>& files) {
    while (QLayoutItem* item = recentLayout_->takeAt(0)) {
        delete item->widget();
        delete item;
    }
    for (std::size_t i = 0; i < std::min(files.size(), kMostRecent); ++i) {
        const auto& file = files[i];
        auto* button = new QPushButton(scroll_.page);
        button->setFlat(true);
        button->setStyleSheet(QStringLiteral("text-align: left; padding: 4px 2px;"));
        const QString folder = QDir::toNativeSeparators(QString::fromStdU16String(file.path.parent_path().u16string()));
        const QString title = fontMetrics().elidedText(recentTitle(file), Qt::ElideMiddle, kWidth - kRecentMargin);
        const int room = kWidth - kRecentMargin - fontMetrics().horizontalAdvance(title + QStringLiteral("   "));
        button->setText(room < kLeastFolderWidth ? title
                                                 : QStringLiteral("%1   %2").arg(
                                                       title, fontMetrics().elidedText(folder, Qt::ElideMiddle, room)));
        button->setToolTip(recentTip(file));
        connect(button, &QPushButton::clicked, this, [this, file] { Q_EMIT openRequested(file); });
        recentLayout_->addWidget(button);
    }
    recentHeading_->setVisible(!files.empty());
    QCoreApplication::postEvent(this, new QEvent(QEvent::LayoutRequest)); // to be placed again
}

void StartPage::paintEvent(QPaintEvent*) {
    QPainter painter(this);
    painter.setRenderHint(QPainter::Antialiasing);
    painter.setPen(Qt::NoPen);
    painter.setBrush(palette().window());
    painter.drawRoundedRect(rect(), 12.0, 12.0);
}

} // namespace isoslider::widgets
