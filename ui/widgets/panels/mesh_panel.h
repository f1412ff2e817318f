#pragma once

#include <QWidget>

#include "ui/model/observers.h"
#include "ui/widgets/common/throttle.h"

class QLabel;
class QPushButton;

namespace isoslider::model {
class Session;
class ViewState;
} // namespace isoslider::model

namespace isoslider::widgets {

class ActionRegistry;
class FactForm;

/// The surface as a mesh: live counts, its certificate, export.
class MeshPanel : public QWidget {
    Q_OBJECT
public:
    MeshPanel(model::Session& session, model::ViewState& view, const ActionRegistry& actions,
              QWidget* parent = nullptr);

private:
    void showCounts();
    void showReport();

    model::Session& session_;
    model::ViewState& view_;
    FactForm* counts_;
    QLabel* shown_;
    QLabel* state_;
    FactForm* report_;
    QPushButton* check_;
    QPushButton* export_;
    Throttle countsThrottle_;
    model::Subscription frameSubscription_;
    model::Subscription surfacesSubscription_;
    model::Subscription viewSubscription_;
    model::Subscription reportSubscription_;
};

} // namespace isoslider::widgets
