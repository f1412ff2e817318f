#include "ui/widgets/panels/levels_panel.h"

#include <QHeaderView>
#include <QLabel>
#include <QTableView>
#include <QVBoxLayout>

#include "core/extract/live/brick_picture.h"
#include "ui/model/isovalue/number_text.h"
#include "ui/model/session/session.h"
#include "ui/widgets/common/copying.h"
#include "ui/widgets/common/small_widgets.h"
#include "ui/widgets/common/text_colour.h"
#include "ui/widgets/common/texts.h"
#include "ui/widgets/panels/fact_texts.h"
#include "ui/widgets/panels/text_table_model.h"

namespace isoslider::widgets {
namespace {

constexpr int kMoveIntervalMs = 60;

QString compact(std::uint64_t value) { return QString::fromStdString(model::compactText(value)).trimmed(); }
QString bytes(std::uint64_t value) { return QString::fromStdString(model::bytesText(value)); }
std::vector<TextTableModel::Column> levelColumns() {
    return {
        {LevelsPanel::tr("Level"), LevelsPanel::tr("Skip level; 0 has one block per distinct value")},
        {LevelsPanel::tr("Blocks"), {}},
        {LevelsPanel::tr("Records"), LevelsPanel::tr("Grid points with edges; in an index of metacells, bricks")},
        {LevelsPanel::tr("Entries"), LevelsPanel::tr("Edges, or bricks, that become active or inactive")},
        {LevelsPanel::tr("Bytes"), LevelsPanel::tr("Encoded size")},
        {LevelsPanel::tr("B/voxel"), LevelsPanel::tr("Encoded bytes per grid point of the volume")},
        {LevelsPanel::tr("Removed"), LevelsPanel::tr("Share of the level below's entries that were redundant here")}};
}

std::vector<TextTableModel::Column> walkColumns() {
    return {{LevelsPanel::tr("Level"), LevelsPanel::tr("Skip level of this part of the walk")},
            {LevelsPanel::tr("Blocks"), LevelsPanel::tr("Blocks read")},
            {LevelsPanel::tr("Entries"), LevelsPanel::tr("Edges, or bricks, decoded")},
            {LevelsPanel::tr("Bytes"), LevelsPanel::tr("Encoded bytes decoded")}};
}

std::vector<QStringList> levelRows(const model::Dataset& dataset) {
    std::vector<QStringList> rows;
    const auto& info = *dataset.index;
    const auto points = static_cast<double>(std::max<std::int64_t>(1, pointCount(dataset.geometry.dims)));
    index::SkipLevelInfo all;
    for (std::size_t level = 0; level < info.levels.size(); ++level) {
        const auto& counts = info.levels[level];
        const auto below = level > 0 ? info.levels[level - 1].edges : 0;
        const QString removed =
            below == 0
                ? QStringLiteral("–")
                : QStringLiteral("%1 %").arg(
                      100.0 * static_cast<double>(counts.redundantRemoved) / static_cast<double>(below), 0, 'f', 1);
        rows.push_back({QString::number(level), compact(counts.blocks), compact(counts.points), compact(counts.edges),
                        bytes(counts.bytes), QString::number(static_cast<double>(counts.bytes) / points, 'f', 2),
                        removed});
        all.blocks += counts.blocks;
        all.points += counts.points;
        all.edges += counts.edges;
        all.bytes += counts.bytes;
    }
    const auto addPart = [&](const QString& name, std::uint64_t size) {
        if (size > 0)
            rows.push_back(
                {name, {}, {}, {}, bytes(size), QString::number(static_cast<double>(size) / points, 'f', 2), {}});
        all.bytes += size;
    };
    addPart(LevelsPanel::tr("Samples"), info.chunkBytes);
    rows.push_back({LevelsPanel::tr("All"),
                    compact(all.blocks),
                    compact(all.points),
                    compact(all.edges),
                    bytes(all.bytes),
                    QString::number(static_cast<double>(all.bytes) / points, 'f', 2),
                    {}});
    return rows;
}

std::vector<Fact> factsOfMove(const extract::SurfaceFrame& frame, const model::IsovalueModel& isovalue) {
    const auto& stats = frame.stats;
    const auto value = [](double v) { return QString::fromStdString(model::valueText(v, 8)); };
    const auto time = [](double ms) { return QString::fromStdString(model::millisecondsText(ms)); };
    std::vector<Fact> facts{
        {LevelsPanel::tr("Isovalue"),
         LevelsPanel::tr("%1 requested, %2 displayed").arg(value(isovalue.requested()), value(isovalue.displayed())),
         {}},
        {LevelsPanel::tr("Update"),
         frame.isWholeExtraction
             ? LevelsPanel::tr("whole extraction, %1").arg(time(stats.updateMs))
             : LevelsPanel::tr("%1, %2").arg(stats.hasRebuilt ? LevelsPanel::tr("rebuilt") : LevelsPanel::tr("patched"),
                                             time(stats.updateMs)),
         LevelsPanel::tr("A surface that mostly changes is rebuilt; otherwise only what changes is patched")}};
    if (!frame.isWholeExtraction) {
        facts.push_back({LevelsPanel::tr("Edges"),
                         LevelsPanel::tr("%1 added, %2 removed, %3 touched")
                             .arg(grouped(stats.edgesAdded), grouped(stats.edgesRemoved), grouped(stats.edgesTouched)),
                         LevelsPanel::tr("Touched counts every entry looked at, redundant ones included")});
        facts.push_back({LevelsPanel::tr("Retriangulated"),
                         LevelsPanel::tr("%1 cells").arg(grouped(stats.cellsRetriangulated)),
                         {}});
        if (stats.bricksRead > 0 || !frame.isFromIndex)
            facts.push_back({LevelsPanel::tr("Looked into"),
                             LevelsPanel::tr("%1 bricks of samples").arg(grouped(stats.bricksRead)),
                             LevelsPanel::tr("Bricks of 8 x 8 x 8 grid points that a sample on the way lies in")});
        if (frame.isFromIndex)
            facts.push_back(
                {LevelsPanel::tr("Read from disk"),
                 stats.bytesAhead > 0
                     ? LevelsPanel::tr("%1, %2 ahead of the move").arg(bytes(stats.bytesRead), bytes(stats.bytesAhead))
                     : bytes(stats.bytesRead),
                 {}});
    }
    if (frame.bricks)
        facts.push_back(
            {LevelsPanel::tr("To the card"), bytes(frame.bricks->newBytes()),
             LevelsPanel::tr(
                 "Edges and triangles of the bricks that this move has changed: what is sent to the graphics card")});
    facts.push_back({LevelsPanel::tr("Active edges"), countText(frame, stats.activeEdges), {}});
    return facts;
}

/// The name of a part that has no counts takes their place too: its own column is a narrow one.
void spanNames(QTableView& table) {
    table.clearSpans();
    const auto& model = *table.model();
    const auto isEmpty = [&model](int row, int column) { return model.index(row, column).data().toString().isEmpty(); };
    for (int row = 0; row < model.rowCount(); ++row) {
        int columns = 1;
        while (columns < model.columnCount() && isEmpty(row, columns))
            ++columns;
        if (columns > 1)
            table.setSpan(row, 0, 1, columns);
    }
}

} // namespace

LevelsPanel::LevelsPanel(model::Session& session, QWidget* parent)
    : QWidget(parent),
      session_(session),
      levels_(new TextTableModel(levelColumns(), this)),
      walk_(new TextTableModel(walkColumns(), this)),
      levelsHint_(new QLabel(this)),
      walkHint_(new QLabel(this)),
      levelsTable_(makeTable(levels_, QStringLiteral("levelsTable"))),
      walkTable_(makeTable(walk_, QStringLiteral("walkTable"))),
      moveFacts_(new FactForm(this)),
      moveThrottle_(kMoveIntervalMs, [this] { showMove(); }) {
    const auto [scroll, page, layout] = fillWithScrollPage(this);
    layout->setSpacing(6);
    for (QLabel* hint : {levelsHint_, walkHint_}) {
        hint->setWordWrap(true);
        makeQuiet(hint);
    }
    layout->addWidget(makeHeading(tr("Skip levels"), page));
    layout->addWidget(levelsHint_);
    layout->addWidget(levelsTable_);
    layout->addSpacing(6);
    layout->addWidget(makeHeading(tr("Last move"), page));
    layout->addWidget(walkHint_);
    layout->addWidget(walkTable_);
    layout->addWidget(moveFacts_);
    layout->addStretch(1);
    datasetSubscription_ = session_.datasetChanged().observe([this] { showLevels(); });
    frameSubscription_ = session_.frameChanged().observe([this] { moveThrottle_.trigger(); });
    showLevels();
    showMove();
}

QTableView* LevelsPanel::makeTable(TextTableModel* model, const QString& name) {
    auto* table = new QTableView(this);
    table->setObjectName(name);
    table->setModel(model);
    makePlain(*table);
    table->setSelectionBehavior(QAbstractItemView::SelectRows);
    table->verticalHeader()->setDefaultSectionSize(fontMetrics().height() + 6);
    table->horizontalHeader()->setSectionResizeMode(QHeaderView::ResizeToContents);
    table->horizontalHeader()->setSectionResizeMode(0, QHeaderView::Stretch);
    table->horizontalHeader()->setMinimumSectionSize(40);
    table->setVerticalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
    const auto fit = [table, model] {
        const int rows = model->rowCount();
        spanNames(*table);
        table->setFixedHeight(table->horizontalHeader()->sizeHint().height() +
                              rows * table->verticalHeader()->defaultSectionSize() + 4);
        table->setVisible(rows > 0);
    };
    connect(model, &QAbstractItemModel::modelReset, table, fit);
    fit();
    offerCopying(*table);
    return table;
}

void LevelsPanel::showLevels() {
    const auto* dataset = session_.dataset();
    const bool hasIndex = dataset != nullptr && dataset->index.has_value();
    levels_->setRows(hasIndex ? levelRows(*dataset) : std::vector<QStringList>{});
    levelsHint_->setVisible(!hasIndex);
    levelsHint_->setText(dataset == nullptr ? tr("No volume is open.")
                         : session_.indexState() == model::IndexState::Building
                             ? tr("The index is being built; its levels will stand here.")
                             : tr("This volume has no index."));
}

void LevelsPanel::showMove() {
    const auto frame = session_.frame();
    walkHint_->setVisible(!frame);
    walkHint_->setText(tr("Move the isovalue to see what it costs."));
    std::vector<QStringList> rows;
    if (frame)
        for (const auto& step : frame->stats.walk)
            rows.push_back(
                {QString::number(step.level.number()), grouped(step.blocks), grouped(step.edges), bytes(step.bytes)});
    walk_->setRows(std::move(rows));
    moveFacts_->setFacts(frame ? factsOfMove(*frame, session_.isovalue()) : std::vector<Fact>{});
}

} // namespace isoslider::widgets
