#pragma once

#include <vector>

#include <QWidget>

#include "ui/model/observers.h"
#include "ui/widgets/common/throttle.h"

class QLabel;

namespace isoslider::model {
class Session;
}

namespace isoslider::widgets {

class FactForm;

/// What is known of the surface that is shown, while it slides: its size, pieces, tunnels, area and volume. Counts and
/// measures come from the topology of the volume, without looking at the mesh.
class CountsPanel : public QWidget {
    Q_OBJECT
public:
    explicit CountsPanel(model::Session& session, QWidget* parent = nullptr);

private:
    void show();

    model::Session& session_;
    FactForm* surface_;
    FactForm* counts_;
    FactForm* measures_;
    QLabel* hint_;
    QWidget* measuresHeading_;
    Throttle throttle_;
    std::vector<model::Subscription> subscriptions_;
};

} // namespace isoslider::widgets
