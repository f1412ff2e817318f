#pragma once

#include <QVariantAnimation>

#include "ui/model/surface/camera.h"

namespace isoslider::widgets {

class ViewportWidget;

/// Moves the camera of a view to a place within 300 ms. Ends early when something else moves the camera.
class CameraFlight : public QObject {
    Q_OBJECT
public:
    explicit CameraFlight(ViewportWidget& viewport);

    /// To look at a place in centred world space, see model::Camera, from the present direction. Comes as near as
    /// `distance`, or stays nearer.
    void flyTo(const glm::dvec3& place, double distance);
    /// To see the same place from another direction.
    void turnTo(const glm::dquat& orientation);
    void flyTo(const model::CameraPose& pose);
    bool isFlying() const { return animation_.state() == QAbstractAnimation::Running; }

private:
    void follow(double part);

    ViewportWidget& viewport_;
    QVariantAnimation animation_;
    model::CameraPose from_;
    model::CameraPose to_;
    model::CameraPose last_; ///< that the flight has set
};

} // namespace isoslider::widgets
