#include "ui/model/surface/scale_bar.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "ui/model/isovalue/number_text.h"

namespace isoslider::model {
namespace {

TEST(ScaleBar, IsTheLongestRoundLengthThatFits) {
    const auto length = [](double perPixel) { return scaleBarOf(perPixel, 100.0).value().length; };
    EXPECT_EQ(length(0.01), 1.0);
    EXPECT_EQ(length(0.00999), 0.5);
    EXPECT_EQ(length(0.0199), 1.0);
    EXPECT_EQ(length(0.02), 2.0);
    EXPECT_EQ(length(0.0499), 2.0);
    EXPECT_EQ(length(0.05), 5.0);
    EXPECT_EQ(length(0.0999), 5.0);
    EXPECT_EQ(length(1234.5), 100000.0);
    EXPECT_EQ(length(2.5e-9), 2e-7);
    EXPECT_NEAR(scaleBarOf(0.0499, 100.0)->pixels, 2.0 / 0.0499, 1e-9);
}

TEST(ScaleBar, AtEveryScaleItIsRoundAndTakesTwoFifthsOfTheRoomAtLeast) {
    for (double perPixel = 1e-150; perPixel < 1e150; perPixel *= 1.37) {
        const auto bar = scaleBarOf(perPixel, 92.0);
        ASSERT_TRUE(bar) << perPixel;
        EXPECT_LE(bar->pixels, 92.0 * (1.0 + 1e-12)) << perPixel;
        EXPECT_GE(bar->pixels, 0.4 * 92.0 * (1.0 - 1e-12)) << perPixel;
        EXPECT_NEAR(bar->pixels * perPixel / bar->length, 1.0, 1e-12);
        const double power = std::pow(10.0, std::floor(std::log10(bar->length * (1.0 + 1e-12))));
        const double digit = bar->length / power;
        EXPECT_LT(std::abs(digit - std::round(digit)), 1e-9) << bar->length;
        const long rounded = std::lround(digit);
        EXPECT_TRUE(rounded == 1 || rounded == 2 || rounded == 5) << bar->length;
    }
}

TEST(ScaleBar, ReadsAsWritten) {
    EXPECT_EQ(valueText(scaleBarOf(0.0035, 92.0)->length), "0.2");
    EXPECT_EQ(valueText(scaleBarOf(6e-5, 92.0)->length), "0.005");
    EXPECT_EQ(valueText(scaleBarOf(3.0, 92.0)->length), "200");
}

TEST(ScaleBar, ThereIsNoneWhereLengthsMeanNothing) {
    const double nan = std::nan(""), infinite = std::numeric_limits<double>::infinity();
    for (const double bad : {0.0, -1.0, nan, infinite, 1e-310, 1e300}) {
        EXPECT_FALSE(scaleBarOf(bad, 92.0)) << bad;
        if (bad != 1e300 && bad != 1e-310) {
            EXPECT_FALSE(scaleBarOf(1.0, bad)) << bad;
        }
    }
    EXPECT_FALSE(scaleBarOf(infinite, 0.0));
}

} // namespace
} // namespace isoslider::model
