#include "ui/model/surface/camera.h"

#include <algorithm>
#include <cmath>

#include <glm/gtc/matrix_inverse.hpp>
#include <glm/gtc/matrix_transform.hpp>

namespace isoslider::model {
namespace {

constexpr double kHalfFieldOfView = 0.5 * 0.6108652381980153; // 35 degrees
constexpr double kNearestDistance = 1e-4; // of the scene radius
constexpr double kFarthestDistance = 1e3;
constexpr double kLargestAspect = 1e6; // of views of one row of pixels
constexpr double kSmallestBall = 1e-3; // of the scene radius: of less there is nothing to see
constexpr double kRoomAround = 1.04;

double usableAspect(double aspect) {
    return std::isfinite(aspect) && aspect > 0.0 ? std::clamp(aspect, 1.0 / kLargestAspect, kLargestAspect) : 1.0;
}

/// The orientation of a viewer who stands at `direction` from the target with `up` upwards.
glm::dquat lookFrom(glm::dvec3 direction, glm::dvec3 up) {
    const glm::dvec3 backward = glm::normalize(direction);
    const glm::dvec3 right = glm::normalize(glm::cross(up, backward));
    return glm::normalize(glm::quat_cast(glm::dmat3(right, glm::cross(backward, right), backward)));
}

} // namespace

glm::dquat standardOrientation(StandardView view) {
    const glm::dvec3 z{0.0, 0.0, 1.0}, y{0.0, 1.0, 0.0};
    switch (view) {
        case StandardView::Front: return lookFrom(-y, z);
        case StandardView::Back: return lookFrom(y, z);
        case StandardView::Right: return lookFrom({1.0, 0.0, 0.0}, z);
        case StandardView::Left: return lookFrom({-1.0, 0.0, 0.0}, z);
        case StandardView::Top: return lookFrom(z, y);
        case StandardView::Bottom: break;
    }
    return lookFrom(-z, -y);
}

double reachOf(const GridDims& dims, const glm::dmat4& fromIndex) {
    double reach = 0.0;
    for (int corner = 0; corner < 8; ++corner) {
        glm::dvec4 place(0.0, 0.0, 0.0, 1.0);
        for (int axis = 0; axis < 3; ++axis)
            place[axis] =
                (corner >> axis & 1) != 0 ? static_cast<double>(dims[static_cast<std::size_t>(axis)] - 1) : 0.0;
        reach = std::max(reach, glm::length(glm::dvec3(fromIndex * place)));
    }
    return reach;
}

CameraPose poseBetween(const CameraPose& from, const CameraPose& to, double part) {
    part = std::clamp(part, 0.0, 1.0);
    CameraPose pose = to;
    pose.orientation = glm::slerp(from.orientation, to.orientation, part);
    pose.pivot = to.pivot;
    pose.target = from.target * (1.0 - part) + to.target * part;
    pose.distance = std::exp(std::lerp(std::log(from.distance), std::log(to.distance), part));
    return pose;
}

void Camera::reset(double sceneRadius, bool isPatient) {
    sceneRadius_ = std::isfinite(sceneRadius) && sceneRadius > 0.0 ? sceneRadius : 1.0;
    orientation_ =
        isPatient ? standardOrientation(StandardView::Front) : lookFrom({-0.55, -1.0, 0.45}, {0.0, 0.0, 1.0});
    fit();
}

void Camera::fit() {
    target_ = pivot_ = glm::dvec3(0.0);
    distance_ = sceneRadius_ / std::sin(kHalfFieldOfView);
}

void Camera::setStretch(const glm::dmat3& toShown, double sceneRadius) {
    const double radius = std::isfinite(sceneRadius) && sceneRadius > 0.0 ? sceneRadius : 1.0;
    const glm::dmat3 change = toShown * glm::inverse(stretch_);
    target_ = change * target_;
    pivot_ = change * pivot_;
    stretch_ = toShown;
    distance_ *= radius / sceneRadius_;
    sceneRadius_ = radius;
}

void Camera::setStandardView(StandardView view) {
    orientation_ = standardOrientation(view);
    fit();
}

void Camera::orbit(double rightRadians, double upRadians) {
    // The scene follows the pointer, so the viewer goes the other way, about the camera's own axes.
    const glm::dquat turn = glm::angleAxis(-rightRadians, up()) * glm::angleAxis(upRadians, right());
    orientation_ = glm::normalize(turn * orientation_);
    target_ = pivot_ + turn * (target_ - pivot_);
}

void Camera::pan(glm::dvec2 screenStep, double aspect) {
    target_ -= (right() * (screenStep.x * aspect) + up() * screenStep.y) * halfHeight();
}

void Camera::zoom(double factor, glm::dvec2 screen, double aspect) {
    if (!std::isfinite(factor) || factor <= 0.0)
        return;
    const double before = halfHeight();
    distance_ = std::clamp(distance_ / factor, sceneRadius_ * kNearestDistance, sceneRadius_ * kFarthestDistance);
    const double moved = before - halfHeight();
    target_ += (right() * (screen.x * aspect) + up() * screen.y) * moved;
}

CameraPose Camera::poseAround(glm::dvec3 middle, double radius, double aspect) const {
    aspect = usableAspect(aspect);
    const double halfAngle = std::min(kHalfFieldOfView, std::atan(std::tan(kHalfFieldOfView) * aspect));
    CameraPose around = pose();
    around.target = around.pivot = middle;
    around.distance = std::max(radius, sceneRadius_ * kSmallestBall) * kRoomAround / std::sin(halfAngle);
    return around;
}

bool Camera::setPose(const CameraPose& pose) {
    const auto& q = pose.orientation;
    const double length = std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
    const double sum = length + pose.target.x + pose.target.y + pose.target.z + pose.distance + pose.pivot.x +
                       pose.pivot.y + pose.pivot.z;
    if (!std::isfinite(sum) || !(length > 1e-6) || !(pose.distance > 0.0))
        return false;
    orientation_ = glm::dquat(q.w / length, q.x / length, q.y / length, q.z / length);
    const double farthest = sceneRadius_ * kFarthestDistance;
    target_ = glm::clamp(pose.target, glm::dvec3(-farthest), glm::dvec3(farthest));
    pivot_ = glm::clamp(pose.pivot, glm::dvec3(-farthest), glm::dvec3(farthest));
    distance_ = std::clamp(pose.distance, sceneRadius_ * kNearestDistance, farthest);
    isPerspective_ = pose.isPerspective;
    return true;
}

glm::dvec3 Camera::right() const { return orientation_ * glm::dvec3(1.0, 0.0, 0.0); }
glm::dvec3 Camera::up() const { return orientation_ * glm::dvec3(0.0, 1.0, 0.0); }
glm::dvec3 Camera::backward() const { return orientation_ * glm::dvec3(0.0, 0.0, 1.0); }

glm::dmat4 Camera::viewMatrix() const {
    const glm::dmat4 rotation = glm::mat4_cast(glm::conjugate(orientation_));
    return glm::translate(glm::dmat4(1.0), glm::dvec3(0.0, 0.0, -distance_)) * glm::translate(rotation, -target_) *
           glm::dmat4(stretch_);
}

glm::dmat3 Camera::normalMatrix() const {
    return glm::mat3_cast(glm::conjugate(orientation_)) * glm::inverseTranspose(stretch_);
}

glm::dvec3 Camera::facingNormal() const { return glm::normalize(glm::transpose(stretch_) * backward()); }

glm::dmat4 Camera::projectionMatrix(double aspect) const {
    aspect = usableAspect(aspect);
    // Both planes hug the scene's sphere, wherever the viewer stands: all depth bits go to the scene.
    const double centreDepth = glm::dot(backward(), eye());
    const double reach = std::max(sceneRadius_, reach_) * 1.05;
    const double far = std::max(centreDepth + reach, reach * 1e-3);
    if (!isPerspective_) {
        const double half = halfHeight();
        return glm::ortho(-half * aspect, half * aspect, -half, half, centreDepth - reach, far);
    }
    const double near = std::max(centreDepth - reach, std::min(distance_, far) * 2e-3);
    return glm::perspective(2.0 * kHalfFieldOfView, aspect, near, std::max(far, near * 1.001));
}

double Camera::halfHeight() const { return distance_ * std::tan(kHalfFieldOfView); }

} // namespace isoslider::model
