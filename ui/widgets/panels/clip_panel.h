#pragma once

#include <array>
#include <functional>
#include <vector>

#include <QWidget>

#include "ui/model/observers.h"
#include "ui/model/surface/clipping.h"

class QComboBox;
class QDoubleSpinBox;
class QLabel;
class QSpinBox;
class QToolButton;
class QVBoxLayout;

namespace isoslider::model {
class Session;
}

namespace isoslider::widgets {

class ActionRegistry;
class ViewportHost;

/// Crop box and clip plane in numbers. Everything it is given must outlive it.
class ClipPanel : public QWidget {
    Q_OBJECT
public:
    ClipPanel(model::Session& session, ViewportHost& host, const ActionRegistry& actions, QWidget* parent = nullptr);

private:
    void addCrop(QVBoxLayout* rows, const ActionRegistry& actions);
    void addPlane(QVBoxLayout* rows, const ActionRegistry& actions);
    void change(const std::function<void(model::Clipping&)>& change);
    void showClipping();
    void nameAxes();

    model::Session& session_;
    ViewportHost& host_;
    // One for each row, in the order of model::AxisNames.
    std::array<QSpinBox*, 3> low_{}, high_{};
    std::array<QLabel*, 3> axisLabels_{};
    std::array<QToolButton*, 3> across_{};
    QDoubleSpinBox* offset_ = nullptr;
    QComboBox* cap_ = nullptr;
    QLabel* planeHeading_ = nullptr;
    QLabel* problem_ = nullptr;
    std::vector<model::Subscription> subscriptions_;
};

} // namespace isoslider::widgets
