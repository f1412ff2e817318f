#include "ui/model/isovalue/value_scale.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "ui/model/isovalue/value_steps.h"

namespace isoslider::model {
namespace {

ValueDistribution distribution(double min, double max) {
    ValueDistribution values;
    values.min = values.body.min = min;
    values.max = values.body.max = max;
    for (int i = 0; i < 100; ++i) {
        const double value = min + (max - min) * i / 99.0;
        values.cells.push_back({value, value, 1});
    }
    return values;
}

TEST(ValueScale, ComesBackFromEveryPlace) {
    const std::vector<double> all{-3e38, -1000.0, -1.5, -1e-9, 0.0, 1e-9, 0.7, 42.0, 3e38};
    for (const ValueScale& scale : {ValueScale(), ValueScale(ScaleKind::Symlog, 0.1), ValueScale(ScaleKind::Log)}) {
        double last = -HUGE_VAL;
        for (const double value : all) {
            if (scale.kind() == ScaleKind::Log && value <= 0.0)
                continue;
            const double place = scale.placeOf(value);
            EXPECT_GT(place, last);
            EXPECT_NEAR(scale.valueAt(place), value, 1e-9 * std::abs(value) + 1e-12);
            last = place;
        }
    }
}

TEST(ValueScale, StaysFiniteAtTheEndsOfWhatThereIs) {
    constexpr double kMost = std::numeric_limits<double>::max();
    for (const ValueScale& scale : {ValueScale(ScaleKind::Symlog, 1e-3), ValueScale(ScaleKind::Log)})
        for (const double place : {scale.placeOf(kMost) + 1.0, scale.placeOf(-kMost) - 1.0, scale.placeOf(0.0)})
            EXPECT_TRUE(std::isfinite(scale.valueAt(place)));
}

TEST(ValueScale, ALogarithmOfValuesThatAreNotPositiveIsOnBothSidesOfZero) {
    EXPECT_EQ(ValueScale::fitting(ScaleKind::Log, distribution(0.5, 900.0)).kind(), ScaleKind::Log);
    EXPECT_EQ(ValueScale::fitting(ScaleKind::Log, distribution(0.0, 900.0)).kind(), ScaleKind::Symlog);
    EXPECT_EQ(ValueScale::fitting(ScaleKind::Linear, distribution(0.0, 900.0)).kind(), ScaleKind::Linear);
    EXPECT_EQ(ValueScale::fitting(ScaleKind::Symlog, ValueDistribution()).kind(), ScaleKind::Linear);
}

TEST(ValueScale, TicksAreRoundAndFew) {
    const auto labels = [](const ValueScale& scale, double lower, double upper, int most) {
        std::string text;
        for (const auto& tick : scale.ticks(scale.placeOf(lower), scale.placeOf(upper), most))
            text += tick.label + " ";
        return text;
    };
    EXPECT_EQ(labels(ValueScale(), 0.0, 255.0, 8), "0 50 100 150 200 250 ");
    EXPECT_EQ(labels(ValueScale(), -0.31, 0.32, 4), "-0.2 0 0.2 ");
    EXPECT_EQ(labels(ValueScale(ScaleKind::Log), 0.5, 20'000.0, 9), "1 10 100 1000 10000 ");
    EXPECT_EQ(labels(ValueScale(ScaleKind::Log), 2.0, 90.0, 9), "2 5 10 20 50 ");
    EXPECT_EQ(labels(ValueScale(ScaleKind::Symlog, 10.0), -1024.0, 3000.0, 9), "-1000 -100 -10 0 10 100 1000 ");
    for (const double most : {1e-300, 1e-5, 1.0, 3e38})
        for (const ValueScale& scale : {ValueScale(), ValueScale(ScaleKind::Symlog, most / 1e3)}) {
            const auto ticks = scale.ticks(scale.placeOf(-most), scale.placeOf(most), 9);
            EXPECT_GE(ticks.size(), 2u) << most;
            EXPECT_LE(ticks.size(), 12u) << most;
        }
    EXPECT_TRUE(ValueScale().ticks(1.0, 1.0, 9).empty());
}

TEST(RoundStep, IsOneTwoOrFive) {
    EXPECT_EQ(roundStep(1.0), 1.0);
    EXPECT_EQ(roundStep(1.99), 1.0);
    EXPECT_EQ(roundStep(2.0), 2.0);
    EXPECT_EQ(roundStep(0.0499), 0.02);
    EXPECT_EQ(roundStep(0.05), 0.05);
    EXPECT_EQ(roundStep(999.0), 500.0);
    EXPECT_GT(roundStep(0.0), 0.0);
    EXPECT_GT(roundStep(1e-320), 0.0);
}

TEST(NearestMultiple, HasTheDigitsOfItsStepAlone) {
    EXPECT_EQ(nearestMultiple(92.387695, 0.1), 92.4);
    EXPECT_EQ(nearestMultiple(92.387695, 0.02), 92.38);
    EXPECT_EQ(nearestMultiple(0.1 + 0.2, 0.1), 0.3);
    EXPECT_EQ(nearestMultiple(92.387695, 50.0), 100.0);
    EXPECT_EQ(nearestMultiple(-0.01, 0.1), 0.0);
    EXPECT_FALSE(std::signbit(nearestMultiple(-0.01, 0.1)));
    EXPECT_EQ(nearestMultiple(3e38, 0.1), 3e38);
}

TEST(SteppedBy, LeadsFromBetweenMultiplesToTheNextOne) {
    EXPECT_EQ(steppedBy(92.5, 1.0, 1.0), 93.0);
    EXPECT_EQ(steppedBy(92.5, -1.0, 1.0), 92.0);
    EXPECT_EQ(steppedBy(92.0, 1.0, 1.0), 93.0);
    EXPECT_EQ(steppedBy(92.0, -10.0, 1.0), 82.0);
    EXPECT_EQ(steppedBy(0.3, -1.0, 0.1), 0.2);
    EXPECT_EQ(steppedBy(0.1 + 0.2, 1.0, 0.1), 0.4) << "rounding is no distance";
    EXPECT_EQ(steppedBy(5.0, 0.25, 2.0), 5.5);
}

} // namespace
} // namespace isoslider::model
