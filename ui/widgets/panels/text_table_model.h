#pragma once

#include <vector>

#include <QAbstractTableModel>
#include <QStringList>

namespace isoslider::widgets {

/// Rows of ready-made texts under fixed headings. The first column is aligned left, numbers right.
/// New texts in the same number of rows change cells in place: selection and scrolling stay.
class TextTableModel : public QAbstractTableModel {
    Q_OBJECT
public:
    struct Column {
        QString title;
        QString tip;
    };

    explicit TextTableModel(std::vector<Column> columns, QObject* parent = nullptr);

    /// REQUIRES: every row has as many texts as there are columns.
    void setRows(std::vector<QStringList> rows);

    int rowCount(const QModelIndex& parent = {}) const override;
    int columnCount(const QModelIndex& parent = {}) const override;
    QVariant data(const QModelIndex& index, int role) const override;
    QVariant headerData(int section, Qt::Orientation orientation, int role) const override;

private:
    std::vector<Column> columns_;
    std::vector<QStringList> rows_;
};

} // namespace isoslider::widgets
