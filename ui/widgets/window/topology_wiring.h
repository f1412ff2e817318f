#pragma once

#include <vector>

#include <QObject>

#include "ui/model/observers.h"

class QMainWindow;

namespace isoslider::model {
class Session;
}

namespace isoslider::widgets {

class ActionRegistry;
class HistogramPlot;
class SettingsStore;

/// Connects the topology's events with the window: marks on the histogram, the actions that move from event to event,
/// and snapping to them. Everything it is given must outlive it.
class TopologyWiring : public QObject {
    Q_OBJECT
public:
    TopologyWiring(model::Session& session, SettingsStore& settings, const ActionRegistry& actions, HistogramPlot& plot,
                   QMainWindow& window);

    /// Chooses an event and moves the isovalue just past it.
    void moveTo(std::size_t event);

private:
    void connectActions(SettingsStore& settings);
    void moveToNext(bool isUpwards);
    void showEvents();
    void showChosen();

    model::Session& session_;
    const ActionRegistry& actions_;
    HistogramPlot& plot_;
    std::vector<model::Subscription> subscriptions_;
};

} // namespace isoslider::widgets
