#include "ui/widgets/panels/colour_panel.h"

#include <array>

#include <QAction>
#include <QComboBox>
#include <QGridLayout>
#include <QHBoxLayout>
#include <QLabel>
#include <QLineEdit>
#include <QPainter>
#include <QStandardItemModel>
#include <QToolButton>
#include <QVBoxLayout>

#include "ui/model/isovalue/number_text.h"
#include "ui/widgets/common/refusal_tip.h"
#include "ui/widgets/common/small_widgets.h"
#include "ui/widgets/common/text_colour.h"
#include "ui/widgets/common/texts.h"
#include "ui/widgets/viewport/viewport_host.h"
#include "ui/widgets/window/action_registry.h"
#include "ui/widgets/window/colour_wiring.h"

namespace isoslider::widgets {
namespace {

constexpr int kPiecesRow = 1; // of the first box; the others are those of kColourKeyActions
constexpr QSize kMapIcon(72, 14);
constexpr int kEditWidth = 70;
constexpr int kMostCharacters = 100; // more than any number that a person types

QIcon iconOf(model::ColourMap map, bool isReversed) {
    QPixmap picture(kMapIcon);
    QPainter painter(&picture);
    const auto colours = model::coloursOf(map, isReversed, kMapIcon.width());
    for (int x = 0; x < kMapIcon.width(); ++x) {
        const model::SeenColour& colour = colours[static_cast<std::size_t>(x)];
        painter.fillRect(x, 0, 1, kMapIcon.height(), QColor::fromRgbF(colour[0], colour[1], colour[2]));
    }
    return QIcon(picture);
}

/// Without the letter that is underlined, and without dots.
QString plainText(const QAction& action) { return action.text().remove(QLatin1Char('&')); }

const char* keyAction(int row) {
    if (row == kPiecesRow)
        return "pieces.colour";
    return kColourKeyActions[static_cast<std::size_t>(row > kPiecesRow ? row - 1 : row)].id;
}

} // namespace

ColourPanel::ColourPanel(ViewportHost& host, const ActionRegistry& actions, QWidget* parent)
    : QWidget(parent), host_(host), actions_(actions) {
    const ScrollPage page = fillWithScrollPage(this);
    page.rows->setSpacing(6);
    auto* grid = new QGridLayout;
    grid->setHorizontalSpacing(8);
    grid->setVerticalSpacing(6);
    grid->setColumnStretch(1, 1);
    makeChoices(grid);
    page.rows->addLayout(grid);
    makeRange(page.rows);
    page.rows->addStretch(1);
    subscriptions_.push_back(host_.colours().observe([this] { showColours(); }));
    for (int row = 0; row <= static_cast<int>(kColourKeyActions.size()); ++row)
        connect(actions_.action(keyAction(row)), &QAction::changed, this, &ColourPanel::showKeys);
    connect(actions_.action(kColourMapActions.front().id), &QAction::changed, this, &ColourPanel::enableMap);
    showColours();
}

void ColourPanel::makeChoices(QGridLayout* grid) {
    const auto makeBox = [this](const char* name) {
        auto* box = new QComboBox(this);
        box->setObjectName(QLatin1String(name));
        box->setMinimumContentsLength(8);
        box->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
        return box;
    };
    const auto addRow = [&](int line, const QString& text, QWidget* field) {
        auto* label = new QLabel(text, this);
        label->setBuddy(field);
        grid->addWidget(label, line, 0);
        grid->addWidget(field, line, 1);
        return label;
    };
    key_ = makeBox("colourKey");
    key_->setAccessibleName(tr("What the surface is coloured by"));
    for (int row = 0; row <= static_cast<int>(kColourKeyActions.size()); ++row)
        key_->addItem(row == kPiecesRow ? tr("Pieces") : plainText(*actions_.action(keyAction(row))));
    addRow(0, tr("Colour by"), key_);
    field_ = new ElidedLabel(this, Qt::ElideMiddle);
    field_->setObjectName(QStringLiteral("colourField"));
    makeQuiet(field_);
    grid->addWidget(field_, 1, 1);
    map_ = makeBox("colourMap");
    map_->setAccessibleName(tr("Colour map"));
    map_->setIconSize(kMapIcon);
    for (const auto& entry : kColourMapActions)
        map_->addItem(iconOf(entry.map, false), plainText(*actions_.action(entry.id)));
    mapNames_.push_back(addRow(2, tr("Colour map"), map_));
    connect(key_, &QComboBox::activated, this, [this](int row) {
        QAction* action = actions_.action(keyAction(row));
        if (row != kPiecesRow || !action->isChecked())
            action->trigger();
        showKeys(); // a second field may not be chosen after all
    });
    connect(map_, &QComboBox::activated, this,
            [this](int row) { actions_.action(kColourMapActions[static_cast<std::size_t>(row)].id)->trigger(); });
}

QLineEdit* ColourPanel::makeEdit(const char* name, const QString& accessibleName) {
    auto* edit = new QLineEdit(this);
    edit->setObjectName(QLatin1String(name));
    edit->setAccessibleName(accessibleName);
    edit->setMaxLength(kMostCharacters);
    edit->setMinimumWidth(kEditWidth);
    connect(edit, &QLineEdit::editingFinished, this, &ColourPanel::takeRange);
    connect(edit, &QLineEdit::textEdited, this, [this] {
        refusalTip_.hide();
        refusal_.clear();
        showNote();
    });
    return edit;
}

void ColourPanel::makeRange(QVBoxLayout* rows) {
    const auto addButtons = [&](std::initializer_list<const char*> ids) {
        auto* row = new QHBoxLayout;
        for (const char* id : ids)
            row->addWidget(makeToolButton(actions_.action(id), Qt::ToolButtonTextOnly, this));
        row->addStretch(1);
        rows->addLayout(row);
    };
    addButtons({"colour.reverse", "colour.bar"});
    auto* range = new QHBoxLayout;
    low_ = makeEdit("colourLow", tr("Value of the map's first colour"));
    high_ = makeEdit("colourHigh", tr("Value of the map's last colour"));
    auto* name = new QLabel(tr("Range"), this);
    name->setBuddy(low_);
    range->addWidget(name);
    range->addWidget(low_, 1);
    auto* to = new QLabel(tr("to"), this);
    range->addWidget(to);
    mapNames_.insert(mapNames_.end(), {name, to});
    range->addWidget(high_, 1);
    rows->addLayout(range);
    addButtons({"colour.automatic", "colour.fit"});
    note_ = new QLabel(this);
    note_->setObjectName(QStringLiteral("colourNote"));
    note_->setWordWrap(true);
    note_->setTextFormat(Qt::PlainText);
    makeQuiet(note_);
    rows->addWidget(note_);
}

// Both ends together: what does not ascend is not taken, and the panel states why.
void ColourPanel::takeRange() {
    auto& colours = host_.colours();
    if ((!low_->isModified() && !high_->isModified()) || colours.colours().by == model::ColourBy::One)
        return;
    const auto valueOf = [](const QLineEdit& edit, double shown) {
        return edit.isModified() ? model::numberFrom(edit.text().toStdString()) : std::optional(shown);
    };
    const auto low = valueOf(*low_, colours.colours().range.low), high = valueOf(*high_, colours.colours().range.high);
    const bool isMoving = sender() == low_ ? high_->hasFocus() : low_->hasFocus();
    if (low && high && model::isUsable({*low, *high})) {
        low_->setModified(false);
        high_->setModified(false);
        refusal_.clear();
        colours.change([&](model::Colouring& colouring) { colouring.range = model::ColourRange{*low, *high}; });
    } else if (isMoving && low && high) {
        return; // the other end follows
    } else {
        refuse(low, high);
    }
    low_->setModified(false);
    high_->setModified(false);
    showRange();
}

// Also in the note: who leaves a field sees no tip there.
void ColourPanel::refuse(const std::optional<double>& low, const std::optional<double>& high) {
    if (!low || !high)
        refusal_ = tr("“%1” is not a number").arg(quotedInput((low ? high_ : low_)->text()));
    else if (*low > *high)
        refusal_ = tr("The range was not changed: its first value, %1, is above its last, %2")
                       .arg(quotedInput(low_->text()), quotedInput(high_->text()));
    else if (*low == *high)
        refusal_ = tr("The range was not changed: both its values are %1").arg(quotedInput(low_->text()));
    else
        refusal_ = tr("The range was not changed: it is wider than numbers reach");
    for (QLineEdit* edit : {low_, high_})
        if (edit->hasFocus())
            refusalTip_.show(*edit, refusal_);
}

void ColourPanel::showColours() {
    const model::ColourModel& colours = host_.colours();
    const model::Colouring& wanted = colours.wanted();
    for (std::size_t i = 0; i < kColourMapActions.size(); ++i) {
        if (map_->itemData(static_cast<int>(i)).toBool() != wanted.isReversed)
            map_->setItemIcon(static_cast<int>(i), iconOf(kColourMapActions[i].map, wanted.isReversed));
        map_->setItemData(static_cast<int>(i), wanted.isReversed);
        if (kColourMapActions[i].map == wanted.map)
            map_->setCurrentIndex(static_cast<int>(i));
    }
    if (shownBy_ != wanted.by) // of what is not shown any more
        refusal_.clear();
    shownBy_ = wanted.by;
    field_->setVisible(wanted.by == model::ColourBy::Field && wanted.field);
    if (wanted.field)
        field_->setFullText(QString::fromStdU16String(wanted.field->path.filename().u16string()));
    showKeys();
    showRange();
}

void ColourPanel::showKeys() {
    auto* items = qobject_cast<QStandardItemModel*>(key_->model());
    bool isAnyPossible = false;
    for (int row = 0; row <= static_cast<int>(kColourKeyActions.size()); ++row) {
        const QAction& action = *actions_.action(keyAction(row));
        const bool isPossible = action.isEnabled();
        isAnyPossible = isAnyPossible || (isPossible && row != kPiecesRow);
        if (items->item(row)->isEnabled() != isPossible)
            items->item(row)->setEnabled(isPossible);
        if (items->item(row)->toolTip() != action.toolTip())
            items->item(row)->setToolTip(action.toolTip());
        if (action.isChecked())
            key_->setCurrentIndex(row);
    }
    key_->setEnabled(isAnyPossible);
    enableMap();
}

void ColourPanel::enableMap() {
    const bool hasMap = actions_.action(kColourMapActions.front().id)->isEnabled();
    map_->setEnabled(hasMap);
    for (QLabel* name : mapNames_)
        name->setEnabled(hasMap);
    for (QLineEdit* edit : {low_, high_})
        edit->setEnabled(hasMap && host_.colours().colours().by != model::ColourBy::One);
}

void ColourPanel::showRange() {
    const model::ColourModel& colours = host_.colours();
    const bool hasValues = colours.colours().by != model::ColourBy::One;
    const auto show = [&](QLineEdit* edit, double value) {
        if (edit->isModified() && edit->hasFocus())
            return; // somebody is typing
        edit->setText(hasValues ? fromStd(model::exactText(value)) : QString());
        edit->setCursorPosition(0);
    };
    show(low_, colours.colours().range.low);
    show(high_, colours.colours().range.high);
    enableMap();
    showNote();
}

void ColourPanel::showNote() {
    const model::ColourModel& colours = host_.colours();
    const bool hasValues = colours.colours().by != model::ColourBy::One;
    QStringList lines;
    if (hasValues && !refusal_.isEmpty())
        lines << refusal_ + QLatin1Char('.');
    if (colours.isMaking())
        lines << tr("The values are being read; see Jobs.");
    if (hasValues && !colours.wanted().range)
        lines << (colours.colours().field ? tr("The range is that of the volume without outliers; it stays while the "
                                               "isovalue slides.")
                                          : tr("The range is that of the volume; it stays while the isovalue slides."));
    if (hasValues && !colours.note().empty())
        lines << fromStd(colours.note()) + QLatin1Char('.');
    note_->setText(lines.join(QLatin1Char('\n')));
}

} // namespace isoslider::widgets
