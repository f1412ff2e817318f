#include "ui/widgets/panels/compare_page.h"

#include <QAction>
#include <QHBoxLayout>
#include <QHeaderView>
#include <QLabel>
#include <QPushButton>
#include <QTableView>
#include <QVBoxLayout>

#include "ui/model/isovalue/number_text.h"
#include "ui/model/session/session.h"
#include "ui/model/topology/comparison.h"
#include "ui/widgets/common/small_widgets.h"
#include "ui/widgets/common/text_colour.h"
#include "ui/widgets/common/texts.h"
#include "ui/widgets/panels/fact_texts.h"
#include "ui/widgets/panels/text_table_model.h"
#include "ui/widgets/window/action_registry.h"

namespace isoslider::widgets {
namespace {

/// A button that does what an action does, and is enabled when it is.
QPushButton* makeButton(QAction* action, const QString& text, const char* name, QWidget* parent) {
    auto* button = new QPushButton(text, parent);
    button->setObjectName(QLatin1String(name));
    button->setToolTip(action->toolTip());
    const auto follow = [button, action] { button->setEnabled(action->isEnabled()); };
    QObject::connect(button, &QPushButton::clicked, action, &QAction::trigger);
    QObject::connect(action, &QAction::changed, button, follow);
    follow();
    return button;
}

} // namespace

ComparePage::ComparePage(model::Session& session, const ActionRegistry& actions, QWidget* parent)
    : QWidget(parent),
      session_(session),
      sides_(new TextTableModel({{QString(), {}}, {tr("Reference"), {}}, {tr("Here"), tr("The surface on screen")}},
                                this)) {
    auto* outer = new QVBoxLayout(this);
    outer->setContentsMargins(0, 0, 0, 0);
    const auto [area, page, rows] = makeScrollPage(this);
    outer->addWidget(area);
    rows->setSpacing(5);
    rows->addWidget(makeButtons(actions));
    hint_ = new QLabel(page);
    hint_->setObjectName(QStringLiteral("compareHint"));
    hint_->setWordWrap(true);
    hint_->setTextFormat(Qt::PlainText);
    makeQuiet(hint_);
    rows->addWidget(hint_);
    makeTable();
    rows->addWidget(table_);
    betweenHeading_ = makeHeading(tr("On the way from the reference"), page);
    rows->addWidget(betweenHeading_);
    between_ = new QWidget(page);
    between_->setObjectName(QStringLiteral("compareBetween"));
    auto* columns = new QHBoxLayout(between_);
    columns->setContentsMargins(0, 0, 0, 0);
    columns->setSpacing(12);
    pieces_ = new FactForm(between_);
    others_ = new FactForm(between_);
    columns->addWidget(pieces_, 4, Qt::AlignTop);
    columns->addWidget(others_, 5, Qt::AlignTop);
    rows->addWidget(between_);
    rows->addStretch(1);
    subscriptions_.push_back(session_.isovalue().observe([this] { showComparison(); }));
    subscriptions_.push_back(session_.topology().changed().observe([this] { compareAgain(); }));
    compareAgain();
}

QWidget* ComparePage::makeButtons(const ActionRegistry& actions) {
    auto* row = new QWidget(this);
    auto* layout = new QHBoxLayout(row);
    layout->setContentsMargins(0, 0, 0, 0);
    layout->addWidget(makeButton(actions.action("isovalue.compare"), tr("Compare with This"), "compareButton", row));
    swap_ = new QPushButton(tr("Swap"), row);
    swap_->setObjectName(QStringLiteral("compareSwap"));
    swap_->setEnabled(false);
    swap_->setToolTip(tr("Go to the reference, and make this isovalue the reference"));
    layout->addWidget(swap_);
    layout->addWidget(makeButton(actions.action("isovalue.stopComparing"), tr("Stop"), "compareStop", row));
    layout->addStretch(1);
    connect(swap_, &QPushButton::clicked, this, [this] {
        auto& isovalue = session_.isovalue();
        if (!isovalue.reference())
            return;
        const double reference = *isovalue.reference();
        isovalue.setReference(isovalue.requested());
        Q_EMIT isovaluePicked(reference);
    });
    return row;
}

void ComparePage::makeTable() {
    table_ = new QTableView(this);
    table_->setObjectName(QStringLiteral("compareTable"));
    table_->setAccessibleName(tr("Counts and measures of both surfaces"));
    table_->setModel(sides_);
    makePlain(*table_);
    table_->setSelectionMode(QAbstractItemView::NoSelection);
    table_->setVerticalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
    table_->verticalHeader()->setDefaultSectionSize(fontMetrics().height() + 3);
    table_->horizontalHeader()->setMinimumSectionSize(40);
    table_->horizontalHeader()->setSectionResizeMode(QHeaderView::Stretch);
}

// Nothing is counted for a page that nobody sees.
void ComparePage::showEvent(QShowEvent* event) {
    QWidget::showEvent(event);
    compareAgain();
}

// The isovalue also reports what changes nothing here.
void ComparePage::showComparison() {
    const auto& isovalue = session_.isovalue();
    swap_->setEnabled(isovalue.reference().has_value());
    const bool isSame = isovalue.reference() && isovalue.hasDisplayed() &&
                        compared_ == std::array{*isovalue.reference(), isovalue.displayed()};
    if (isVisible() && !isSame)
        compareAgain();
}

void ComparePage::compareAgain() {
    compared_.reset();
    if (!isVisible())
        return;
    const auto& isovalue = session_.isovalue();
    const auto& topology = session_.topology();
    const bool canCompare = isovalue.reference() && isovalue.hasDisplayed() && topology.summary() != nullptr;
    const auto compared = canCompare ? std::optional(model::compare(*topology.summary(), topology.changes(),
                                                                    *isovalue.reference(), isovalue.displayed()))
                                     : std::nullopt;
    const bool isShown = compared && compared->isOk();
    for (QWidget* part : {static_cast<QWidget*>(table_), betweenHeading_, between_})
        part->setVisible(isShown);
    if (isShown) {
        const model::Comparison& comparison = compared->value();
        compared_ = {comparison.reference, comparison.isovalue};
        hint_->setText(comparison.areCountsExact
                           ? QString()
                           : tr("Samples are missing: pieces and boundary loops are at least as many as stated."));
        showSides(comparison);
        showBetween(comparison);
    } else {
        hint_->setText(compared
                           ? tr("The comparison failed: %1").arg(fromStd(compared->error().line()))
                           : tr("Keep this isovalue as the reference (D), then slide: what lies between is counted "
                                "here as you go."));
    }
    hint_->setVisible(!hint_->text().isEmpty());
}

void ComparePage::showSides(const model::Comparison& comparison) {
    const auto* dataset = session_.dataset();
    const std::string unit = dataset != nullptr ? dataset->lengthUnit : std::string();
    const auto& [before, after] = std::tie(comparison.before, comparison.after);
    const auto value = [](double isovalue) { return fromStd(model::valueText(isovalue, 7)); };
    std::vector<QStringList> rows{{tr("Isovalue"), value(comparison.reference), value(comparison.isovalue)},
                                  {tr("Pieces"), grouped(before.components), grouped(after.components)}};
    if (comparison.areCountsExact)
        rows.push_back({tr("Tunnels"), grouped(before.handles()), grouped(after.handles())});
    rows.push_back({tr("Voids"), grouped(before.voids), grouped(after.voids)});
    rows.push_back({tr("Boundary loops"), grouped(before.loops), grouped(after.loops)});
    if (comparison.measuresBefore && comparison.measuresAfter) {
        const auto inUnit = [&](double measure, int power) {
            return inLengthUnit(fromStd(model::estimateText(measure)), unit, power);
        };
        rows.push_back(
            {tr("Area"), inUnit(comparison.measuresBefore->area, 2), inUnit(comparison.measuresAfter->area, 2)});
        rows.push_back({tr("Volume above"), inUnit(comparison.measuresBefore->volume, 3),
                        inUnit(comparison.measuresAfter->volume, 3)});
    }
    const auto count = static_cast<int>(rows.size());
    sides_->setRows(std::move(rows));
    table_->setFixedHeight(table_->horizontalHeader()->sizeHint().height() +
                           count * table_->verticalHeader()->defaultSectionSize() + 4);
}

void ComparePage::showBetween(const model::Comparison& comparison) {
    const auto* dataset = session_.dataset();
    const QString often = tr("How often, on the way");
    std::vector<Fact> pieces, facts;
    if (comparison.hasEvents) {
        pieces = {{tr("Pieces appear"), grouped(comparison.appear), often},
                  {tr("Pieces disappear"), grouped(comparison.disappear), often},
                  {tr("Events"), grouped(comparison.events), tr("Isovalues at which the topology changes")}};
        facts = {{tr("Pieces join"), grouped(comparison.join), often},
                 {tr("Pieces split"), grouped(comparison.split), often}};
    }
    pieces_->setFacts(pieces);
    if (comparison.volumeBetween)
        facts.push_back({tr("Volume between"),
                         inLengthUnit(fromStd(model::estimateText(*comparison.volumeBetween)),
                                      dataset != nullptr ? dataset->lengthUnit : std::string(), 3),
                         tr("About: between the isovalues measured, volumes are interpolated")});
    others_->setFacts(facts);
}

} // namespace isoslider::widgets
