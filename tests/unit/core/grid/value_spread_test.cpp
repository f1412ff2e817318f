#include "core/grid/value_spread.h"

#include <cmath>
#include <limits>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/result_matchers.h"

namespace isoslider {
namespace {

using test::HasError;
using test::IsOk;

template <class Sample>
ValueSpread spreadOfValues(const std::vector<Sample>& values) {
    SpreadSum sum;
    sum.add(std::span<const Sample>(values));
    return sum.spread();
}

TEST(ValueSpread, IsMeanAndDeviationOfAllSamples) {
    const ValueSpread found = spreadOfValues<std::uint8_t>({2, 4, 4, 4, 5, 5, 7, 9});
    EXPECT_EQ(found.mean, 5.0);
    EXPECT_EQ(found.deviation, 2.0) << "divided by the count, not by one less";
    EXPECT_EQ(found.deviationsOf(10.0), 2.5);
    EXPECT_TRUE(found.isExact);
}

TEST(ValueSpread, LeavesMissingSamplesOut) {
    constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInf = std::numeric_limits<float>::infinity();
    const ValueSpread found = spreadOfValues<float>({kNan, 2, 4, 4, kInf, 4, 5, 5, 7, 9, -kInf});
    EXPECT_EQ(found.mean, 5.0);
    EXPECT_EQ(found.deviation, 2.0);
}

TEST(ValueSpread, OfNothingAndOfEqualSamplesHasNoDeviation) {
    EXPECT_EQ(spreadOfValues<float>({}).deviation, 0.0);
    const ValueSpread constant = spreadOfValues(std::vector<double>(10'000, 0.1));
    EXPECT_EQ(constant.mean, 0.1);
    EXPECT_EQ(constant.deviation, 0.0) << "though sums of 0.1 are not exact";
}

// A plain sum of squares of these loses all digits of the deviation.
TEST(ValueSpread, KeepsItsDigitsFarFromZero) {
    std::vector<double> values;
    for (int i = 0; i < 100'000; ++i)
        values.push_back(1e12 + i % 2);
    const ValueSpread found = spreadOfValues(values);
    EXPECT_EQ(found.mean, 1e12 + 0.5);
    EXPECT_NEAR(found.deviation, 0.5, 1e-10);
}

TEST(ValueSpread, OfTheLargestNumbersIsFinite) {
    constexpr double kMost = std::numeric_limits<double>::max();
    const ValueSpread found = spreadOfValues<double>({-kMost, kMost, -kMost, kMost});
    EXPECT_EQ(found.mean, 0.0);
    EXPECT_NEAR(found.deviation / kMost, 1.0, 1e-10);
}

TEST(ValueSpread, DoesNotDependOnTheOrderOfTheSums) {
    const unsigned seed = 20261130;
    std::mt19937 random(seed);
    std::normal_distribution<float> draw(0.37F, 1.7F);
    std::vector<float> values(300'000);
    for (float& value : values)
        value = draw(random);
    const ValueSpread whole = spreadOfValues(values);
    EXPECT_NEAR(whole.mean, 0.37, 0.02);
    EXPECT_NEAR(whole.deviation, 1.7, 0.02);
    for (const std::size_t part : {std::size_t{7}, std::size_t{4096}, std::size_t{5000}}) {
        std::vector<SpreadSum> sums;
        for (std::size_t begin = 0; begin < values.size(); begin += part)
            sums.emplace_back().add(
                std::span<const float>(values).subspan(begin, std::min(part, values.size() - begin)));
        SpreadSum all;
        for (auto sum = sums.rbegin(); sum != sums.rend(); ++sum)
            all.merge(*sum);
        EXPECT_EQ(all.count(), values.size());
        EXPECT_EQ(all.spread().mean, whole.mean) << part << ", seed " << seed;
        EXPECT_EQ(all.spread().deviation, whole.deviation) << part << ", seed " << seed;
    }
}

TEST(AskedIsovalue, IsAValueOrDeviationsFromTheMean) {
    const ValueSpread spread{10.0, 4.0, true};
    EXPECT_EQ(AskedIsovalue(7.5).in(spread).value(), 7.5);
    EXPECT_EQ(AskedIsovalue(2.5, true).in(spread).value(), 20.0);
    EXPECT_EQ(AskedIsovalue(-1.0, true).in(spread).value(), 6.0);
    EXPECT_THAT(AskedIsovalue(7.5).in(ValueSpread()), IsOk());
    EXPECT_THAT(AskedIsovalue(2.5, true).in(ValueSpread()), HasError(ErrorCode::InvalidArgument));
}

TEST(RemoveDeviationWord, TakesTheWordAndItsBlanks) {
    for (const char* given : {"2.5 sigma", "2.5sigma", "2.5 \xCF\x83", "2.5\xCF\x83 ", "2.5 sd", "2.5SD", "2.5  Std",
                              "2.5 SIGMA", "2.5 \xCE\xA3"}) {
        std::string_view text = given;
        EXPECT_TRUE(removeDeviationWord(text)) << given;
        EXPECT_EQ(text, "2.5") << given;
    }
    for (const char* given : {"2.5", "2.5 s", "sigma 2", "2.5 rms", "", " "}) {
        std::string_view text = given;
        EXPECT_FALSE(removeDeviationWord(text)) << given;
        EXPECT_EQ(text, given);
    }
}

} // namespace
} // namespace isoslider
