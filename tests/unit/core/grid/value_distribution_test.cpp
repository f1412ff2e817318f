#include "core/grid/value_distribution.h"

#include <cmath>
#include <limits>
#include <numeric>
#include <random>

#include <gtest/gtest.h>

#include "tests/support/result_matchers.h"
#include "tests/unit/core/grid/row_of.h"

namespace isoslider {
namespace {

template <class T>
ValueDistribution distributionOfRow(ScalarType type, const std::vector<T>& values) {
    double min = HUGE_VAL, max = -HUGE_VAL;
    for (const T value : values)
        if (std::isfinite(static_cast<double>(value))) {
            min = std::min(min, static_cast<double>(value));
            max = std::max(max, static_cast<double>(value));
        }
    auto found = distributionOf(test::rowOf<T>(type, values), min, max);
    EXPECT_THAT(found, test::IsOk());
    return std::move(found).value();
}

std::uint64_t bodyCount(const ValueDistribution& values) {
    return std::accumulate(values.body.counts.begin(), values.body.counts.end(), std::uint64_t{0});
}

/// 100,000 values from a normal distribution, all different.
std::vector<float> noise(float mean, float deviation) {
    std::mt19937 random(7);
    std::normal_distribution<float> normal(mean, deviation);
    std::vector<float> values(100'000);
    for (float& value : values)
        value = normal(random);
    return values;
}

TEST(ValueDistribution, OneOutlierLeavesTheBodyAsItIs) {
    const auto plain = noise(100.0f, 10.0f);
    for (const float outlier : {3e38f, -3e38f}) {
        auto values = plain;
        values[4711] = outlier;
        const auto found = distributionOfRow(ScalarType::F32, values);
        EXPECT_GT(found.body.min, 30.0);
        EXPECT_LT(found.body.max, 170.0);
        EXPECT_GT(found.body.max - found.body.min, 70.0);
        EXPECT_EQ(found.above, outlier > 0 ? 1u : 0u);
        EXPECT_EQ(found.below, outlier < 0 ? 1u : 0u);
        EXPECT_EQ(bodyCount(found), values.size() - 1);
        EXPECT_EQ(found.counted(), values.size());
        EXPECT_FALSE(found.isEachValue);
    }
}

TEST(ValueDistribution, OutliersFarFromValuesThatAreCloseTogetherTakeNoResolution) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> uniform(1e6, 1e6 + 1.0);
    std::vector<double> close(100'000);
    for (double& value : close)
        value = uniform(random);
    close[17] = 1e300;
    const auto found = distributionOfRow(ScalarType::F64, close);
    const double bin = (found.body.max - found.body.min) / static_cast<double>(found.body.counts.size());
    EXPECT_LT(bin, 1e-3) << "cells at a million are wider than all of the body";
    EXPECT_EQ(found.above, 1u);
    EXPECT_EQ(bodyCount(found), close.size() - 1);
}

TEST(ValueDistribution, AFillValueOfMostSamplesIsLeftOut) {
    auto values = noise(400.0f, 100.0f);
    for (std::size_t i = 0; i < values.size(); ++i)
        if (i % 10 != 0)
            values[i] = -9999.0f;
    const auto found = distributionOfRow(ScalarType::F32, values);
    EXPECT_GT(found.body.min, -200.0);
    EXPECT_EQ(found.below, 90'000u);
    EXPECT_EQ(found.min, -9999.0);

    std::vector<std::int16_t> whole(values.begin(), values.end());
    const auto ofWhole = distributionOfRow(ScalarType::I16, whole);
    EXPECT_GT(ofWhole.body.min, -200.0);
    EXPECT_EQ(ofWhole.below, 90'000u);
}

TEST(ValueDistribution, AHeavyTailIsLeftOutAndCounted) {
    auto values = noise(0.0f, 1.0f);
    for (std::size_t i = 0; i < 20; ++i)
        values[i * 100] = std::exp2(static_cast<float>(i)); // up to half a million, without a gap
    const auto found = distributionOfRow(ScalarType::F32, values);
    EXPECT_LT(found.body.max, 30.0);
    EXPECT_GT(found.above, 10u);
    EXPECT_EQ(found.above + found.below + bodyCount(found), values.size());
}

TEST(ValueDistribution, WithoutOutliersAllIsBody) {
    const auto found = distributionOfRow(ScalarType::F32, noise(0.0f, 1.0f));
    EXPECT_EQ(found.body.min, found.min);
    EXPECT_EQ(found.body.max, found.max);
    EXPECT_EQ(found.below + found.above, 0u);
}

TEST(ValueDistribution, SmallWholeNumbersAreNeverOutliers) {
    std::vector<std::uint8_t> values;
    for (int i = 0; i < 40; ++i)
        values.insert(values.end(), 10, static_cast<std::uint8_t>(i));
    values.push_back(255);
    const auto found = distributionOfRow(ScalarType::U8, values);
    EXPECT_EQ(found.below + found.above, 0u);
    EXPECT_EQ(found.body.min, -0.5);
    EXPECT_EQ(found.body.max, 255.5);
    EXPECT_EQ(found.body.counts.size(), 256u);
    EXPECT_EQ(found.body.counts[39], 10u);
    EXPECT_EQ(found.body.counts[255], 1u);
    EXPECT_EQ(found.spacing, 1.0);
    EXPECT_TRUE(found.isEachValue);
}

TEST(ValueDistribution, WholeNumbersStoredAsRealOnesAreWhole) {
    std::vector<float> values;
    for (int i = 0; i < 5000; ++i)
        values.push_back(static_cast<float>(i % 300 * 3));
    const auto found = distributionOfRow(ScalarType::F32, values);
    EXPECT_TRUE(found.isEachValue);
    EXPECT_EQ(found.spacing, 1.0);
    EXPECT_EQ(found.cells.size(), 300u);
}

TEST(ValueDistribution, ScaledWholeNumbersHaveTheirSpacing) {
    std::vector<float> values;
    for (int i = 0; i < 5000; ++i)
        values.push_back(0.25f + 0.01f * static_cast<float>(i % 400));
    const auto found = distributionOfRow(ScalarType::F32, values);
    EXPECT_NEAR(found.spacing, 0.01, 1e-6);
    EXPECT_EQ(found.body.counts.size(), 400u);
    for (const auto count : found.body.counts)
        EXPECT_NEAR(static_cast<double>(count), 12.5, 0.6) << "a bin for each value, none of two";
}

TEST(ValueDistribution, LeavesMissingSamplesOut) {
    auto values = noise(5.0f, 1.0f);
    values[3] = std::numeric_limits<float>::quiet_NaN();
    values[5] = std::numeric_limits<float>::infinity();
    EXPECT_EQ(distributionOfRow(ScalarType::F32, values).counted(), values.size() - 2);
}

TEST(ValueDistribution, OfAConstantHasOneValue) {
    const auto found = distributionOfRow(ScalarType::F32, std::vector<float>(100, 7.5f));
    ASSERT_EQ(found.cells.size(), 1u);
    EXPECT_EQ(found.cells[0].lower, 7.5);
    EXPECT_EQ(bodyCount(found), 100u);
}

// The difference of its ends is infinite.
TEST(ValueDistribution, OfTheWidestRangeHasABody) {
    const auto found = distributionOfRow<double>(ScalarType::F64, {-1e308, 0.0, 0.5e308, 1e308});
    EXPECT_EQ(found.counted(), 4u);
    EXPECT_EQ(bodyCount(found), 4u);
    EXPECT_EQ(found.spacing, 0.0);
}

TEST(ValueDistribution, WideWholeNumbersKeepTheirEnds) {
    std::vector<std::int32_t> values;
    for (int i = 0; i < 100'000; ++i)
        values.push_back(i * 20'000 - 1'000'000'000);
    const auto found = distributionOfRow(ScalarType::I32, values);
    EXPECT_EQ(found.spacing, 1.0);
    EXPECT_EQ(bodyCount(found) + found.above + found.below, values.size());
    EXPECT_EQ(found.above + found.below, 0u);
}

TEST(ValueDistribution, CellsAscendAndHoldAll) {
    const auto found = distributionOfRow(ScalarType::F32, noise(0.0f, 1e-3f));
    double last = -HUGE_VAL;
    for (const ValueCell& cell : found.cells) {
        EXPECT_GE(cell.lower, last);
        EXPECT_GE(cell.upper, cell.lower);
        EXPECT_GT(cell.count, 0u);
        last = cell.upper;
    }
    EXPECT_EQ(found.counted(), 100'000u);
}

TEST(ValueDistribution, StopsWhenAsked) {
    std::stop_source stop;
    stop.request_stop();
    EXPECT_TRUE(
        distributionOf(test::rowOf<float>(ScalarType::F32, {1, 2}), 1, 2, {stop.get_token(), {}}).isCancelled());
}

TEST(RangeWithoutOutliers, TwoClassesOfFewValuesAreBothKept) {
    const std::vector<ValueCell> cells{{0.0, 0.0, 1000}, {1e6, 1e6, 10}};
    EXPECT_EQ(rangeWithoutOutliers(cells), (std::pair<double, double>(0.0, 1e6)));
}

} // namespace
} // namespace isoslider
