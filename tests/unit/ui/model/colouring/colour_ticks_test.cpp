#include "ui/model/colouring/colour_ticks.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace isoslider::model {
namespace {

std::vector<std::string> textsOf(double low, double high, int most) {
    std::vector<std::string> texts;
    for (const ColourTick& tick : colourTicks(low, high, most))
        texts.push_back(tick.text);
    return texts;
}

using Texts = std::vector<std::string>;

TEST(ColourTicks, AreRoundNumbersWithinTheRange) {
    EXPECT_EQ(textsOf(0.0, 10.0, 6), (Texts{"0", "2", "4", "6", "8", "10"}));
    EXPECT_EQ(textsOf(0.0, 10.0, 11), (Texts{"0", "1", "2", "3", "4", "5", "6", "7", "8", "9", "10"}));
    EXPECT_EQ(textsOf(-0.31, 0.31, 7), (Texts{"-0.3", "-0.2", "-0.1", "0", "0.1", "0.2", "0.3"}));
    EXPECT_EQ(textsOf(1234.5, 1239.9, 4), (Texts{"1236", "1238"}));
    EXPECT_EQ(textsOf(-1200.0, 3100.0, 6), (Texts{"-1000", "0", "1000", "2000", "3000"}));
}

TEST(ColourTicks, AreAsManyAsThereIsRoomForAtMost) {
    for (const double span : {1.0, 1.3, 2.7, 4.9, 7.1, 9.99, 3e-7, 8e11})
        for (int most = 2; most <= 9; ++most) {
            const auto ticks = colourTicks(0.123 * span, 1.123 * span, most);
            EXPECT_LE(ticks.size(), static_cast<std::size_t>(most)) << span;
            EXPECT_GE(static_cast<int>(ticks.size()), most >= 4 ? 2 : 0) << span << ", " << most;
            for (const ColourTick& tick : ticks)
                EXPECT_TRUE(tick.value >= 0.123 * span && tick.value <= 1.123 * span) << tick.value;
        }
}

TEST(ColourTicks, AreNoneWhereNumbersHaveNoSuchDistance) {
    EXPECT_TRUE(colourTicks(1.0, 1.0, 5).empty());
    EXPECT_TRUE(colourTicks(2.0, 1.0, 5).empty());
    EXPECT_TRUE(colourTicks(0.0, std::numeric_limits<double>::infinity(), 5).empty());
    EXPECT_TRUE(colourTicks(1e18, std::nextafter(1e18, 2e18), 5).empty());
    EXPECT_TRUE(colourTicks(std::nan(""), 1.0, 5).empty());
}

} // namespace
} // namespace isoslider::model
