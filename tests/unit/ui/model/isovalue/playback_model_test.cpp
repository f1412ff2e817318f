#include "ui/model/isovalue/playback_model.h"

#include <limits>

#include <gtest/gtest.h>

namespace isoslider::model {
namespace {

PlaybackModel playing(PlaybackMode mode, double position) {
    PlaybackModel model;
    model.setMode(mode);
    model.setSpeed(0.1);
    model.start(position);
    return model;
}

TEST(PlaybackModel, OnceStopsAtTheEnd) {
    auto model = playing(PlaybackMode::Once, 0.95);
    EXPECT_NEAR(model.advance(0.2), 0.97, 1e-12);
    EXPECT_EQ(model.advance(1.0), 1.0);
    EXPECT_FALSE(model.isPlaying());
}

TEST(PlaybackModel, OnceAtTheEndStartsFromTheBeginning) {
    auto model = playing(PlaybackMode::Once, 1.0);
    EXPECT_NEAR(model.advance(1.0), 0.1, 1e-12);
}

TEST(PlaybackModel, LoopBeginsAgain) {
    auto model = playing(PlaybackMode::Loop, 0.95);
    EXPECT_NEAR(model.advance(1.0), 0.05, 1e-12);
    EXPECT_TRUE(model.isPlaying());
}

TEST(PlaybackModel, PingPongTurnsAtBothEnds) {
    auto model = playing(PlaybackMode::PingPong, 0.95);
    EXPECT_NEAR(model.advance(1.0), 0.95, 1e-12);
    EXPECT_NEAR(model.advance(9.0), 0.05, 1e-12);
    EXPECT_NEAR(model.advance(1.0), 0.05, 1e-12);
    EXPECT_NEAR(model.advance(1.0), 0.15, 1e-12);
}

TEST(PlaybackModel, RefusesSpeedsThatAreNone) {
    PlaybackModel model;
    model.setSpeed(0.2);
    model.setSpeed(0.0);
    model.setSpeed(-1.0);
    model.setSpeed(std::numeric_limits<double>::quiet_NaN());
    EXPECT_EQ(model.speed(), 0.2);
}

TEST(PlaybackModel, StandsStillUntilStarted) {
    PlaybackModel model;
    EXPECT_EQ(model.advance(10.0), 0.0);
}

} // namespace
} // namespace isoslider::model
