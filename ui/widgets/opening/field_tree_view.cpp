#include "ui/widgets/opening/field_tree_view.h"

#include <algorithm>

#include <QHeaderView>
#include <QStyledItemDelegate>

#include "ui/widgets/opening/field_tree_model.h"

namespace isoslider::widgets {
namespace {

constexpr int kMostRowsShown = 12;
constexpr std::size_t kMostUnfolded = 200; // nodes; of larger files only what leads to the chosen one
constexpr int kIndentation = 14;
constexpr int kRowPadding = 8;

/// Rows of even height.
class RowDelegate : public QStyledItemDelegate {
public:
    using QStyledItemDelegate::QStyledItemDelegate;
    QSize sizeHint(const QStyleOptionViewItem& option, const QModelIndex& index) const override {
        QSize size = QStyledItemDelegate::sizeHint(option, index);
        size.setHeight(option.fontMetrics.height() + kRowPadding);
        return size;
    }
};

} // namespace

FieldTreeView::FieldTreeView(const QString& nameHeading, QWidget* parent)
    : QTreeView(parent), model_(new FieldTreeModel(nameHeading, this)) {
    setModel(model_);
    setItemDelegate(new RowDelegate(this));
    setUniformRowHeights(true);
    setIndentation(kIndentation);
    setSelectionMode(QAbstractItemView::SingleSelection);
    setAlternatingRowColors(true);
    setAllColumnsShowFocus(true);
    setTextElideMode(Qt::ElideMiddle);
    header()->setSectionsMovable(false);
    header()->setStretchLastSection(false);
    header()->setSectionResizeMode(QHeaderView::ResizeToContents);
    header()->setSectionResizeMode(FieldTreeModel::Name, QHeaderView::Stretch);
    connect(this, &QTreeView::doubleClicked, this, [this](const QModelIndex& index) {
        if (model_->fieldAt(index))
            Q_EMIT fieldOpened();
    });
}

bool FieldTreeView::hasContents() const { return model_->rowCount() > 0; }

void FieldTreeView::setContents(io::VolumeContents contents) {
    isShowing_ = true; // what was selected goes
    model_->setContents(std::move(contents));
    field_ = 0;
    isShowing_ = false;
    setRootIsDecorated(model_->tree().hasGroups());
    spanTexts({});
    setColumnHidden(FieldTreeModel::Parts, !model_->hasParts());
    if (model_->tree().size() <= kMostUnfolded)
        expandAll();
    // The same whatever is folded: what lies below does not jump.
    const int rows = std::min(kMostRowsShown, static_cast<int>(model_->tree().size()) - 1);
    setFixedHeight(header()->sizeHint().height() + rows * (fontMetrics().height() + kRowPadding) + 2 * frameWidth());
}

void FieldTreeView::spanTexts(const QModelIndex& parent) {
    for (int row = 0; row < model_->rowCount(parent); ++row) {
        const QModelIndex index = model_->index(row, 0, parent);
        setFirstColumnSpanned(row, parent, model_->isOneText(index));
        spanTexts(index);
    }
}

void FieldTreeView::setField(std::size_t field) {
    if (field == field_ && selectionModel()->hasSelection())
        return;
    isShowing_ = true;
    field_ = field;
    const QModelIndex index = model_->indexOf(field);
    setCurrentIndex(index); // which unfolds its groups
    scrollTo(index);
    isShowing_ = false;
}

void FieldTreeView::selectionChanged(const QItemSelection& selected, const QItemSelection& deselected) {
    QTreeView::selectionChanged(selected, deselected);
    if (isShowing_ || !hasContents())
        return;
    const auto rows = selectionModel()->selectedRows();
    const auto field = rows.isEmpty() ? std::nullopt : model_->fieldAt(rows.first());
    if (!field) { // the keys or the mouse came to a group
        isShowing_ = true;
        selectionModel()->select(model_->indexOf(field_),
                                 QItemSelectionModel::ClearAndSelect | QItemSelectionModel::Rows);
        isShowing_ = false;
    } else if (*field != field_) {
        field_ = *field;
        Q_EMIT fieldChosen(static_cast<int>(field_));
    }
}

} // namespace isoslider::widgets
