#pragma once

#include <QWidget>

#include "ui/model/observers.h"

class QComboBox;
class QLabel;
class QSlider;

namespace isoslider::model {
class Session;
}

namespace isoslider::widgets {

/// How far the surface may differ for fewer triangles: a slider from none to 1 cell or 2 % of the value range.
class DetailControl : public QWidget {
    Q_OBJECT
public:
    explicit DetailControl(model::Session& session, QWidget* parent = nullptr);

    /// The choice of the measure: what may give way where there is little room.
    QWidget* measure();

private:
    void request();
    void showError();
    void showWhetherPossible();

    model::Session& session_;
    QSlider* slider_;
    QComboBox* measure_;
    QLabel* value_;
    model::Subscription errorSubscription_;
    model::Subscription datasetSubscription_;
    model::Subscription frameSubscription_;
};

} // namespace isoslider::widgets
