#include "ui/widgets/viewport/camera_flight.h"

#include <algorithm>

#include "ui/widgets/viewport/viewport_widget.h"

namespace isoslider::widgets {
namespace {

constexpr int kFlightMs = 300;

bool isSamePlace(const model::CameraPose& a, const model::CameraPose& b) {
    return a.target == b.target && a.distance == b.distance && a.orientation == b.orientation;
}

} // namespace

CameraFlight::CameraFlight(ViewportWidget& viewport) : QObject(&viewport), viewport_(viewport) {
    animation_.setDuration(kFlightMs);
    animation_.setEasingCurve(QEasingCurve::InOutCubic);
    animation_.setStartValue(0.0);
    animation_.setEndValue(1.0);
    connect(&animation_, &QVariantAnimation::valueChanged, this,
            [this](const QVariant& part) { follow(part.toDouble()); });
}

void CameraFlight::flyTo(const glm::dvec3& place, double distance) {
    model::CameraPose pose = viewport_.camera().pose();
    pose.target = pose.pivot = place;
    pose.distance = std::min(pose.distance, distance);
    flyTo(pose);
}

void CameraFlight::turnTo(const glm::dquat& orientation) {
    model::CameraPose pose = viewport_.camera().pose();
    pose.orientation = orientation;
    flyTo(pose);
}

void CameraFlight::flyTo(const model::CameraPose& pose) {
    animation_.stop();
    from_ = last_ = viewport_.camera().pose();
    to_ = pose;
    animation_.start();
}

void CameraFlight::follow(double part) {
    if (!isFlying())
        return;
    if (!isSamePlace(viewport_.camera().pose(), last_))
        return animation_.stop();
    viewport_.changeCamera([&](model::Camera& camera) {
        model::CameraPose pose = poseBetween(from_, to_, part);
        pose.isPerspective = camera.isPerspective();
        camera.setPose(pose);
        last_ = camera.pose();
    });
}

} // namespace isoslider::widgets
