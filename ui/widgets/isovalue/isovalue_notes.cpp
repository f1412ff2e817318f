#include "ui/widgets/isovalue/isovalue_notes.h"

#include <algorithm>
#include <string>

#include "ui/model/isovalue/isovalue_words.h"
#include "ui/model/session/session.h"
#include "ui/widgets/isovalue/histogram_hints.h"
#include "ui/widgets/isovalue/histogram_plot.h"

namespace isoslider::widgets {

IsovalueNotes::IsovalueNotes(model::Session& session, HistogramPlot& plot)
    : QObject(&plot), session_(session), plot_(plot) {
    subscriptions_.push_back(session_.isovalue().observe([this] { show(); }));
    subscriptions_.push_back(session_.frameChanged().observe([this] { show(); }));
    subscriptions_.push_back(session_.histogramOptions().observe([this] { show(); }));
    subscriptions_.push_back(session_.datasetChanged().observe([this] { show(); }));
    connect(&plot_, &HistogramPlot::scaleChanged, this, &IsovalueNotes::show);
}

void IsovalueNotes::noteTyped(double asked) {
    typed_ = asked;
    show();
}

void IsovalueNotes::show() {
    const auto& isovalue = session_.isovalue();
    std::string note;
    if (isovalue.hasDomain()) {
        const double min = isovalue.min(), max = isovalue.max();
        if (typed_ && std::clamp(*typed_, min, max) != isovalue.requested())
            typed_.reset();
        note = typed_ ? model::clampedText(*typed_, min, max) : session_.noteOnFirstIsovalue();
        const auto frame = session_.frame();
        const bool isEmpty = frame && frame->stats.triangles == 0 && !isovalue.isLagging() && !session_.isMoving();
        if (isEmpty) {
            const GridDims& dims = frame->geometry.dims;
            note += (note.empty() ? "" : ". ") +
                    (frame->region ? tr("No surface about the crop box").toStdString()
                                   : model::emptySurfaceText(isovalue.requested(), min, max,
                                                             std::min({dims[0], dims[1], dims[2]}) > 1));
        }
        const auto wanted = session_.histogramOptions().options().valueScale;
        if (note.empty() && wanted == model::ScaleKind::Log && plot_.scale().kind() == model::ScaleKind::Symlog)
            note = tr("There are values at or below 0: the axis is logarithmic on both sides of 0").toStdString();
    } else {
        typed_.reset();
    }
    plot_.hints().setNote(QString::fromStdString(note));
}

} // namespace isoslider::widgets
