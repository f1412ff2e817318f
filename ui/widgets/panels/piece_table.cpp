#include "ui/widgets/panels/piece_table.h"

#include <algorithm>
#include <cmath>

#include <QGuiApplication>
#include <QPalette>

#include "core/extract/surface_frame.h"
#include "ui/model/isovalue/number_text.h"
#include "ui/model/pieces/piece_tints.h"
#include "ui/widgets/common/texts.h"
#include "ui/widgets/panels/fact_texts.h"

namespace isoslider::widgets {
namespace {

// Tints are of linear light, what is on screen is not.
QColor colourOf(const model::PieceTint& tint) {
    const auto seen = [](std::uint8_t linear) {
        return static_cast<int>(std::lround(255.0 * std::pow(linear / 255.0, 1.0 / 2.2)));
    };
    return {seen(tint[0]), seen(tint[1]), seen(tint[2])};
}

} // namespace

void PieceTable::show(const extract::SurfaceFrame* frame, const model::PieceOptions& options, const std::string& unit) {
    std::vector<Row> rows;
    if (frame != nullptr && frame->pieces) {
        const model::PieceDisplay display(*frame->pieces, frame->geometry, options);
        const auto pieces = frame->pieces->pieces();
        for (std::size_t k = 0; k < std::min(pieces.size(), kMostRows); ++k)
            rows.push_back(
                {pieces[k].id, pieces[k].triangles,
                 inLengthUnit(QString::fromStdString(model::valueText(model::sizeOf(pieces[k], frame->geometry), 4)),
                              unit),
                 colourOf(display.colour(k)), !display.isShown(k)});
    }
    // Rows change in place while the isovalue slides: selection and scrolling stay.
    const auto before = static_cast<int>(rows_.size()), now = static_cast<int>(rows.size());
    if (now > before)
        beginInsertRows({}, before, now - 1);
    if (now < before)
        beginRemoveRows({}, now, before - 1);
    const bool isSame = rows == rows_;
    rows_ = std::move(rows);
    if (now > before)
        endInsertRows();
    if (now < before)
        endRemoveRows();
    if (!isSame && now > 0)
        Q_EMIT dataChanged(index(0, 0), index(now - 1, kColumns - 1));
}

int PieceTable::rowOf(std::optional<extract::PieceId> piece) const {
    const auto found =
        piece ? std::find_if(rows_.begin(), rows_.end(), [&](const Row& row) { return row.piece == *piece; })
              : rows_.end();
    return found != rows_.end() ? static_cast<int>(found - rows_.begin()) : -1;
}

int PieceTable::rowCount(const QModelIndex& parent) const {
    return parent.isValid() ? 0 : static_cast<int>(rows_.size());
}

int PieceTable::columnCount(const QModelIndex& parent) const { return parent.isValid() ? 0 : kColumns; }

QVariant PieceTable::data(const QModelIndex& index, int role) const {
    if (!index.isValid() || index.row() >= rowCount())
        return {};
    const Row& row = rows_[static_cast<std::size_t>(index.row())];
    switch (role) {
        case Qt::DisplayRole:
            switch (index.column()) {
                case Number: return row.piece.number() + 1;
                case Triangles: return grouped(row.triangles);
                case Size: return row.size;
                default: return {};
            }
        case Qt::TextAlignmentRole:
            return QVariant::fromValue((index.column() == Number ? Qt::AlignLeft : Qt::AlignRight) | Qt::AlignVCenter);
        case Qt::DecorationRole: return index.column() == Number ? QVariant(row.colour) : QVariant();
        case Qt::ForegroundRole:
            return row.isHidden ? QVariant(QGuiApplication::palette().color(QPalette::Disabled, QPalette::Text))
                                : QVariant();
        case Qt::ToolTipRole: return row.isHidden ? tr("Hidden") : QVariant();
        default: return {};
    }
}

QVariant PieceTable::headerData(int section, Qt::Orientation orientation, int role) const {
    if (orientation != Qt::Horizontal)
        return {};
    if (role == Qt::TextAlignmentRole)
        return QVariant::fromValue((section == Number ? Qt::AlignLeft : Qt::AlignRight) | Qt::AlignVCenter);
    if (role != Qt::DisplayRole)
        return {};
    switch (section) {
        case Number: return tr("Piece");
        case Triangles: return tr("Triangles");
        case Size: return tr("Size");
        default: return {};
    }
}

} // namespace isoslider::widgets
