#include "ui/widgets/panels/pieces_panel.h"

#include <algorithm>
#include <cmath>

#include <QAction>
#include <QGridLayout>
#include <QHeaderView>
#include <QItemSelectionModel>
#include <QLabel>
#include <QSignalBlocker>
#include <QSlider>
#include <QSpinBox>
#include <QTableView>
#include <QToolButton>
#include <QVBoxLayout>

#include "ui/model/isovalue/number_text.h"
#include "ui/model/session/session.h"
#include "ui/model/surface/view_state.h"
#include "ui/widgets/common/copying.h"
#include "ui/widgets/common/small_widgets.h"
#include "ui/widgets/common/text_colour.h"
#include "ui/widgets/common/texts.h"
#include "ui/widgets/panels/fact_texts.h"
#include "ui/widgets/panels/piece_details.h"
#include "ui/widgets/panels/piece_table.h"
#include "ui/widgets/window/action_registry.h"

namespace isoslider::widgets {
namespace {

constexpr int kSteps = 400;
constexpr double kDecades = 4.0; // of the sliders, down from the whole volume or the range of its scalars
constexpr int kPiecesIntervalMs = 60;

double amountAt(int step, double greatest) {
    return step == 0 ? 0.0 : greatest * std::pow(10.0, kDecades * (static_cast<double>(step) / kSteps - 1.0));
}

int stepOf(double amount, double greatest) {
    if (!(amount > 0.0))
        return 0;
    const double step = kSteps * (1.0 + std::log10(amount / greatest) / kDecades);
    return static_cast<int>(std::lround(std::clamp(step, 1.0, static_cast<double>(kSteps))));
}

} // namespace

PiecesPanel::PiecesPanel(model::Session& session, model::ViewState& viewState, const ActionRegistry& actions,
                         QWidget* parent)
    : QWidget(parent),
      session_(session),
      viewState_(viewState),
      table_(new PieceTable(this)),
      details_(new PieceDetails(session, this)),
      throttle_(kPiecesIntervalMs, [this] { showPieces(); }) {
    auto* layout = new QVBoxLayout(this);
    layout->setContentsMargins(10, 8, 10, 8);
    layout->setSpacing(6);
    auto* row = new QHBoxLayout;
    count_ = new ElidedLabel(this);
    count_->setObjectName(QStringLiteral("pieceCount"));
    row->addWidget(count_, 1);
    row->addWidget(makeToolButton(actions.action("pieces.all"), Qt::ToolButtonTextOnly, this));
    layout->addLayout(row);
    addControls(actions);
    makeTable(actions);
    layout->addWidget(view_, 1);
    layout->addWidget(details_);
    frameSubscription_ = session_.frameChanged().observe([this] { throttle_.trigger(); });
    optionsSubscription_ = viewState_.observe([this] { showPieces(); });
    showPieces();
}

void PiecesPanel::addControls(const ActionRegistry& actions) {
    const auto addSlider = [this](QSlider*& slider, QLabel*& value, const QString& caption, const char* name,
                                  const QString& accessibleName) {
        const SliderRow row = makeSliderRow(caption, QStringLiteral("0.0000 mm"), this);
        slider = row.slider;
        value = row.value;
        slider->setObjectName(QLatin1String(name));
        slider->setRange(0, kSteps);
        slider->setPageStep(kSteps / 20);
        slider->setAccessibleName(accessibleName);
        value->setObjectName(QLatin1String(name) + QLatin1String("Value"));
        static_cast<QVBoxLayout*>(layout())->addLayout(row.row);
    };
    addSlider(size_, sizeValue_, tr("Hide smaller than"), "pieceSize", tr("Hide pieces smaller than"));
    size_->setToolTip(tr("Pieces whose longest side is shorter are not drawn. The scale is logarithmic"));
    addSlider(persistence_, persistenceValue_, tr("Hide persistence below"), "piecePersistence",
              tr("Hide pieces of persistence below"));
    auto* second = new QHBoxLayout;
    auto* keep = new QLabel(tr("Show the largest"), this);
    largest_ = new QSpinBox(this);
    largest_->setObjectName(QStringLiteral("largestPieces"));
    largest_->setRange(0, model::kMostLargestPieces);
    largest_->setSpecialValueText(tr("all"));
    largest_->setAccessibleName(tr("Show so many of the largest pieces"));
    keep->setBuddy(largest_);
    second->addWidget(keep);
    second->addWidget(largest_);
    second->addStretch(1);
    second->addWidget(makeToolButton(actions.action("pieces.colour"), Qt::ToolButtonTextOnly, this));
    static_cast<QVBoxLayout*>(layout())->addLayout(second);
    connect(largest_, &QSpinBox::valueChanged, this, [this](int count) {
        auto options = viewState_.options();
        options.pieces.largest = static_cast<std::uint32_t>(count);
        viewState_.setOptions(options);
    });
    connect(size_, &QSlider::valueChanged, this, [this](int step) {
        auto options = viewState_.options();
        options.pieces.leastSize = amountAt(step, largestSize());
        viewState_.setOptions(options);
    });
    connect(persistence_, &QSlider::valueChanged, this, [this](int step) {
        auto options = viewState_.options();
        options.pieces.leastPersistence = amountAt(step, rangeOfScalars());
        viewState_.setOptions(options);
    });
}

void PiecesPanel::makeTable(const ActionRegistry& actions) {
    view_ = new QTableView(this);
    view_->setObjectName(QStringLiteral("pieceTable"));
    view_->setAccessibleName(tr("Largest pieces"));
    view_->setModel(table_);
    makePlain(*view_);
    view_->setSelectionBehavior(QAbstractItemView::SelectRows);
    view_->setSelectionMode(QAbstractItemView::SingleSelection);
    view_->setEditTriggers(QAbstractItemView::NoEditTriggers);
    view_->setMinimumSize(80, 40);
    view_->verticalHeader()->setSectionResizeMode(QHeaderView::Fixed);
    view_->verticalHeader()->setDefaultSectionSize(fontMetrics().height() + 6);
    view_->horizontalHeader()->setSectionResizeMode(QHeaderView::Stretch);
    connect(view_->selectionModel(), &QItemSelectionModel::currentRowChanged, this, [this](const QModelIndex& index) {
        if (isShowing_) // rows that go take the current one along: nobody has picked another
            return;
        Q_EMIT piecePicked(index.isValid() ? std::optional(table_->pieceOf(index.row())) : std::nullopt);
    });
    connect(view_, &QTableView::clicked, this,
            [this](const QModelIndex& index) { Q_EMIT piecePicked(table_->pieceOf(index.row())); });
    for (const char* action : {"pieces.hide", "pieces.only", "pieces.all"})
        view_->addAction(actions.action(action));
    offerCopying(*view_);
}

void PiecesPanel::setSeen(bool isSeen) {
    isSeen_ = isSeen;
    showPieces();
}

double PiecesPanel::largestSize() const {
    const auto* dataset = session_.dataset();
    if (dataset == nullptr)
        return 1.0;
    double largest = 0.0;
    for (int axis = 0; axis < 3; ++axis)
        largest = std::max(largest, static_cast<double>(dataset->geometry.dims[static_cast<std::size_t>(axis)] - 1) *
                                        std::abs(dataset->geometry.spacing[axis]));
    return largest > 0.0 ? largest : 1.0;
}

double PiecesPanel::rangeOfScalars() const {
    const auto* dataset = session_.dataset();
    const double range = dataset != nullptr ? dataset->max - dataset->min : 1.0;
    return range > 0.0 && std::isfinite(range) ? range : 1.0;
}

void PiecesPanel::showPersistence(const model::PieceOptions& options) {
    const model::ShortLivedPieces* found = options.leastPersistence > 0.0 ? options.shortLived.get() : nullptr;
    const bool isRefused = found != nullptr && !found->error.empty();
    setReadout(persistenceValue_, isRefused ? QStringLiteral("–")
                                  : options.leastPersistence > 0.0
                                      ? fromStd(model::valueText(options.leastPersistence, 3))
                                      : tr("show all"));
    QString tip =
        tr("Pieces that come and go within a smaller change of the isovalue are not drawn: those of noise. Found "
           "where the surface rests, from the samples. The scale is logarithmic");
    if (isRefused)
        tip = tr("No piece is hidden by persistence: %1").arg(fromStd(found->error));
    else if (found != nullptr && !found->isComplete)
        tip += tr(". Of some pieces it was not found out how long they last, they are so large; these are drawn");
    for (QWidget* widget : {static_cast<QWidget*>(persistence_), static_cast<QWidget*>(persistenceValue_)})
        widget->setToolTip(plainTip(tip));
}

// The row of the selected piece, which may have moved.
void PiecesPanel::selectRow() {
    const int row = table_->rowOf(viewState_.options().pieces.selected);
    if (row < 0) {
        view_->clearSelection();
        view_->selectionModel()->clearCurrentIndex();
    } else if (!view_->selectionModel()->isRowSelected(row, {})) {
        view_->selectRow(row);
    }
}

void PiecesPanel::showPieces() {
    const auto options = viewState_.options().pieces;
    const auto* dataset = session_.dataset();
    const std::string unit = dataset != nullptr ? dataset->lengthUnit : std::string();
    {
        const QSignalBlocker blocker(size_);
        size_->setValue(stepOf(options.leastSize, largestSize()));
        const QSignalBlocker persistenceBlocker(persistence_);
        persistence_->setValue(stepOf(options.leastPersistence, rangeOfScalars()));
        const QSignalBlocker largestBlocker(largest_);
        if (const int largest = static_cast<int>(options.largest); largest != largest_->value())
            largest_->setValue(largest); // otherwise left alone: somebody may be typing
    }
    setReadout(sizeValue_, options.leastSize > 0.0
                               ? inLengthUnit(QString::fromStdString(model::valueText(options.leastSize, 3)), unit)
                               : tr("show all"));
    size_->setEnabled(dataset != nullptr);
    persistence_->setEnabled(dataset != nullptr);
    showPersistence(options);
    if (!isSeen_)
        return details_->show(nullptr, std::nullopt, unit);
    const auto frame = session_.frame();
    details_->show(frame, options.selected, unit);
    isShowing_ = true;
    table_->show(frame.get(), options, unit);
    selectRow();
    isShowing_ = false;
    if (!frame || !frame->pieces) {
        count_->setFullText(!frame               ? tr("No surface")
                            : frame->findsPieces ? tr("Not known for this picture")
                                                 : tr("Finding pieces…"));
        return;
    }
    const auto counts = model::PieceDisplay(*frame->pieces, frame->geometry, options).counts();
    QString text = counts.all == 1 ? tr("1 piece") : tr("%1 pieces").arg(grouped(counts.all));
    if (counts.shown < counts.all)
        text += tr(", %1 hidden").arg(grouped(counts.all - counts.shown));
    count_->setFullText(text);
}

} // namespace isoslider::widgets
