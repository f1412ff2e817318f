#include "ui/widgets/panels/surface_editor.h"

#include <cmath>
#include <utility>

#include <QAbstractItemDelegate>
#include <QAction>
#include <QColorDialog>
#include <QHeaderView>
#include <QItemSelectionModel>
#include <QLabel>
#include <QMenu>
#include <QPixmap>
#include <QSignalBlocker>
#include <QSlider>
#include <QTableView>
#include <QToolButton>
#include <QVBoxLayout>

#include "ui/widgets/common/copying.h"
#include "ui/widgets/common/small_widgets.h"
#include "ui/widgets/panels/surface_table.h"

namespace isoslider::widgets {
namespace {

constexpr int kSwatch = 16;

QColor colourOf(const model::SurfaceColour& colour) { return {colour[0], colour[1], colour[2]}; }

QIcon swatchOf(const QColor& colour) {
    QPixmap picture(kSwatch, kSwatch);
    picture.fill(colour);
    return QIcon(picture);
}

/// Of an editor that Enter was pressed in, Qt says so only when events are handled next. If the surfaces are others by
/// then (another volume is there), it is hidden and about to be deleted, and nothing is left to be named by it.
class SurfaceRows : public QTableView {
public:
    using QTableView::QTableView;

protected:
    void commitData(QWidget* editor) override {
        if (!editor->isHidden())
            QTableView::commitData(editor);
    }
    void closeEditor(QWidget* editor, QAbstractItemDelegate::EndEditHint hint) override {
        if (!editor->isHidden())
            QTableView::closeEditor(editor, hint);
    }
};

} // namespace

SurfaceEditor::SurfaceEditor(model::SurfacesModel& surfaces, const Texts& texts, SurfaceTable::SpreadSource spread,
                             QWidget* parent)
    : QWidget(parent),
      surfaces_(surfaces),
      objectNames_(texts.objectNames),
      table_(new SurfaceTable(surfaces, texts.activeTip, std::move(spread), this)) {
    auto* layout = new QVBoxLayout(this);
    layout->setContentsMargins(0, 0, 0, 0);
    layout->setSpacing(6);
    makeTable(texts);
    layout->addWidget(view_, 1);
    makeColours();
    makeLook();
    subscription_ = surfaces_.observe([this] { showSurfaces(); });
    showSurfaces();
}

void SurfaceEditor::setTableActions(const QList<QAction*>& actions) {
    view_->addActions(actions);
    offerCopying(*view_);
}

void SurfaceEditor::makeTable(const Texts& texts) {
    view_ = new SurfaceRows(this);
    view_->setObjectName(objectNames_ + QStringLiteral("Table"));
    view_->setAccessibleName(texts.accessibleName);
    view_->setModel(table_);
    makePlain(*view_);
    view_->setSelectionBehavior(QAbstractItemView::SelectRows);
    view_->setSelectionMode(QAbstractItemView::SingleSelection);
    view_->setEditTriggers(QAbstractItemView::DoubleClicked | QAbstractItemView::EditKeyPressed);
    view_->setMinimumSize(80, 40);
    view_->verticalHeader()->setSectionResizeMode(QHeaderView::Fixed);
    view_->verticalHeader()->setDefaultSectionSize(fontMetrics().height() + 8);
    auto* header = view_->horizontalHeader();
    header->setMinimumSectionSize(24);
    header->setSectionResizeMode(QHeaderView::ResizeToContents);
    header->setSectionResizeMode(SurfaceTable::Name, QHeaderView::Stretch);
    connect(view_, &QTableView::clicked, this, &SurfaceEditor::pick);
    connect(view_, &QTableView::activated, this, &SurfaceEditor::pick);
    view_->setContextMenuPolicy(Qt::ActionsContextMenu);
}

void SurfaceEditor::makeColours() {
    colours_ = new QMenu(tr("&Colour"), this);
    for (const auto& named : model::kSurfaceColours)
        connect(colours_->addAction(swatchOf(colourOf(named.colour)), QLatin1String(named.name)), &QAction::triggered,
                this, [this, colour = colourOf(named.colour)] { setColour(colour); });
    colours_->addSeparator();
    connect(colours_->addAction(tr("&Other…")), &QAction::triggered, this, &SurfaceEditor::askColour);
}

void SurfaceEditor::makeLook() {
    colour_ = new QToolButton(this);
    colour_->setObjectName(objectNames_ + QStringLiteral("Colour"));
    colour_->setText(tr("Colour"));
    colour_->setToolTip(tr("Colour of the active surface"));
    colour_->setToolButtonStyle(Qt::ToolButtonTextBesideIcon);
    colour_->setAutoRaise(true);
    colour_->setMenu(colours_);
    colour_->setPopupMode(QToolButton::InstantPopup);
    const SliderRow opacity = makeSliderRow(tr("Opacity"), QStringLiteral("100 %"), this);
    opacity_ = opacity.slider;
    opacityValue_ = opacity.value;
    opacity_->setObjectName(objectNames_ + QStringLiteral("Opacity"));
    opacity_->setRange(static_cast<int>(std::lround(100.0 * model::kLeastOpacity)), 100);
    opacity_->setPageStep(10);
    opacity_->setAccessibleName(tr("Opacity of the active surface"));
    opacity_->setToolTip(tr("Opacity of the active surface; those of others are typed in the list"));
    opacity.row->insertWidget(0, colour_);
    static_cast<QVBoxLayout*>(layout())->addLayout(opacity.row);
    connect(opacity_, &QSlider::valueChanged, this, [this](int percent) {
        surfaces_.change(surfaces_.list().active,
                         [percent](model::ListedSurface& surface) { surface.opacity = percent / 100.0; });
    });
}

void SurfaceEditor::pick(const QModelIndex& index) {
    if (index.isValid() && index.column() != SurfaceTable::Shown && index.column() != SurfaceTable::Opacity)
        surfaces_.activate(table_->surfaceOf(index.row()));
}

void SurfaceEditor::setColour(const QColor& colour) {
    surfaces_.change(surfaces_.list().active, [&](model::ListedSurface& surface) {
        surface.colour = {static_cast<std::uint8_t>(colour.red()), static_cast<std::uint8_t>(colour.green()),
                          static_cast<std::uint8_t>(colour.blue())};
    });
}

void SurfaceEditor::askColour() {
    const auto* active = surfaces_.active();
    if (active == nullptr)
        return;
    auto* dialog = new QColorDialog(colourOf(active->colour), this);
    dialog->setObjectName(objectNames_ + QStringLiteral("ColourDialog"));
    dialog->setAttribute(Qt::WA_DeleteOnClose);
    connect(dialog, &QColorDialog::colorSelected, this, &SurfaceEditor::setColour);
    dialog->open();
}

void SurfaceEditor::editName() {
    const QModelIndex index = table_->index(table_->activeRow(), SurfaceTable::Name);
    view_->setFocus(Qt::ShortcutFocusReason);
    view_->setCurrentIndex(index);
    if (index.isValid() && !view_->isPersistentEditorOpen(index)) // which is true of any open editor
        view_->edit(index);
}

void SurfaceEditor::showSurfaces() {
    const auto* active = surfaces_.active();
    for (QWidget* widget : {static_cast<QWidget*>(colour_), static_cast<QWidget*>(opacity_)})
        widget->setEnabled(active != nullptr);
    colours_->setEnabled(active != nullptr);
    if (active == nullptr)
        return opacityValue_->clear();
    const int percent = static_cast<int>(std::lround(100.0 * active->opacity));
    {
        const QSignalBlocker blocker(opacity_); // a session may have steps in between
        opacity_->setValue(percent);
    }
    opacityValue_->setText(tr("%1 %").arg(percent));
    colour_->setIcon(swatchOf(colourOf(active->colour)));
    // Not while a surface slides: somebody may be typing in another row.
    const bool isOther = std::exchange(shownActive_, active->id) != active->id;
    if (isOther || !view_->currentIndex().isValid())
        view_->setCurrentIndex(table_->index(table_->activeRow(), SurfaceTable::Name));
}

} // namespace isoslider::widgets
