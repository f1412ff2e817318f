#include "ui/widgets/panels/topology_table.h"

#include <algorithm>
#include <array>

#include "ui/model/isovalue/number_text.h"
#include "ui/widgets/common/texts.h"
#include "ui/widgets/isovalue/event_marks.h"

namespace isoslider::widgets {
namespace {

constexpr int kGlyphSize = 14;

} // namespace

TopologyTable::TopologyTable(const model::TopologyModel& topology, QObject* parent)
    : QAbstractTableModel(parent), topology_(topology), shown_(topology.shown()) {}

void TopologyTable::reload() {
    beginResetModel();
    shown_ = topology_.shown();
    endResetModel();
}

// Both ascend.
std::optional<int> TopologyTable::rowOf(std::size_t event) const {
    const auto at = std::lower_bound(shown_.begin(), shown_.end(), event);
    if (at == shown_.end() || *at != event)
        return std::nullopt;
    return static_cast<int>(at - shown_.begin());
}

double TopologyTable::sortKey(int row, int column) const {
    if (eventOf(row) >= topology_.events().size())
        return 0.0;
    const auto& event = topology_.events()[eventOf(row)];
    switch (column) {
        case Isovalue: return event.isovalue;
        case What: return static_cast<double>(model::classOf(event));
        case Persistence: return topology_.persistenceOf(eventOf(row));
        case Pieces: return static_cast<double>(event.above.components);
        case Tunnels: return static_cast<double>(event.above.handles());
        case Voids: return static_cast<double>(event.above.voids);
        default: return static_cast<double>(event.above.loops);
    }
}

void TopologyTable::setPalette(const QPalette& palette, qreal devicePixelRatio) {
    glyphs_.clear();
    for (int kind = 0; kind < model::kEventClasses; ++kind)
        glyphs_.push_back(eventGlyph(static_cast<model::EventClass>(kind), kGlyphSize, devicePixelRatio, palette));
    if (rowCount() > 0)
        Q_EMIT dataChanged(index(0, What), index(rowCount() - 1, What), {Qt::DecorationRole});
}

int TopologyTable::rowCount(const QModelIndex& parent) const {
    return parent.isValid() ? 0 : static_cast<int>(shown_.size());
}

int TopologyTable::columnCount(const QModelIndex& parent) const { return parent.isValid() ? 0 : kColumns; }

QString TopologyTable::text(std::size_t place, int column) const {
    const topology::TopologyEvent& event = topology_.events()[place];
    switch (column) {
        case Isovalue: return fromStd(model::valueText(event.isovalue, 7));
        case What: return fromStd(model::wordsOf(event));
        case Persistence: return fromStd(model::valueText(topology_.persistenceOf(place), 4));
        case Pieces: return fromStd(model::changeText(event.below.components, event.above.components));
        case Tunnels: return fromStd(model::changeText(event.below.handles(), event.above.handles()));
        case Voids: return fromStd(model::changeText(event.below.voids, event.above.voids));
        default: return fromStd(model::changeText(event.below.loops, event.above.loops));
    }
}

QVariant TopologyTable::data(const QModelIndex& index, int role) const {
    // The model may have other events by now, and reload() still to come.
    if (!index.isValid() || !checkIndex(index) || eventOf(index.row()) >= topology_.events().size())
        return {};
    const auto& event = topology_.events()[eventOf(index.row())];
    switch (role) {
        case Qt::DisplayRole: return text(eventOf(index.row()), index.column());
        case Qt::ToolTipRole: return fromStd(model::describe(event));
        case Qt::TextAlignmentRole:
            return static_cast<int>((index.column() == What ? Qt::AlignLeft : Qt::AlignRight) | Qt::AlignVCenter);
        case Qt::DecorationRole:
            if (const auto kind = static_cast<std::size_t>(model::classOf(event));
                index.column() == What && kind < glyphs_.size())
                return glyphs_[kind];
            return {};
        default: return {};
    }
}

QVariant TopologyTable::headerData(int section, Qt::Orientation orientation, int role) const {
    if (orientation != Qt::Horizontal || section < 0 || section >= kColumns)
        return {};
    const std::array<std::pair<QString, QString>, kColumns> headings{
        {{tr("Isovalue"), tr("The event happens just past it")},
         {tr("What happens"), tr("As the isovalue rises")},
         {tr("Persistence"),
          tr("Through how many values a piece lasts that appears, disappears or joins here; of tunnels, voids and loops: "
             "how far away their next change is")},
         {tr("Pieces"), tr("Before → after")},
         {tr("Tunnels"), tr("Before → after")},
         {tr("Voids"), tr("Before → after")},
         {tr("Loops"), tr("Boundary loops, before → after")}}};
    const auto& [title, tip] = headings[static_cast<std::size_t>(section)];
    switch (role) {
        case Qt::DisplayRole: return title;
        case Qt::ToolTipRole: return tip;
        case Qt::TextAlignmentRole:
            return static_cast<int>((section == What ? Qt::AlignLeft : Qt::AlignRight) | Qt::AlignVCenter);
        default: return {};
    }
}

TopologySorting::TopologySorting(TopologyTable& table, QObject* parent) : QSortFilterProxyModel(parent), table_(table) {
    setSourceModel(&table);
}

bool TopologySorting::lessThan(const QModelIndex& left, const QModelIndex& right) const {
    return table_.sortKey(left.row(), left.column()) < table_.sortKey(right.row(), right.column());
}

} // namespace isoslider::widgets
