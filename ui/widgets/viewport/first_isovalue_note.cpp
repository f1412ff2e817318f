#include "ui/widgets/viewport/first_isovalue_note.h"

#include "ui/model/session/session.h"
#include "ui/model/surface/view_state.h"

namespace isoslider::widgets {

FirstIsovalueNote::FirstIsovalueNote(model::Session& session, model::ViewState& options, QWidget& view)
    : ViewNote(view, Place::LowerEdge), session_(session), options_(options) {
    setObjectName(QStringLiteral("firstIsovalueNote"));
    subscriptions_.push_back(session_.firstIsovalue().changed().observe([this] { showReason(); }));
    subscriptions_.push_back(session_.isovalue().observe([this] { showReason(); }));
    subscriptions_.push_back(session_.frameChanged().observe([this] { showReason(); }));
    subscriptions_.push_back(session_.datasetChanged().observe([this] { showReason(); }));
    subscriptions_.push_back(options_.observe([this] { showReason(); }));
    showReason();
}

// Not before the surface that it speaks of is on screen.
void FirstIsovalueNote::showReason() {
    const auto& isovalue = session_.isovalue();
    const std::string reason = session_.firstIsovalue().reason();
    const auto frame = session_.frame();
    const bool isEmpty = frame && frame->stats.triangles == 0 && !frame->region;
    const bool isWanted = !reason.empty() && !isEmpty && isovalue.hasDisplayed() && !isovalue.isLagging() &&
                          options_.options().showsReadout;
    say(isWanted ? tr("Isovalue %1").arg(QString::fromStdString(model::suggestionText({isovalue.requested(), reason})))
                 : QString());
}

} // namespace isoslider::widgets
