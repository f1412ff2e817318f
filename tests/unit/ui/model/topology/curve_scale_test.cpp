#include "ui/model/topology/curve_scale.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace isoslider::model {
namespace {

TEST(CurveScale, ReachesItsGreatestValue) {
    const std::vector<double> values{0.0, 5.0, 20.0, 10.0};
    const ScaledCurve curve = scaled(values);
    EXPECT_FALSE(curve.isLogarithmic);
    EXPECT_EQ(curve.heights, (std::vector<double>{0.0, 0.25, 1.0, 0.5}));
}

TEST(CurveScale, IsLogarithmicOverALargeSpan) {
    const std::vector<double> values{0.0, 1.0, 100.0, 10000.0};
    const ScaledCurve curve = scaled(values);
    EXPECT_TRUE(curve.isLogarithmic);
    EXPECT_EQ(curve.heights[0], 0.0);
    EXPECT_GT(curve.heights[1], 0.0);
    EXPECT_NEAR(curve.heights[2] - curve.heights[1], curve.heights[3] - curve.heights[2], 1e-12);
    EXPECT_EQ(curve.heights[3], 1.0);
}

TEST(CurveScale, IsLinearUpToAThousand) {
    EXPECT_FALSE(scaled(std::vector<double>{1.0, 1000.0}).isLogarithmic);
    EXPECT_TRUE(scaled(std::vector<double>{1.0, 1001.0}).isLogarithmic);
}

TEST(CurveScale, TakesAnyNumber) {
    EXPECT_TRUE(scaled({}).heights.empty());
    EXPECT_EQ(scaled(std::vector<double>{0.0, 0.0}).heights, (std::vector<double>{0.0, 0.0}));
    const double infinity = std::numeric_limits<double>::infinity();
    const std::vector<double> values{-3.0, std::nan(""), infinity, std::numeric_limits<double>::denorm_min(),
                                     std::numeric_limits<double>::max()};
    for (const double height : scaled(values).heights) {
        EXPECT_GE(height, 0.0);
        EXPECT_LE(height, 1.0);
    }
}

} // namespace
} // namespace isoslider::model
