#pragma once

#include <vector>

#include <QObject>
#include <QTimer>

#include "ui/model/observers.h"
#include "ui/model/topology/suggested_isovalue.h"

class QMenu;

namespace isoslider::model {
class Session;
}

namespace isoslider::widgets {

class ActionRegistry;
class AxisHighlights;
class HistogramPlot;
class TopologyPanel;
class ViewportHost;

/// Connects what can be asked of the topology with the window: suggested isovalues in a menu and on the axis, the first
/// isovalue of a volume, isovalues that were found, and the one that others are compared with. Everything it is given
/// must outlive it.
class TopologyQuestions : public QObject {
    Q_OBJECT
public:
    /// What is connected.
    struct Parts {
        HistogramPlot& plot;
        TopologyPanel& panel;
        ViewportHost& host;
        QMenu& suggestions; ///< is filled
    };
    TopologyQuestions(model::Session& session, const ActionRegistry& actions, const Parts& parts, QObject* parent);

private:
    void connectActions();
    void connectParts();
    void slideTo(double isovalue);
    void showDataset();
    void showSuggestions();
    void fillMenu();
    void showReference();
    void improveFirst();
    static bool areHandsOn();

    model::Session& session_;
    const ActionRegistry& actions_;
    TopologyPanel& panel_;
    QMenu& menu_;
    AxisHighlights* highlights_;
    std::vector<model::SuggestedIsovalue> suggestions_;
    bool isMoreToCome_ = false;
    QTimer handsOff_; ///< asks again whether the mouse and the keyboard are free
    std::vector<model::Subscription> subscriptions_;
};

} // namespace isoslider::widgets
