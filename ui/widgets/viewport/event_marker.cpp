#include "ui/widgets/viewport/event_marker.h"

#include <algorithm>
#include <cmath>

#include "ui/widgets/viewport/viewport_widget.h"

namespace isoslider::widgets {
namespace {

constexpr int kStepMs = 60; // each draws the surface again

} // namespace

EventMarker::EventMarker(ViewportWidget& viewport) : QObject(&viewport), viewport_(viewport) {
    timer_.setInterval(kStepMs);
    connect(&timer_, &QTimer::timeout, this, &EventMarker::fade);
}

void EventMarker::mark(const glm::dvec3& place) {
    place_ = place;
    isMarked_ = true;
    sinceMarked_.start();
    timer_.start();
    fade();
}

void EventMarker::clear() {
    timer_.stop();
    if (!std::exchange(isMarked_, false))
        return;
    viewport_.setSpot(std::nullopt);
}

float EventMarker::strength() const {
    if (!isMarked_)
        return 0.0f;
    const float part = std::min(1.0f, static_cast<float>(sinceMarked_.elapsed()) / kFadeMs);
    return std::lerp(1.0f, kFaint, part * part); // slowly first: it has to be found
}

void EventMarker::fade() {
    viewport_.setSpot(place_, strength());
    if (sinceMarked_.hasExpired(kFadeMs))
        timer_.stop();
}

} // namespace isoslider::widgets
