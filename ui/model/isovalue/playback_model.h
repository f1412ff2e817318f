#pragma once

namespace isoslider::model {

enum class PlaybackMode { Once, Loop, PingPong };

/// Moves a position through [0, 1] with time: the isovalue animation, without a separate clock.
class PlaybackModel {
public:
    bool isPlaying() const { return isPlaying_; }
    PlaybackMode mode() const { return mode_; }
    /// Fractions of the value range per second.
    double speed() const { return speed_; }

    void setMode(PlaybackMode mode) { mode_ = mode; }
    /// Refuses what is not positive and finite.
    void setSpeed(double fractionPerSecond);
    /// At the end of a Once run, starting again starts from the beginning.
    void start(double position);
    void stop() { isPlaying_ = false; }

    /// The position `seconds` later. Stops at the end in Once mode.
    double advance(double seconds);

private:
    double advancePingPong(double travelled);

    PlaybackMode mode_ = PlaybackMode::PingPong;
    double speed_ = 0.05;
    double position_ = 0.0;
    double heading_ = 1.0;
    bool isPlaying_ = false;
};

} // namespace isoslider::model
