#include "ui/widgets/window/cache_dialog.h"

#include <QDialogButtonBox>
#include <QDir>
#include <QDoubleSpinBox>
#include <QFormLayout>
#include <QLabel>
#include <QPushButton>
#include <QVBoxLayout>

#include "ui/model/isovalue/number_text.h"
#include "ui/model/session/session.h"
#include "ui/widgets/common/small_widgets.h"
#include "ui/widgets/common/text_colour.h"
#include "ui/widgets/window/settings_store.h"

namespace isoslider::widgets {
namespace {

constexpr double kBytesPerGiB = 1u << 30;
constexpr double kMostGiB = 100'000.0; // as in resources/settings.json

std::uint64_t bytesOf(double gib) { return static_cast<std::uint64_t>(gib * kBytesPerGiB); }

} // namespace

CacheDialog::CacheDialog(const model::Session& session, SettingsStore& settings, QWidget* parent)
    : QDialog(parent),
      session_(session),
      settings_(settings),
      usage_(new QLabel(tr("…"), this)),
      limit_(new QDoubleSpinBox(this)),
      clear_(new QPushButton(tr("&Remove All"), this)),
      job_(std::make_shared<model::BackgroundJobs>(session.services().postToMain)) {
    setObjectName(QStringLiteral("cacheDialog"));
    setAttribute(Qt::WA_DeleteOnClose);
    setWindowTitle(tr("Index Cache"));
    auto* text = new QLabel(tr("The index of a volume is kept, so that the volume opens at once the next time. "
                               "Beyond the limit, those not used for longest are removed."),
                            this);
    text->setWordWrap(true);
    makeQuiet(text);
    const auto& path = session.indexCache().folder();
    const QString shownPath = QDir::toNativeSeparators(QString::fromStdU16String(path.u16string()));
    auto* folder = new ElidedLabel(this, Qt::ElideMiddle);
    folder->setObjectName(QStringLiteral("cacheFolder"));
    folder->setFullText(shownPath);
    usage_->setObjectName(QStringLiteral("cacheUsage"));
    limit_->setObjectName(QStringLiteral("cacheLimit"));
    limit_->setRange(0.0, kMostGiB);
    limit_->setDecimals(1);
    limit_->setSuffix(tr(" GiB"));
    limit_->setStepType(QAbstractSpinBox::AdaptiveDecimalStepType);
    limit_->setKeyboardTracking(false); // a limit half typed would remove what is to stay
    limit_->setValue(settings.number("cache/limitGiB"));
    clear_->setObjectName(QStringLiteral("cacheClear"));
    clear_->setAutoDefault(false);
    clear_->setToolTip(tr("Remove all indexes but the one in use; they are built again when they are needed"));

    auto* form = new QFormLayout;
    form->addRow(tr("Folder"), folder);
    form->addRow(tr("In use"), usage_);
    form->addRow(tr("&Limit"), limit_);
    auto* buttons = new QDialogButtonBox(QDialogButtonBox::Close, this);
    buttons->addButton(clear_, QDialogButtonBox::ActionRole);
    buttons->button(QDialogButtonBox::Close)->setAutoDefault(false); // Return takes the number that is being typed
    auto* layout = new QVBoxLayout(this);
    layout->addWidget(text);
    layout->addSpacing(6);
    layout->addLayout(form);
    layout->addSpacing(6);
    layout->addWidget(buttons);
    setMinimumWidth(440);

    connect(buttons, &QDialogButtonBox::rejected, this, &QDialog::close);
    connect(limit_, &QDoubleSpinBox::valueChanged, this, &CacheDialog::changeLimit);
    connect(clear_, &QPushButton::clicked, this, [this] { look(&model::IndexCache::clear); });
    look(&model::IndexCache::trim);
}

void CacheDialog::applyLimit(const model::Session& session, const SettingsStore& settings) {
    session.indexCache().setLimit(bytesOf(settings.number("cache/limitGiB")));
}

void CacheDialog::changeLimit(double gib) {
    settings_.set("cache/limitGiB", gib);
    applyLimit(session_, settings_);
    look(&model::IndexCache::trim);
}

void CacheDialog::look(Usage (model::IndexCache::*change)(const std::filesystem::path& inUse) const) {
    const auto* dataset = session_.dataset();
    const auto inUse = dataset != nullptr ? dataset->indexPath : std::filesystem::path();
    job_.start(
        "Index cache",
        [cache = session_.indexCache(), inUse, change](const JobControl&) -> Result<Usage> {
            return (cache.*change)(inUse);
        },
        [this](Result<Usage> usage) {
            if (usage.isOk())
                showUsage(usage.value());
        });
}

void CacheDialog::showUsage(const Usage& usage) {
    const QString bytes = QString::fromStdString(model::bytesText(usage.bytes));
    usage_->setText(usage.indexes == 1 ? tr("%1 in one index").arg(bytes)
                                       : tr("%1 in %2 indexes").arg(bytes).arg(usage.indexes));
    clear_->setEnabled(usage.indexes > 0);
}

} // namespace isoslider::widgets
