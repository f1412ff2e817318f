#pragma once

#include <array>

#include <QObject>

#include "ui/model/observers.h"

class QDockWidget;

namespace isoslider::model {
class Session;
}

namespace isoslider::widgets {

class ActionRegistry;
class HistogramPlot;
class SurfaceBars;
class SurfacesPanel;

/// Several surfaces of one volume, and those of a second one: the actions, and the bars on the histogram. Everything it
/// is given must outlive it.
class SurfaceWiring : public QObject {
    Q_OBJECT
public:
    struct Parts {
        HistogramPlot& plot;
        QDockWidget& dock;
        SurfacesPanel& panel;
    };
    SurfaceWiring(model::Session& session, const ActionRegistry& actions, const Parts& parts, QObject* parent);

private:
    void connectActions();
    void showSurfaces();
    void showSecond();

    model::Session& session_;
    const ActionRegistry& actions_;
    Parts parts_;
    SurfaceBars* bars_; ///< the plot's
    model::Subscription subscription_;
    std::array<model::Subscription, 2> secondSubscriptions_;
};

} // namespace isoslider::widgets
