#include "ui/widgets/viewport/event_marker.h"

#include <algorithm>
#include <cmath>

#include "ui/widgets/viewport/viewport_widget.h"

namespace isoslider::widgets {
namespace {

constexpr int kStepMs = 60; // each draws the surface again
constexpr int kPassedStepMs = 100;

} // namespace

EventMarker::EventMarker(ViewportWidget& viewport) : QObject(&viewport), viewport_(viewport) {
    connect(&timer_, &QTimer::timeout, this, &EventMarker::fade);
    connect(&passedTimer_, &QTimer::timeout, this, &EventMarker::fadePassed);
}

void EventMarker::mark(const glm::dvec3& place) {
    place_ = place;
    isMarked_ = true;
    hasPassed_ = false;
    passedTimer_.stop();
    sinceMarked_.start();
    timer_.start(kStepMs);
    fade();
}

void EventMarker::markPassed(const glm::dvec3& place) {
    passed_ = place;
    hasPassed_ = true;
    timer_.stop();
    sincePassed_.start();
    passedTimer_.start(kMomentMs); // until then nothing is drawn again: the surface has only just come
    viewport_.setSpot(passed_);
}

void EventMarker::clear() {
    timer_.stop();
    passedTimer_.stop();
    const bool wasMarked = std::exchange(isMarked_, false);
    if (std::exchange(hasPassed_, false) || wasMarked)
        viewport_.setSpot(std::nullopt);
}

void EventMarker::fadePassed() {
    const auto elapsed = static_cast<float>(sincePassed_.elapsed() - kMomentMs);
    const float left = 1.0f - elapsed / static_cast<float>(kPassingMs);
    if (left > 0.0f) {
        passedTimer_.start(kPassedStepMs);
        return viewport_.setSpot(passed_, std::min(left, 1.0f));
    }
    passedTimer_.stop();
    hasPassed_ = false;
    if (isMarked_)
        timer_.start(kStepMs);
    fade();
}

// Slowly first: it has to be found.
void EventMarker::fade() {
    if (isMarked_) {
        const float share = std::min(1.0f, static_cast<float>(sinceMarked_.elapsed()) / static_cast<float>(kFadeMs));
        viewport_.setSpot(place_, std::lerp(1.0f, kFaint, share * share));
    } else {
        viewport_.setSpot(std::nullopt);
    }
    if (!isMarked_ || sinceMarked_.hasExpired(kFadeMs))
        timer_.stop();
}

} // namespace isoslider::widgets
