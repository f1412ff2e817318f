#pragma once

#include <optional>
#include <vector>

#include <QAbstractTableModel>
#include <QPixmap>
#include <QSortFilterProxyModel>

#include "ui/model/topology/topology_model.h"

namespace isoslider::widgets {

/// The shown events of a topology model as rows, in its order. Nothing is kept for a row but its place.
class TopologyTable : public QAbstractTableModel {
    Q_OBJECT
public:
    enum Column { Isovalue, What, Persistence, Pieces, Tunnels, Voids, Loops };
    static constexpr int kColumns = 7;

    TopologyTable(const model::TopologyModel& topology, QObject* parent);

    /// The shown events have changed: all rows are new.
    void reload();
    /// Place in the model's events().
    std::size_t eventOf(int row) const { return shown_[static_cast<std::size_t>(row)]; }
    std::optional<int> rowOf(std::size_t event) const;
    /// What rows are sorted by; of counts the one beyond the event.
    double sortKey(int row, int column) const;
    /// Symbols of what happens are drawn in the colours of this palette.
    void setPalette(const QPalette& palette, qreal devicePixelRatio);

    int rowCount(const QModelIndex& parent = {}) const override;
    int columnCount(const QModelIndex& parent = {}) const override;
    QVariant data(const QModelIndex& index, int role) const override;
    QVariant headerData(int section, Qt::Orientation orientation, int role) const override;

private:
    QString text(std::size_t place, int column) const;

    const model::TopologyModel& topology_;
    std::vector<std::size_t> shown_;
    std::vector<QPixmap> glyphs_; ///< by EventClass
};

/// Sorts by numbers, without a QVariant for each comparison. Equal ones stay in the order of isovalues.
class TopologySorting : public QSortFilterProxyModel {
    Q_OBJECT
public:
    TopologySorting(TopologyTable& table, QObject* parent);

protected:
    bool lessThan(const QModelIndex& left, const QModelIndex& right) const override;

private:
    TopologyTable& table_;
};

} // namespace isoslider::widgets
