#include "ui/widgets/raw_import_dialog.h"

#include <limits>

#include <QCheckBox>
#include <QComboBox>
#include <QDialogButtonBox>
#include <QDoubleSpinBox>
#include <QFormLayout>
#include <QHBoxLayout>
#include <QLabel>
#include <QPushButton>
#include <QSpinBox>

#include "ui/model/number_text.h"
#include "ui/model/raw_guess.h"

namespace isoslider::widgets {
namespace {

QString grouped(std::uint64_t value) { return QString::fromStdString(model::groupedText(value)); }

template <class Box>
QWidget* inARow(const std::array<Box*, 3>& boxes, const char* objectName, const QString& name, QWidget* parent) {
    auto* row = new QWidget(parent);
    auto* layout = new QHBoxLayout(row);
    layout->setContentsMargins(0, 0, 0, 0);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        boxes[axis]->setObjectName(QLatin1String(objectName) + QLatin1Char("XYZ"[axis]));
        boxes[axis]->setAccessibleName(name + QLatin1Char(' ') + QLatin1Char("XYZ"[axis]));
        layout->addWidget(boxes[axis]);
    }
    return row;
}

} // namespace

RawImportDialog::RawImportDialog(std::filesystem::path path, std::uint64_t fileBytes, QWidget* parent)
    : QDialog(parent), path_(std::move(path)), fileBytes_(fileBytes) {
    setObjectName(QStringLiteral("rawImportDialog"));
    setAttribute(Qt::WA_DeleteOnClose);
    setWindowTitle(tr("Open Raw Volume"));
    makeForm();
    const auto guess = model::guessRawLayout(path_.filename().string(), fileBytes_);
    for (std::size_t axis = 0; axis < 3; ++axis)
        dims_[axis]->setValue(static_cast<int>(guess.dims[axis]));
    type_->setCurrentIndex(static_cast<int>(guess.type));
    showFit();
}

void RawImportDialog::makeForm() {
    auto* form = new QFormLayout(this);
    form->setContentsMargins(18, 16, 18, 14);
    auto* file = new QLabel(tr("%1 has no header: say how its %2 bytes are arranged.")
                                .arg(QString::fromStdString(path_.filename().string()), grouped(fileBytes_)), this);
    file->setTextFormat(Qt::PlainText);
    for (auto& box : dims_) {
        box = new QSpinBox(this);
        box->setRange(0, static_cast<int>(kMaxDim));
        connect(box, &QSpinBox::valueChanged, this, &RawImportDialog::showFit);
    }
    for (auto& box : spacing_) {
        box = new QDoubleSpinBox(this);
        box->setDecimals(6);
        box->setRange(1e-6, 1e6);
        box->setValue(1.0);
    }
    type_ = new QComboBox(this);
    type_->setObjectName(QStringLiteral("rawType"));
    type_->addItems({tr("8 bits, unsigned"), tr("8 bits, signed"), tr("16 bits, unsigned"), tr("16 bits, signed"),
                     tr("32 bits, signed"), tr("32 bits, floating point"), tr("64 bits, floating point")});
    skip_ = new QSpinBox(this);
    skip_->setRange(0, std::numeric_limits<int>::max());
    skip_->setSuffix(tr(" bytes"));
    bigEndian_ = new QCheckBox(tr("Big-endian samples"), this);
    trailing_ = new QCheckBox(tr("Allow more bytes than needed"), this);
    fit_ = new QLabel(this);
    fit_->setObjectName(QStringLiteral("rawFit"));
    auto* buttons = new QDialogButtonBox(QDialogButtonBox::Open | QDialogButtonBox::Cancel, this);
    open_ = buttons->button(QDialogButtonBox::Open);
    open_->setObjectName(QStringLiteral("rawOpen"));
    form->addRow(file);
    form->addRow(tr("Grid points X, Y, Z"), inARow(dims_, "rawDim", tr("Grid points"), this));
    form->addRow(tr("Sample type"), type_);
    form->addRow(tr("Spacing X, Y, Z"), inARow(spacing_, "rawSpacing", tr("Spacing"), this));
    form->addRow(tr("Skip at the start"), skip_);
    form->addRow(QString(), bigEndian_);
    form->addRow(QString(), trailing_);
    form->addRow(fit_);
    form->addRow(buttons);
    connect(type_, &QComboBox::currentIndexChanged, this, &RawImportDialog::showFit);
    connect(skip_, &QSpinBox::valueChanged, this, &RawImportDialog::showFit);
    connect(trailing_, &QCheckBox::toggled, this, &RawImportDialog::showFit);
    connect(buttons, &QDialogButtonBox::rejected, this, &QDialog::reject);
    connect(buttons, &QDialogButtonBox::accepted, this, [this] {
        Q_EMIT openRequested(QString::fromStdU16String(path_.u16string()), optionsAsked());
        accept();
    });
}

io::RawLayout RawImportDialog::layoutAsked() const {
    io::RawLayout layout;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        layout.dims[axis] = dims_[axis]->value();
        layout.spacing[static_cast<int>(axis)] = spacing_[axis]->value();
    }
    layout.type = static_cast<ScalarType>(type_->currentIndex());
    layout.skipBytes = static_cast<std::uint64_t>(skip_->value());
    layout.isBigEndian = bigEndian_->isChecked();
    return layout;
}

io::ReadOptions RawImportDialog::optionsAsked() const {
    io::ReadOptions options;
    options.raw = layoutAsked();
    options.allowsTrailing = trailing_->isChecked();
    return options;
}

void RawImportDialog::showFit() {
    const auto layout = layoutAsked();
    const bool hasDims = layout.dims[0] > 1 && layout.dims[1] > 1 && layout.dims[2] > 1;
    const std::uint64_t needed = model::layoutBytes(layout);
    const bool isFitting = hasDims && (needed == fileBytes_ || (trailing_->isChecked() && needed < fileBytes_));
    if (!hasDims)
        fit_->setText(tr("Each axis needs at least 2 grid points."));
    else if (isFitting)
        fit_->setText(tr("✓ %1 bytes needed, %2 in the file").arg(grouped(needed), grouped(fileBytes_)));
    else
        fit_->setText(tr("✗ %1 bytes needed, but %2 in the file").arg(grouped(needed), grouped(fileBytes_)));
    open_->setEnabled(isFitting);
}

} // namespace isoslider::widgets
