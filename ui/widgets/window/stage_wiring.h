#pragma once

#include <functional>
#include <vector>

#include <QObject>
#include <QPointer>

#include "ui/model/observers.h"
#include "ui/model/session/dataset.h"
#include "ui/model/surface/stage.h"

namespace isoslider::model {
class Session;
} // namespace isoslider::model

namespace isoslider::widgets {

class ActionRegistry;
class MessageBar;
class SettingsStore;
class StretchDialog;
class ViewportHost;

/// Connects what the surface stands in: background, light, stretched axes. All of its parts outlive it.
class StageWiring : public QObject {
    Q_OBJECT
public:
    struct Parts {
        ViewportHost& host;
        MessageBar& messageBar;
    };
    StageWiring(model::Session& session, SettingsStore& settings, const ActionRegistry& actions, const Parts& parts,
                QObject* parent);

private:
    void change(const std::function<void(model::Stage&)>& change);
    void connectActions();
    void showOptions();
    void followDataset();
    void suggest();
    QString textOf(const glm::dvec3& stretch) const;

    model::Session& session_;
    SettingsStore& settings_;
    const ActionRegistry& actions_;
    Parts parts_;
    model::DatasetGeneration dataset_{};
    bool isSuggestionDue_ = false;
    QPointer<StretchDialog> dialog_;
    std::vector<model::Subscription> subscriptions_;
};

} // namespace isoslider::widgets
