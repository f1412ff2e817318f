#pragma once

#include <QTreeView>

#include "core/volume_io/volume_contents.h"

namespace isoslider::widgets {

class FieldTreeModel;

/// Shows the fields of a file and has one of them chosen. Where they are in groups, these can be folded, also with the
/// keys; what is highlighted stays the chosen field while the keys go past groups.
class FieldTreeView : public QTreeView {
    Q_OBJECT
public:
    explicit FieldTreeView(const QString& nameHeading, QWidget* parent = nullptr);

    bool hasContents() const;
    void setContents(io::VolumeContents contents);
    /// Highlights a field, unfolding its groups, without a signal.
    void setField(std::size_t field);

Q_SIGNALS:
    void fieldChosen(int field);
    /// A double click.
    void fieldOpened();

protected:
    void selectionChanged(const QItemSelection& selected, const QItemSelection& deselected) override;

private:
    void spanTexts(const QModelIndex& parent);

    FieldTreeModel* model_;
    std::size_t field_ = 0;
    bool isShowing_ = false; ///< a field is being shown, not chosen
};

} // namespace isoslider::widgets
