#pragma once

#include <QAbstractItemModel>

#include "ui/model/opening/field_tree.h"

namespace isoslider::widgets {

/// What people call a field: its title, or its name.
QString titleOf(const io::VolumeField& field);

/// Fields of a file, in their groups where the format has some. Fields that cannot be opened are grey, and state why
/// behind their names. Only fields can be selected.
class FieldTreeModel : public QAbstractItemModel {
    Q_OBJECT
public:
    enum Column { Name, GridPoints, Type, Parts };

    explicit FieldTreeModel(QString nameHeading, QObject* parent = nullptr);

    void setContents(io::VolumeContents contents);
    const model::FieldTree& tree() const { return tree_; }
    /// True if any field has components or frames: the last column states something.
    bool hasParts() const;
    /// The row has one text, in the first column: a group, or a field that cannot be opened.
    bool isOneText(const QModelIndex& index) const;
    /// The field of a row; none of a group.
    std::optional<std::size_t> fieldAt(const QModelIndex& index) const;
    QModelIndex indexOf(std::size_t field) const;

    QModelIndex index(int row, int column, const QModelIndex& parent = {}) const override;
    QModelIndex parent(const QModelIndex& child) const override;
    int rowCount(const QModelIndex& parent = {}) const override;
    int columnCount(const QModelIndex& parent = {}) const override;
    QVariant data(const QModelIndex& index, int role) const override;
    QVariant headerData(int section, Qt::Orientation orientation, int role) const override;
    Qt::ItemFlags flags(const QModelIndex& index) const override;

private:
    QString textOf(const io::VolumeField& field, std::size_t node, int column) const;
    QString tipOf(const io::VolumeField& field) const;

    QString nameHeading_;
    io::VolumeContents contents_;
    model::FieldTree tree_;
};

} // namespace isoslider::widgets
