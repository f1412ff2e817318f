#pragma once

#include <functional>

#include <QAbstractTableModel>

#include "core/grid/value_spread.h"
#include "ui/model/surface/surface_list.h"

namespace isoslider::widgets {

/// The surfaces of a volume, a row for each in the order of the list. Shown and hidden by the box of the first column,
/// which has the colour as well; name, isovalue and opacity are edited in place.
class SurfaceTable : public QAbstractTableModel {
    Q_OBJECT
public:
    enum Column { Shown, Name, Isovalue, Opacity, kColumns };

    /// Of the volume's samples, for isovalues that are typed in standard deviations.
    using SpreadSource = std::function<ValueSpread()>;

    /// The model must outlive it. `activeTip`: of the active surface's row.
    SurfaceTable(model::SurfacesModel& surfaces, QString activeTip, SpreadSource spread, QObject* parent = nullptr);

    /// REQUIRES: there is such a row.
    model::SurfaceId surfaceOf(int row) const;
    /// -1 without surfaces.
    int activeRow() const;

    int rowCount(const QModelIndex& parent = {}) const override;
    int columnCount(const QModelIndex& parent = {}) const override;
    QVariant data(const QModelIndex& index, int role) const override;
    bool setData(const QModelIndex& index, const QVariant& value, int role) override;
    Qt::ItemFlags flags(const QModelIndex& index) const override;
    QVariant headerData(int section, Qt::Orientation orientation, int role) const override;

private:
    void follow();

    model::SurfacesModel& surfaces_;
    QString activeTip_;
    SpreadSource spread_;
    model::SurfaceList shown_; ///< what views have been told of
    model::Subscription subscription_;
};

} // namespace isoslider::widgets
