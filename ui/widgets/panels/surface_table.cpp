#include "ui/widgets/panels/surface_table.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <QColor>
#include <QFont>
#include <QGuiApplication>
#include <QPalette>

#include "ui/model/isovalue/deviation_text.h"
#include "ui/model/isovalue/number_text.h"
#include "ui/widgets/common/texts.h"

namespace isoslider::widgets {
namespace {

int percentOf(double opacity) { return static_cast<int>(std::lround(100.0 * opacity)); }

} // namespace

SurfaceTable::SurfaceTable(model::SurfacesModel& surfaces, QString activeTip, SpreadSource spread, QObject* parent)
    : QAbstractTableModel(parent),
      surfaces_(surfaces),
      activeTip_(std::move(activeTip)),
      spread_(std::move(spread)),
      shown_(surfaces.list()) {
    subscription_ = surfaces_.observe([this] { follow(); });
}

// Rows change in place while a surface slides: the editor that is open stays.
void SurfaceTable::follow() {
    const auto& now = surfaces_.list();
    const auto idsOf = [](const model::SurfaceList& list) {
        std::vector<model::SurfaceId> ids;
        for (const auto& surface : list.surfaces)
            ids.push_back(surface.id);
        return ids;
    };
    if (idsOf(now) != idsOf(shown_)) {
        beginResetModel();
        shown_ = now;
        endResetModel();
        return;
    }
    const auto before = std::exchange(shown_, now);
    for (int row = 0; row < rowCount(); ++row) {
        const auto at = static_cast<std::size_t>(row);
        const bool changesActive =
            before.active != now.active && (now.surfaces[at].id == before.active || now.surfaces[at].id == now.active);
        if (changesActive || !(before.surfaces[at] == now.surfaces[at]))
            Q_EMIT dataChanged(index(row, 0), index(row, kColumns - 1));
    }
}

model::SurfaceId SurfaceTable::surfaceOf(int row) const { return shown_.surfaces[static_cast<std::size_t>(row)].id; }

int SurfaceTable::activeRow() const {
    const auto found = std::find_if(shown_.surfaces.begin(), shown_.surfaces.end(),
                                    [this](const auto& surface) { return surface.id == shown_.active; });
    return found != shown_.surfaces.end() ? static_cast<int>(found - shown_.surfaces.begin()) : -1;
}

int SurfaceTable::rowCount(const QModelIndex& parent) const {
    return parent.isValid() ? 0 : static_cast<int>(shown_.surfaces.size());
}

int SurfaceTable::columnCount(const QModelIndex& parent) const { return parent.isValid() ? 0 : kColumns; }

QVariant SurfaceTable::data(const QModelIndex& index, int role) const {
    if (!index.isValid() || !checkIndex(index))
        return {};
    const model::ListedSurface& surface = shown_.surfaces[static_cast<std::size_t>(index.row())];
    const int column = index.column();
    const bool isActive = surface.id == shown_.active;
    switch (role) {
        case Qt::DisplayRole:
        case Qt::EditRole:
            switch (column) {
                case Name: return fromStd(surface.name);
                case Isovalue:
                    return fromStd(role == Qt::EditRole ? model::exactText(surface.isovalue)
                                                        : model::valueText(surface.isovalue, 7));
                case Opacity:
                    return role == Qt::EditRole ? QVariant(percentOf(surface.opacity))
                                                : QVariant(tr("%1 %").arg(percentOf(surface.opacity)));
                default: return {};
            }
        case Qt::CheckStateRole:
            return column == Shown ? QVariant(surface.isVisible ? Qt::Checked : Qt::Unchecked) : QVariant();
        case Qt::DecorationRole:
            return column == Name ? QVariant(QColor(surface.colour[0], surface.colour[1], surface.colour[2]))
                                  : QVariant();
        case Qt::FontRole: {
            QFont font = QGuiApplication::font();
            font.setBold(isActive);
            return font;
        }
        case Qt::ForegroundRole:
            return surface.isVisible ? QVariant()
                                     : QVariant(QGuiApplication::palette().color(QPalette::Disabled, QPalette::Text));
        case Qt::TextAlignmentRole:
            return QVariant::fromValue((column <= Name ? Qt::AlignLeft : Qt::AlignRight) | Qt::AlignVCenter);
        case Qt::AccessibleTextRole:
            return column == Shown ? QVariant(tr("Show %1").arg(fromStd(surface.name))) : data(index, Qt::DisplayRole);
        case Qt::ToolTipRole: return isActive ? activeTip_ : QString();
        default: return {};
    }
}

bool SurfaceTable::setData(const QModelIndex& index, const QVariant& value, int role) {
    if (!index.isValid() || !checkIndex(index))
        return false;
    const auto id = surfaceOf(index.row());
    const auto change = [&](auto&& set) {
        surfaces_.change(id, set);
        return true;
    };
    if (role == Qt::CheckStateRole && index.column() == Shown)
        return change([&](model::ListedSurface& surface) { surface.isVisible = value.toInt() == Qt::Checked; });
    if (role != Qt::EditRole)
        return false;
    const QString text = value.toString().trimmed();
    switch (index.column()) {
        case Name:
            if (text.isEmpty() || text.toUtf8().size() > static_cast<qsizetype>(model::kMostSurfaceNameBytes))
                return false;
            return change([&](model::ListedSurface& surface) { surface.name = text.toStdString(); });
        case Isovalue:
            if (const auto asked = model::isovalueFrom(text.toStdString()))
                if (const auto isovalue = asked->in(spread_()); isovalue.isOk() && std::isfinite(isovalue.value()))
                    return change([&](model::ListedSurface& surface) { surface.isovalue = isovalue.value(); });
            return false;
        case Opacity: return change([&](model::ListedSurface& surface) { surface.opacity = value.toInt() / 100.0; });
        default: return false;
    }
}

Qt::ItemFlags SurfaceTable::flags(const QModelIndex& index) const {
    const auto usual = QAbstractTableModel::flags(index);
    if (!index.isValid())
        return usual;
    return index.column() == Shown ? usual | Qt::ItemIsUserCheckable : usual | Qt::ItemIsEditable;
}

QVariant SurfaceTable::headerData(int section, Qt::Orientation orientation, int role) const {
    if (orientation != Qt::Horizontal)
        return {};
    if (role == Qt::TextAlignmentRole)
        return QVariant::fromValue((section <= Name ? Qt::AlignLeft : Qt::AlignRight) | Qt::AlignVCenter);
    if (role != Qt::DisplayRole)
        return {};
    switch (section) {
        case Name: return tr("Surface");
        case Isovalue: return tr("Isovalue");
        case Opacity: return tr("Opacity");
        default: return {};
    }
}

} // namespace isoslider::widgets
