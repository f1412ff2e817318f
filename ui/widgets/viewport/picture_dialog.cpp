#include "ui/widgets/viewport/picture_dialog.h"

#include <algorithm>
#include <array>

#include <QCheckBox>
#include <QComboBox>
#include <QDialogButtonBox>
#include <QFormLayout>
#include <QHBoxLayout>
#include <QLabel>
#include <QPushButton>
#include <QSignalBlocker>
#include <QSpinBox>
#include <QVBoxLayout>

#include "ui/widgets/common/text_colour.h"

namespace isoslider::widgets {
namespace {

constexpr std::array<int, 3> kPictureScales{1, 2, 4}; // times the view

/// The widest whose other side is not too long either.
int widestPicture(QSize view) {
    PictureChoice widest;
    widest.scale = 0;
    widest.width = PictureChoice::kMostSide;
    return std::max(PictureChoice::kLeastWidth, widest.sizeOf(view).width());
}

} // namespace

PictureDialog::PictureDialog(const PictureChoice& last, QSize view, QWidget* parent)
    : QDialog(parent),
      view_(view),
      ownWidth_(last.width),
      scale_(new QComboBox(this)),
      width_(new QSpinBox(this)),
      height_(new QLabel(this)),
      transparent_(new QCheckBox(tr("&Transparent background"), this)) {
    setObjectName(QStringLiteral("pictureDialog"));
    setAttribute(Qt::WA_DeleteOnClose);
    setWindowTitle(tr("Save View as Image"));
    scale_->setObjectName(QStringLiteral("pictureScale"));
    for (const int times : kPictureScales)
        scale_->addItem(times == 1 ? tr("As in the window") : tr("%1 times the window").arg(times), times);
    scale_->addItem(tr("Other width"), 0);
    scale_->setCurrentIndex(std::max(0, scale_->findData(last.scale)));
    width_->setObjectName(QStringLiteral("pictureWidth"));
    width_->setAccessibleName(tr("Width in pixels"));
    width_->setRange(PictureChoice::kLeastWidth, widestPicture(view));
    width_->setValue(last.width);
    transparent_->setObjectName(QStringLiteral("pictureTransparent"));
    transparent_->setToolTip(tr("The surface stands on whatever the picture is laid upon: an alpha channel in place of "
                                "the background"));
    transparent_->setChecked(last.isTransparent);
    makeQuiet(height_);

    auto* pixels = new QHBoxLayout;
    pixels->addWidget(width_);
    pixels->addWidget(height_, 1);
    auto* form = new QFormLayout;
    form->addRow(tr("&Size"), scale_);
    auto* widthName = new QLabel(tr("&Width"), this);
    widthName->setBuddy(width_);
    form->addRow(widthName, pixels);
    form->addRow(QString(), transparent_);
    auto* buttons = new QDialogButtonBox(QDialogButtonBox::Cancel, this);
    auto* save = buttons->addButton(tr("Save &As…"), QDialogButtonBox::AcceptRole);
    save->setObjectName(QStringLiteral("pictureSave"));
    save->setDefault(true);
    auto* layout = new QVBoxLayout(this);
    layout->addLayout(form);
    layout->addSpacing(6);
    layout->addWidget(buttons);
    setMinimumWidth(380);

    connect(scale_, &QComboBox::currentIndexChanged, this, &PictureDialog::showSize);
    connect(width_, &QSpinBox::valueChanged, this, [this](int width) {
        ownWidth_ = width;
        showSize();
    });
    connect(buttons, &QDialogButtonBox::rejected, this, &QDialog::reject);
    connect(buttons, &QDialogButtonBox::accepted, this, [this] {
        const PictureChoice chosenNow = choice();
        accept();
        Q_EMIT chosen(chosenNow);
    });
    showSize();
}

PictureChoice PictureDialog::choice() const {
    PictureChoice choice;
    choice.scale = scale_->currentData().toInt();
    choice.width = ownWidth_;
    choice.isTransparent = transparent_->isChecked();
    return choice;
}

void PictureDialog::showSize() {
    const bool isOther = scale_->currentData().toInt() == 0;
    const QSize size = choice().sizeOf(view_);
    width_->setEnabled(isOther);
    const QSignalBlocker quiet(width_);
    width_->setValue(size.width());
    height_->setText(tr("× %1 pixels").arg(size.height()));
}

} // namespace isoslider::widgets
