#include "ui/widgets/slices/slice_workspace.h"

#include <utility>

#include <QHBoxLayout>
#include <QSplitter>

#include "ui/widgets/slices/slice_pane.h"

namespace isoslider::widgets {
namespace {

using model::SliceKind;
using model::SliceLayout;

constexpr int kHandle = 4;

QSplitter* makeSplitter(Qt::Orientation orientation, const char* name, QWidget* parent) {
    auto* splitter = new QSplitter(orientation, parent);
    splitter->setObjectName(QLatin1String(name));
    splitter->setHandleWidth(kHandle);
    splitter->setChildrenCollapsible(false);
    return splitter;
}

/// By parts of what there is.
void divide(QSplitter* splitter, double first) {
    constexpr double kWhole = 10'000.0;
    splitter->setSizes({static_cast<int>(first * kWhole), static_cast<int>((1.0 - first) * kWhole)});
}

} // namespace

SliceWorkspace::SliceWorkspace(model::SliceModel& model, QWidget* view, QWidget* parent)
    : QWidget(parent), model_(model), view_(view) {
    setObjectName(QStringLiteral("sliceWorkspace"));
    columns_ = makeSplitter(Qt::Horizontal, "sliceColumns", this);
    left_ = makeSplitter(Qt::Vertical, "sliceLeftColumn", columns_);
    right_ = makeSplitter(Qt::Vertical, "sliceRightColumn", columns_);
    left_->addWidget(view_);
    for (const SliceKind kind : {SliceKind::Z, SliceKind::Y, SliceKind::X, SliceKind::Oblique}) {
        auto* pane = new SlicePane(model_, kind, right_);
        panes_[placeOf(kind)] = pane;
        right_->addWidget(pane);
        pane->hide();
    }
    right_->hide();
    auto* layout = new QHBoxLayout(this);
    layout->setContentsMargins(0, 0, 0, 0);
    layout->addWidget(columns_);
    // In 2 x 2 the lines between the rows stay one line.
    connect(left_, &QSplitter::splitterMoved, this, [this] {
        if (shown_ == SliceLayout::Four)
            right_->setSizes(left_->sizes());
    });
    connect(right_, &QSplitter::splitterMoved, this, [this] {
        if (shown_ == SliceLayout::Four)
            left_->setSizes({right_->sizes().value(0), right_->sizes().value(1)});
    });
    subscription_ = model_.observe([this] { showLayout(); });
    showLayout();
}

void SliceWorkspace::place(SlicePane* pane, QSplitter* column, int row) {
    if (column->indexOf(pane) != row)
        column->insertWidget(row, pane);
}

void SliceWorkspace::showLayout() {
    const SliceLayout layout = model_.options().layout;
    const bool hasVolume = model_.dataset() != nullptr;
    if (layout != shown_) {
        shown_ = layout;
        isDivided_ = false;
        if (layout == SliceLayout::Four)
            place(panes_[placeOf(SliceKind::X)], left_, 1);
        else
            place(panes_[placeOf(SliceKind::X)], right_, 2);
    }
    for (const SliceKind kind : model::kSliceKinds)
        panes_[placeOf(kind)]->setVisible(hasVolume && model_.isInPane(kind));
    right_->setVisible(hasVolume && layout != SliceLayout::None);
    if (!hasVolume || std::exchange(isDivided_, true))
        return;
    divide(columns_, layout == SliceLayout::Three ? 0.68 : layout == SliceLayout::One ? 0.58 : 0.5);
    divide(left_, 0.5);
    right_->setSizes({10'000, 10'000, 10'000, 10'000});
}

} // namespace isoslider::widgets
