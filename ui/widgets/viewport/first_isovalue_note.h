#pragma once

#include <vector>

#include "ui/model/observers.h"
#include "ui/widgets/viewport/view_note.h"

namespace isoslider::model {
class Session;
class ViewState;
} // namespace isoslider::model

namespace isoslider::widgets {

/// Why the volume opened with the isovalue it shows: a line at the lower edge of the view, until the handle moves.
/// Shown with the readout.
class FirstIsovalueNote : public ViewNote {
    Q_OBJECT
public:
    /// Lies on `view`.
    FirstIsovalueNote(model::Session& session, model::ViewState& options, QWidget& view);

private:
    void showReason();

    model::Session& session_;
    model::ViewState& options_;
    std::vector<model::Subscription> subscriptions_;
};

} // namespace isoslider::widgets
