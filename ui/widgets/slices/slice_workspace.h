#pragma once

#include <array>

#include <QWidget>

#include "ui/model/observers.h"
#include "ui/model/slices/slice_model.h"

class QSplitter;

namespace isoslider::widgets {

class SlicePane;

/// The middle of the window: the 3-D view, and beside it the panes that the layout has, while there is a volume to show
/// in them. `model` must outlive it.
class SliceWorkspace : public QWidget {
    Q_OBJECT
public:
    /// Takes `view` in.
    SliceWorkspace(model::SliceModel& model, QWidget* view, QWidget* parent);

    SlicePane& pane(model::SliceKind kind) { return *panes_[placeOf(kind)]; }
    QSize sizeHint() const override { return {1100, 640}; }

private:
    void showLayout();
    void place(SlicePane* pane, QSplitter* column, int row);

    model::SliceModel& model_;
    QWidget* view_;
    QSplitter* columns_;
    QSplitter* left_;
    QSplitter* right_;
    std::array<SlicePane*, 4> panes_{};
    model::SliceLayout shown_ = model::SliceLayout::None;
    bool isDivided_ = false; ///< as that layout wants it: hidden columns have no widths
    model::Subscription subscription_;
};

} // namespace isoslider::widgets
