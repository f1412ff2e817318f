#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <QAbstractTableModel>
#include <QColor>
#include <QString>

#include "core/extract/pieces/surface_pieces.h"

namespace isoslider::model {
struct PieceOptions;
}
namespace isoslider::extract {
struct SurfaceFrame;
}

namespace isoslider::widgets {

/// The largest pieces of a surface, those of most triangles first.
class PieceTable : public QAbstractTableModel {
    Q_OBJECT
public:
    enum Column { Number, Triangles, Size, kColumns };
    /// More are counted, not listed.
    static constexpr std::size_t kMostRows = 500;

    using QAbstractTableModel::QAbstractTableModel;

    /// `frame` may be null or without pieces. `unit`: of length; empty where it is not known.
    void show(const extract::SurfaceFrame* frame, const model::PieceOptions& options, const std::string& unit);

    /// REQUIRES: there is such a row.
    extract::PieceId pieceOf(int row) const { return rows_[static_cast<std::size_t>(row)].piece; }
    /// -1 for a piece that is not listed.
    int rowOf(std::optional<extract::PieceId> piece) const;

    int rowCount(const QModelIndex& parent = {}) const override;
    int columnCount(const QModelIndex& parent = {}) const override;
    QVariant data(const QModelIndex& index, int role) const override;
    QVariant headerData(int section, Qt::Orientation orientation, int role) const override;

private:
    struct Row {
        extract::PieceId piece;
        std::uint64_t triangles = 0;
        QString size;
        QColor colour;
        bool isHidden = false;
        bool operator==(const Row&) const = default;
    };
    std::vector<Row> rows_;
};

} // namespace isoslider::widgets
