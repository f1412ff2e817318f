#include "ui/widgets/opening/raw_import_dialog.h"

#include <limits>

#include <QCheckBox>
#include <QComboBox>
#include <QDoubleSpinBox>
#include <QFormLayout>
#include <QHBoxLayout>
#include <QHeaderView>
#include <QLabel>
#include <QPushButton>
#include <QSpinBox>
#include <QTableView>
#include <QVBoxLayout>

#include "ui/model/isovalue/number_text.h"
#include "ui/widgets/common/small_widgets.h"
#include "ui/widgets/common/texts.h"
#include "ui/widgets/opening/preview_pane.h"
#include "ui/widgets/panels/fact_texts.h"
#include "ui/widgets/panels/text_table_model.h"

namespace isoslider::widgets {
namespace {

constexpr int kLeftWidth = 430;
constexpr int kRowsShown = 6;

QStringList rowOf(const model::RawGuess& guess) {
    const auto& layout = guess.layout;
    const bool hasOrder = scalarTypeSizeBytes(layout.type) > 1;
    return {dimsText(layout.dims) + (guess.isNamed ? RawImportDialog::tr("  (in the name)") : QString()),
            fromStd(std::string(scalarTypeName(layout.type))),
            !hasOrder            ? QStringLiteral("–")
            : layout.isBigEndian ? RawImportDialog::tr("big")
                                 : RawImportDialog::tr("little"),
            grouped(layout.skipBytes), QStringLiteral("%1 %").arg(qRound(guess.smoothness * 100.0))};
}

} // namespace

RawImportDialog::RawImportDialog(std::unique_ptr<model::RawImportModel> model, QWidget* parent)
    : QDialog(parent), model_(std::move(model)) {
    setObjectName(QStringLiteral("rawImportDialog"));
    setAttribute(Qt::WA_DeleteOnClose);
    setWindowTitle(tr("Import Raw Samples"));
    auto* left = makeLeft();
    pane_ = new PreviewPane(this);
    const auto frame =
        layOutFileDialog(this, QString::fromStdU16String(model_->path().filename().u16string()), left, pane_);
    frame.top->addWidget(new QLabel(
        tr("This file has no header: state how its %1 bytes are arranged.").arg(grouped(model_->fileBytes())), this));
    open_ = frame.open;
    open_->setObjectName(QStringLiteral("rawOpen"));
    connect(open_, &QPushButton::clicked, this, [this] {
        if (!model_->canOpen())
            return;
        Q_EMIT openRequested(QString::fromStdU16String(model_->path().u16string()), model_->options());
        accept();
    });
    resize(1090, 640);
    subscription_ = model_->changed().observe([this] { showState(); });
    showState();
}

RawImportDialog::~RawImportDialog() = default;

QWidget* RawImportDialog::makeLeft() {
    auto* left = new QWidget(this);
    left->setFixedWidth(kLeftWidth);
    auto* rows = new QVBoxLayout(left);
    rows->setContentsMargins(0, 0, 0, 0);
    rows->setSpacing(8);
    makeGuesses(rows, left);
    makeForm(rows, left);
    makeWarning(rows, left);
    rows->addStretch(1);
    return left;
}

void RawImportDialog::makeGuesses(QVBoxLayout* rows, QWidget* page) {
    guessHint_ = new QLabel(page);
    guesses_ = new QTableView(page);
    guessHint_->setBuddy(guesses_);
    guesses_->setObjectName(QStringLiteral("rawGuesses"));
    guesses_->setAccessibleName(tr("Likely arrangements, best first"));
    guessRows_ = new TextTableModel({{tr("Grid points"), tr("Along x, y and z")},
                                     {tr("Type"), tr("Of a sample")},
                                     {tr("Order"), tr("Of the bytes of a sample: little or big end first")},
                                     {tr("Skip"), tr("Bytes before the first sample")},
                                     {tr("Smooth"), tr("How alike neighbours are along x, y and z")}},
                                    this);
    guesses_->setModel(guessRows_);
    guesses_->setSelectionBehavior(QAbstractItemView::SelectRows);
    guesses_->setSelectionMode(QAbstractItemView::SingleSelection);
    guesses_->setAlternatingRowColors(true);
    guesses_->setShowGrid(false);
    guesses_->setWordWrap(false);
    guesses_->setTabKeyNavigation(false);
    guesses_->verticalHeader()->hide();
    guesses_->verticalHeader()->setDefaultSectionSize(fontMetrics().height() + 8);
    guesses_->horizontalHeader()->setHighlightSections(false);
    guesses_->horizontalHeader()->setSectionResizeMode(QHeaderView::ResizeToContents);
    guesses_->horizontalHeader()->setSectionResizeMode(0, QHeaderView::Stretch);
    guesses_->setFixedHeight(guesses_->horizontalHeader()->sizeHint().height() +
                             kRowsShown * guesses_->verticalHeader()->defaultSectionSize() +
                             2 * guesses_->frameWidth());
    rows->addWidget(guessHint_);
    rows->addWidget(guesses_);
    connect(guesses_->selectionModel(), &QItemSelectionModel::currentRowChanged, this, [this](const QModelIndex& row) {
        if (row.isValid() && !isShowing_)
            model_->takeGuess(static_cast<std::size_t>(row.row()));
    });
    connect(guesses_, &QTableView::doubleClicked, this, [this] { open_->click(); });
}

void RawImportDialog::makeForm(QVBoxLayout* rows, QWidget* page) {
    auto* form = new QFormLayout;
    form->setHorizontalSpacing(14);
    form->setFieldGrowthPolicy(QFormLayout::AllNonFixedFieldsGrow);
    for (auto& box : dims_) {
        box = new QSpinBox(page);
        box->setRange(0, static_cast<int>(kMaxDim));
        connect(box, &QSpinBox::valueChanged, this, &RawImportDialog::takeLayout);
    }
    for (auto& box : spacing_) {
        box = new QDoubleSpinBox(page);
        box->setDecimals(6);
        box->setRange(1e-6, 1e6);
        box->setStepType(QAbstractSpinBox::AdaptiveDecimalStepType);
        connect(box, &QDoubleSpinBox::valueChanged, this, &RawImportDialog::takeLayout);
    }
    type_ = new QComboBox(page);
    type_->setObjectName(QStringLiteral("rawType"));
    for (const ScalarType type : kAllScalarTypes)
        type_->addItem(typeText(type));
    skip_ = new QSpinBox(page);
    skip_->setObjectName(QStringLiteral("rawSkip"));
    skip_->setRange(0, std::numeric_limits<int>::max());
    skip_->setGroupSeparatorShown(true);
    skip_->setSuffix(tr(" bytes"));
    bigEndian_ = new QCheckBox(tr("&Big-endian samples"), page);
    bigEndian_->setObjectName(QStringLiteral("rawBigEndian"));
    trailing_ = new QCheckBox(tr("&Allow more bytes than needed"), page);
    trailing_->setObjectName(QStringLiteral("rawTrailing"));
    fit_ = new QLabel(page);
    fit_->setObjectName(QStringLiteral("rawFit"));
    fit_->setWordWrap(true);
    form->addRow(tr("&Grid points X, Y, Z"),
                 makeAxisRow({dims_[0], dims_[1], dims_[2]}, "rawDim", tr("Grid points"), page));
    form->addRow(tr("&Sample type"), type_);
    form->addRow(QString(), bigEndian_);
    form->addRow(tr("S&kip at the start"), skip_);
    form->addRow(tr("S&pacing X, Y, Z"),
                 makeAxisRow({spacing_[0], spacing_[1], spacing_[2]}, "rawSpacing", tr("Spacing"), page));
    form->addRow(QString(), trailing_);
    form->addRow(QString(), fit_);
    rows->addLayout(form);
    connect(type_, &QComboBox::currentIndexChanged, this, &RawImportDialog::takeLayout);
    connect(skip_, &QSpinBox::valueChanged, this, &RawImportDialog::takeLayout);
    connect(bigEndian_, &QCheckBox::toggled, this, &RawImportDialog::takeLayout);
    connect(trailing_, &QCheckBox::toggled, this, [this](bool isOn) {
        if (!isShowing_)
            model_->setAllowsTrailing(isOn);
    });
}

void RawImportDialog::makeWarning(QVBoxLayout* rows, QWidget* page) {
    warning_ = new QWidget(page);
    warning_->setObjectName(QStringLiteral("rawSwapWarning"));
    auto* layout = new QHBoxLayout(warning_);
    layout->setContentsMargins(0, 0, 0, 0);
    warningText_ = new QLabel(warning_);
    warningText_->setWordWrap(true);
    auto* swap = new QPushButton(tr("S&wap Bytes"), warning_);
    swap->setObjectName(QStringLiteral("rawSwap"));
    swap->setAutoDefault(false);
    layout->addWidget(warningText_, 1);
    layout->addWidget(swap);
    rows->addWidget(warning_);
    connect(swap, &QPushButton::clicked, this, [this] { model_->swapByteOrder(); });
}

void RawImportDialog::takeLayout() {
    if (isShowing_)
        return;
    io::RawLayout layout;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        layout.dims[axis] = dims_[axis]->value();
        layout.spacing[static_cast<int>(axis)] = spacing_[axis]->value();
    }
    layout.type = static_cast<ScalarType>(type_->currentIndex());
    layout.skipBytes = static_cast<std::uint64_t>(skip_->value());
    layout.isBigEndian = bigEndian_->isChecked();
    model_->setLayout(layout);
}

void RawImportDialog::showState() {
    isShowing_ = true;
    showLayout();
    showGuesses();
    showFit();
    isShowing_ = false;
    open_->setEnabled(model_->canOpen());
    pane_->showPreview(model_->preview());
}

void RawImportDialog::showLayout() {
    const auto& layout = model_->layout();
    for (std::size_t axis = 0; axis < 3; ++axis) {
        dims_[axis]->setValue(static_cast<int>(layout.dims[axis]));
        spacing_[axis]->setValue(layout.spacing[static_cast<int>(axis)]);
    }
    type_->setCurrentIndex(static_cast<int>(layout.type));
    skip_->setValue(static_cast<int>(layout.skipBytes));
    bigEndian_->setChecked(layout.isBigEndian);
    bigEndian_->setEnabled(scalarTypeSizeBytes(layout.type) > 1);
    trailing_->setChecked(model_->allowsTrailing());
}

void RawImportDialog::showGuesses() {
    std::vector<QStringList> rows;
    for (const auto& guess : model_->guesses())
        rows.push_back(rowOf(guess));
    guessHint_->setText(model_->isRanking() ? tr("Looking for likely arrangements…")
                        : rows.empty()      ? tr("No usual arrangement takes all bytes; type what you know:")
                                            : tr("&Likely arrangements, best first:"));
    guessRows_->setRows(std::move(rows));
    const auto chosen = model_->chosenGuess();
    if (chosen && guesses_->currentIndex().row() != static_cast<int>(*chosen))
        guesses_->selectRow(static_cast<int>(*chosen));
    else if (!chosen && guesses_->currentIndex().isValid())
        guesses_->setCurrentIndex(QModelIndex());
}

void RawImportDialog::showFit() {
    using Fit = model::RawImportModel::Fit;
    const auto needed = model_->neededBytes(), there = model_->fileBytes();
    switch (model_->fit()) {
        case Fit::NoVolume: fit_->setText(tr("Each axis needs at least 2 grid points.")); break;
        case Fit::Exact: fit_->setText(tr("✓ %1 bytes needed, all that are in the file").arg(grouped(needed))); break;
        case Fit::FileLonger:
            fit_->setText(tr("%1 %2 bytes needed; the file has %3 more")
                              .arg(model_->allowsTrailing() ? QStringLiteral("✓") : QStringLiteral("✗"),
                                   grouped(needed), grouped(there - needed)));
            break;
        case Fit::FileShorter:
            fit_->setText(tr("✗ %1 bytes needed; the file is %2 short").arg(grouped(needed), grouped(needed - there)));
            break;
    }
    const auto* swap = model_->swapWarning();
    warning_->setVisible(swap != nullptr);
    if (swap != nullptr)
        warningText_->setText(
            tr("⚠ With the bytes of samples swapped, neighbours are %1 times as alike.")
                .arg(fromStd(model::valueText(swap->roughness / std::max(swap->swappedRoughness, 1e-3), 2))));
}

} // namespace isoslider::widgets
