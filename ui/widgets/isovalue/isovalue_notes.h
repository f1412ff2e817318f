#pragma once

#include <optional>
#include <vector>

#include <QObject>

#include "ui/model/observers.h"

namespace isoslider::model {
class Session;
}

namespace isoslider::widgets {

class HistogramPlot;

/// Keeps the line over the histogram that states what is not as asked: an isovalue that was clamped, a surface that is
/// empty, a logarithmic axis that cannot be one.
class IsovalueNotes : public QObject {
    Q_OBJECT
public:
    IsovalueNotes(model::Session& session, HistogramPlot& plot);

    /// What was typed, before it is requested. The note on it stays until another isovalue is requested.
    void noteTyped(double asked);

private:
    void show();

    model::Session& session_;
    HistogramPlot& plot_;
    std::optional<double> typed_;
    std::vector<model::Subscription> subscriptions_;
};

} // namespace isoslider::widgets
