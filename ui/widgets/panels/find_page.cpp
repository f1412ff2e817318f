#include "ui/widgets/panels/find_page.h"

#include <algorithm>

#include <QComboBox>
#include <QEvent>
#include <QHBoxLayout>
#include <QHeaderView>
#include <QKeyEvent>
#include <QLabel>
#include <QLineEdit>
#include <QStandardItemModel>
#include <QTreeWidget>
#include <QVBoxLayout>

#include "ui/model/isovalue/number_text.h"
#include "ui/model/session/session.h"
#include "ui/model/topology/question_model.h"
#include "ui/widgets/common/small_widgets.h"
#include "ui/widgets/common/text_colour.h"
#include "ui/widgets/panels/fact_texts.h"

namespace isoslider::widgets {
namespace {

constexpr int kColumnGap = 18;
constexpr int kIsovalueRole = Qt::UserRole;
constexpr int kMostSuggestionsAtOnce = 6; // in the height of their list

QString titleOf(model::QueryQuantity quantity) {
    switch (quantity) {
        case model::QueryQuantity::Pieces: return FindPage::tr("Pieces");
        case model::QueryQuantity::Tunnels: return FindPage::tr("Tunnels (genus)");
        case model::QueryQuantity::Voids: return FindPage::tr("Voids");
        case model::QueryQuantity::Loops: return FindPage::tr("Boundary loops");
        case model::QueryQuantity::Area: return FindPage::tr("Area");
        case model::QueryQuantity::Volume: return FindPage::tr("Volume above");
    }
    return {};
}

QTreeWidgetItem* makeRow(const QStringList& texts, double isovalue, const QFontMetrics& font) {
    auto* item = new QTreeWidgetItem(texts);
    item->setSizeHint(0, QSize(font.horizontalAdvance(texts.front()) + kColumnGap, font.height() + 5));
    item->setData(0, kIsovalueRole, isovalue);
    for (int column = 0; column < texts.size(); ++column)
        item->setToolTip(column, texts.at(column));
    return item;
}

} // namespace

FindPage::FindPage(model::Session& session, model::QuestionModel& question, QWidget* parent)
    : QWidget(parent), session_(session), question_(question) {
    auto* layout = new QVBoxLayout(this);
    layout->setContentsMargins(10, 8, 10, 8);
    layout->setSpacing(6);
    layout->addWidget(makeHeading(tr("Suggested isovalues"), this));
    suggestions_ = makeList("suggestedIsovalues", tr("Suggested isovalues"));
    layout->addWidget(suggestions_);
    layout->addSpacing(4);
    layout->addWidget(makeHeading(tr("Find isovalues with"), this));
    layout->addWidget(makeQuestion());
    answer_ = new QLabel(this);
    answer_->setObjectName(QStringLiteral("findAnswer"));
    answer_->setTextFormat(Qt::PlainText);
    answer_->setWordWrap(true);
    answer_->setSizePolicy(QSizePolicy::Ignored, QSizePolicy::Preferred);
    makeQuiet(answer_);
    layout->addWidget(answer_);
    found_ = makeList("foundIsovalues", tr("Isovalues found"));
    layout->addWidget(found_, 1);
    layout->addStretch(0);
    subscriptions_.push_back(session_.topology().changed().observe([this] {
        showSuggestions();
        showKnown();
    }));
    subscriptions_.push_back(session_.datasetChanged().observe([this] {
        showSuggestions();
        showKnown();
    }));
    subscriptions_.push_back(session_.isovalue().observe([this] {
        markPresent();
        showPresentValue();
    }));
    subscriptions_.push_back(question_.changed().observe([this] { showAnswer(); }));
    showSuggestions();
    showKnown();
    showAnswer();
}

QWidget* FindPage::makeQuestion() {
    auto* row = new QWidget(this);
    auto* layout = new QHBoxLayout(row);
    layout->setContentsMargins(0, 0, 0, 0);
    layout->setSpacing(6);
    quantity_ = new QComboBox(row);
    quantity_->setObjectName(QStringLiteral("findQuantity"));
    quantity_->setAccessibleName(tr("Find isovalues by"));
    quantity_->setMinimumWidth(60); // gives way in a narrow panel
    for (int quantity = 0; quantity < model::kQueryQuantities; ++quantity)
        quantity_->addItem(titleOf(static_cast<model::QueryQuantity>(quantity)));
    value_ = new QLineEdit(row);
    value_->setObjectName(QStringLiteral("findValue"));
    value_->setMinimumWidth(50);
    value_->setClearButtonEnabled(true);
    value_->setToolTip(tr("Isovalues are found while you type; Enter goes from one to the next"));
    value_->installEventFilter(this);
    unit_ = new QLabel(row);
    layout->addWidget(quantity_);
    layout->addWidget(value_, 1);
    layout->addWidget(unit_);
    connect(quantity_, &QComboBox::currentIndexChanged, this, [this] {
        showKnown();
        ask();
    });
    connect(value_, &QLineEdit::textEdited, this, &FindPage::ask);
    connect(value_, &QLineEdit::returnPressed, this, &FindPage::pickNextFound);
    // The button that clears edits nothing, says Qt.
    connect(value_, &QLineEdit::textChanged, this, [this](const QString& text) {
        if (text.isEmpty())
            ask();
    });
    return row;
}

QTreeWidget* FindPage::makeList(const char* name, const QString& accessibleName) {
    auto* list = new QTreeWidget(this);
    list->setObjectName(QLatin1String(name));
    list->setAccessibleName(accessibleName);
    list->setColumnCount(2);
    list->setHeaderHidden(true);
    list->setRootIsDecorated(false);
    list->setUniformRowHeights(true);
    list->setAlternatingRowColors(true);
    list->setFrameShape(QFrame::NoFrame);
    list->setTabKeyNavigation(false);
    list->setMinimumSize(80, 40);
    list->header()->setStretchLastSection(true);
    list->header()->setSectionResizeMode(0, QHeaderView::ResizeToContents);
    connect(list, &QTreeWidget::itemClicked, this, &FindPage::pick);
    connect(list, &QTreeWidget::itemActivated, this, &FindPage::pick);
    return list;
}

void FindPage::focusValue() {
    value_->setFocus(Qt::ShortcutFocusReason);
    value_->selectAll();
}

void FindPage::pick(const QTreeWidgetItem* item) {
    if (item != nullptr)
        Q_EMIT isovaluePicked(item->data(0, kIsovalueRole).toDouble());
}

// From one to the next, and from the last to the first.
void FindPage::pickNextFound() {
    const int count = found_->topLevelItemCount();
    if (count == 0 || question_.state() != model::QuestionState::Answered)
        return;
    const int row = found_->currentItem() != nullptr ? found_->indexOfTopLevelItem(found_->currentItem()) + 1 : 0;
    found_->setCurrentItem(found_->topLevelItem(row % count));
    pick(found_->currentItem());
}

void FindPage::ask() {
    question_.ask(static_cast<model::QueryQuantity>(quantity_->currentIndex()), value_->text().toStdString());
}

void FindPage::showSuggestions() {
    auto suggestions = session_.suggestions();
    if (suggestions == listed_ && suggestions_->topLevelItemCount() > 0)
        return;
    listed_ = std::move(suggestions);
    suggestions_->clear();
    for (const auto& one : listed_)
        suggestions_->addTopLevelItem(
            makeRow({fromStd(model::valueText(one.isovalue, 7)), fromStd(one.reason)}, one.isovalue, fontMetrics()));
    fitSuggestions();
    markPresent();
}

void FindPage::fitSuggestions() {
    const int rows = std::clamp(suggestions_->topLevelItemCount(), 1, kMostSuggestionsAtOnce);
    const int height = std::max(suggestions_->sizeHintForRow(0), fontMetrics().height() + 4);
    suggestions_->setFixedHeight(rows * height + 2);
}

// The one that is shown is selected.
void FindPage::markPresent() {
    QTreeWidgetItem* present = nullptr;
    for (int row = 0; row < suggestions_->topLevelItemCount() && present == nullptr; ++row)
        if (session_.isovalue().hasDomain() &&
            suggestions_->topLevelItem(row)->data(0, kIsovalueRole).toDouble() == session_.isovalue().requested())
            present = suggestions_->topLevelItem(row);
    if (present == nullptr)
        suggestions_->clearSelection();
    else if (!present->isSelected())
        suggestions_->setCurrentItem(present);
}

void FindPage::showKnown() {
    const auto& summary = session_.topology().summary();
    auto* items = qobject_cast<QStandardItemModel*>(quantity_->model());
    for (int row = 0; items != nullptr && row < quantity_->count(); ++row) {
        const bool isKnown = summary != nullptr && model::isKnown(*summary, static_cast<model::QueryQuantity>(row));
        items->item(row)->setEnabled(isKnown);
        items->item(row)->setToolTip(isKnown ? QString() : tr("Not known for this volume"));
    }
    unit_->setText(unitText());
    unit_->setVisible(!unit_->text().isEmpty());
    value_->setAccessibleName(unit_->text().isEmpty() ? quantity_->currentText()
                                                      : tr("%1 in %2").arg(quantity_->currentText(), unit_->text()));
    showPresentValue();
    showAnswer();
}

QString FindPage::unitText() const {
    const auto* dataset = session_.dataset();
    const int power = model::lengthPower(static_cast<model::QueryQuantity>(quantity_->currentIndex()));
    return power == 0 || dataset == nullptr ? QString() : inLengthUnit({}, dataset->lengthUnit, power).trimmed();
}

// What the surface on screen has, where nothing is typed: that is where a search begins.
void FindPage::showPresentValue() {
    const auto& summary = session_.topology().summary();
    const auto& isovalue = session_.isovalue();
    const auto quantity = static_cast<model::QueryQuantity>(quantity_->currentIndex());
    QString text;
    if (summary != nullptr && isovalue.hasDisplayed() && model::isKnown(*summary, quantity))
        if (const auto value = model::valueAt(*summary, quantity, isovalue.displayed()); value.isOk())
            text = tr("now %1").arg(fromStd(model::isCount(quantity)
                                                ? model::groupedText(static_cast<std::int64_t>(value.value()))
                                                : model::estimateText(value.value())));
    value_->setPlaceholderText(text);
}

void FindPage::showAnswer() {
    const auto state = question_.state();
    const auto* dataset = session_.dataset();
    answer_->setText(fromStd(question_.answerText(dataset != nullptr ? dataset->lengthUnit : std::string())));
    answer_->setVisible(!answer_->text().isEmpty());
    if (state == model::QuestionState::Searching)
        return; // what was found before stays till then
    found_->clear();
    for (const auto& interval : question_.found().intervals) {
        const bool isRange = interval.below != interval.above;
        found_->addTopLevelItem(makeRow(
            {fromStd(model::intervalText(interval)),
             isRange ? tr("%1 wide").arg(fromStd(model::valueText(interval.above - interval.below, 3))) : QString()},
            model::isovalueIn(interval), fontMetrics()));
    }
    found_->setVisible(found_->topLevelItemCount() > 0);
}

bool FindPage::eventFilter(QObject* watched, QEvent* event) {
    // Letters are typed here; Escape clears before it does anything else in the window.
    const auto key = [event] { return static_cast<QKeyEvent*>(event)->key(); };
    if (watched == value_ && event->type() == QEvent::ShortcutOverride && key() == Qt::Key_Escape &&
        !value_->text().isEmpty()) {
        event->accept();
        return true;
    }
    if (watched == value_ && event->type() == QEvent::KeyPress) {
        if (key() == Qt::Key_Escape && !value_->text().isEmpty()) {
            value_->clear();
            return true;
        }
        if (key() == Qt::Key_Down && found_->topLevelItemCount() > 0) {
            found_->setFocus();
            if (found_->currentItem() == nullptr)
                found_->setCurrentItem(found_->topLevelItem(0));
            return true;
        }
    }
    return QWidget::eventFilter(watched, event);
}

} // namespace isoslider::widgets
