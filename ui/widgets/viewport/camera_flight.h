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

    /// A place in centred world space, see model::Camera. Looks from the present direction, from as near as shows the
    /// place with what surrounds it; comes no farther away.
    void flyTo(const glm::dvec3& place);
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
