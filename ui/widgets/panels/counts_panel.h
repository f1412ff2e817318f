#pragma once

#include <vector>

#include <QWidget>

#include "ui/model/observers.h"
#include "ui/widgets/common/throttle.h"

class QLabel;

namespace isoslider::model {
class Session;
class ViewState;
} // namespace isoslider::model

namespace isoslider::widgets {

class FactForm;

/// What is known of the whole active surface, also where some of it is hidden, while it slides: its size, pieces,
/// tunnels, area and volume. Counts and measures come from the topology of the volume, without looking at the mesh.
class CountsPanel : public QWidget {
    Q_OBJECT
public:
    CountsPanel(model::Session& session, model::ViewState& view, QWidget* parent = nullptr);

private:
    void show();

    model::Session& session_;
    model::ViewState& view_;
    FactForm* surface_;
    QLabel* shown_;
    FactForm* counts_;
    FactForm* measures_;
    QLabel* hint_;
    QWidget* measuresHeading_;
    Throttle throttle_;
    std::vector<model::Subscription> subscriptions_;
};

} // namespace isoslider::widgets
