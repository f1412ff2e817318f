#pragma once

#include <optional>
#include <vector>

#include <QObject>

#include "ui/model/observers.h"
#include "ui/model/session/dataset.h"
#include "ui/model/surface/surface_list.h"

namespace isoslider::model {
class Session;
}

namespace isoslider::widgets {

class ActionRegistry;
class CameraFlight;
class EventMarker;
class HistogramPlot;
class SettingsStore;
class TopologyPanel;
class ViewportHost;

/// Connects the topology's events with the window: marks on the histogram, the actions that move from event to event,
/// snapping to them, the panel that lists them, and what points them out in the view. Everything it is given must
/// outlive it.
class TopologyWiring : public QObject {
    Q_OBJECT
public:
    /// What is connected.
    struct Parts {
        HistogramPlot& plot;
        TopologyPanel& panel;
        ViewportHost& host;
    };
    TopologyWiring(model::Session& session, SettingsStore& settings, const ActionRegistry& actions, const Parts& parts,
                   QObject* parent);

    /// Chooses an event and moves the isovalue just past it.
    void moveTo(std::size_t event);

private:
    void connectActions(SettingsStore& settings);
    void flyTo(std::size_t event);
    void moveToNext(bool isUpwards);
    void showEvents();
    void showChosen();
    void showPassed();

    model::Session& session_;
    const ActionRegistry& actions_;
    HistogramPlot& plot_;
    ViewportHost& host_;
    CameraFlight* flight_ = nullptr; ///< null without a view, and so is the marker
    EventMarker* marker_ = nullptr;
    /// What the last picture was of.
    struct Shown {
        model::DatasetGeneration dataset{};
        model::SurfaceId surface{};
        double isovalue = 0.0;
    };
    std::optional<Shown> shown_;
    std::vector<model::Subscription> subscriptions_;
};

} // namespace isoslider::widgets
