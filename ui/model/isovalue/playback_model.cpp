#include "ui/model/isovalue/playback_model.h"

#include <algorithm>
#include <cmath>

namespace isoslider::model {

void PlaybackModel::setSpeed(double fractionPerSecond) {
    if (std::isfinite(fractionPerSecond) && fractionPerSecond > 0.0)
        speed_ = fractionPerSecond;
}

void PlaybackModel::start(double position) {
    position_ = std::clamp(position, 0.0, 1.0);
    heading_ = 1.0;
    if (mode_ == PlaybackMode::Once && position_ >= 1.0)
        position_ = 0.0;
    isPlaying_ = true;
}

double PlaybackModel::advance(double seconds) {
    if (!isPlaying_)
        return position_;
    const double travelled = speed_ * std::max(seconds, 0.0);
    switch (mode_) {
        case PlaybackMode::Once:
            position_ = std::min(position_ + travelled, 1.0);
            isPlaying_ = position_ < 1.0;
            break;
        case PlaybackMode::Loop: position_ = std::fmod(position_ + travelled, 1.0); break;
        case PlaybackMode::PingPong: position_ = advancePingPong(travelled); break;
    }
    return position_;
}

double PlaybackModel::advancePingPong(double travelled) {
    // On a circle of length 2, whose second half is the way back.
    const double place = heading_ > 0.0 ? position_ : 2.0 - position_;
    const double next = std::fmod(place + travelled, 2.0);
    heading_ = next < 1.0 ? 1.0 : -1.0;
    return next < 1.0 ? next : 2.0 - next;
}

} // namespace isoslider::model
