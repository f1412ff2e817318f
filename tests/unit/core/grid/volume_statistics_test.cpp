#include "core/grid/volume_statistics.h"

#include <limits>
#include <numeric>
#include <random>
#include <set>

#include <gtest/gtest.h>

#include "tests/support/result_matchers.h"
#include "tests/unit/core/grid/row_of.h"

namespace isoslider {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();

TEST(VolumeStatistics, CountsZerosOnceAndLeavesMissingOut) {
    const auto grid = test::rowOf<float>(ScalarType::F32, {-0.0f, 0.0f, kNan, kInf, -kInf, -kNan, 1.0f, -2.0f, 1e-45f});
    const auto statistics = computeStatistics(grid);
    ASSERT_THAT(statistics, test::IsOk());
    EXPECT_EQ(statistics.value().min, -2.0);
    EXPECT_EQ(statistics.value().max, 1.0);
    EXPECT_EQ(statistics.value().distinctValues, 4u);
    EXPECT_EQ(statistics.value().nanCount, 4u);
    const auto& counts = statistics.value().histogram.counts;
    EXPECT_EQ(std::accumulate(counts.begin(), counts.end(), std::uint64_t{0}), 5u);
}

TEST(VolumeStatistics, HandlesTheEndsOfEveryIntegerType) {
    const auto ends = [](auto sample, ScalarType type) {
        using T = decltype(sample);
        const T low = std::numeric_limits<T>::min(), high = std::numeric_limits<T>::max();
        const auto statistics = computeStatistics(test::rowOf<T>(type, {high, low, high, T{1}}));
        ASSERT_THAT(statistics, test::IsOk());
        EXPECT_EQ(statistics.value().min, static_cast<double>(low));
        EXPECT_EQ(statistics.value().max, static_cast<double>(high));
        EXPECT_EQ(statistics.value().distinctValues, 3u);
        EXPECT_EQ(statistics.value().histogram.counts.front(), type == ScalarType::U16 ? 2u : 1u);
        EXPECT_EQ(statistics.value().histogram.counts.back(), 2u);
    };
    ends(std::uint8_t{}, ScalarType::U8);
    ends(std::int8_t{}, ScalarType::I8);
    ends(std::uint16_t{}, ScalarType::U16);
    ends(std::int16_t{}, ScalarType::I16);
    ends(std::int32_t{}, ScalarType::I32);
}

TEST(VolumeStatistics, HandlesTheWholeRangeOfDoubles) {
    const double most = std::numeric_limits<double>::max();
    const auto statistics = computeStatistics(test::rowOf<double>(ScalarType::F64, {-most, most, 0.0}));
    ASSERT_THAT(statistics, test::IsOk());
    EXPECT_EQ(statistics.value().distinctValues, 3u);
    EXPECT_EQ(statistics.value().histogram.counts.front(), 1u);
    EXPECT_EQ(statistics.value().histogram.counts[256], 1u);
    EXPECT_EQ(statistics.value().histogram.counts.back(), 1u);
}

TEST(VolumeStatistics, AcceptsAConstantVolume) {
    const auto statistics = computeStatistics(test::rowOf<float>(ScalarType::F32, {5, 5, 5}));
    ASSERT_THAT(statistics, test::IsOk());
    EXPECT_EQ(statistics.value().min, 5.0);
    EXPECT_EQ(statistics.value().max, 5.0);
    EXPECT_EQ(statistics.value().distinctValues, 1u);
    EXPECT_EQ(statistics.value().histogram.counts.front(), 3u);
}

TEST(VolumeStatistics, RefusesAVolumeWithoutFiniteSample) {
    const auto statistics = computeStatistics(test::rowOf<float>(ScalarType::F32, {kNan, kInf}));
    ASSERT_THAT(statistics, test::HasError(ErrorCode::InvalidArgument));
    EXPECT_EQ(statistics.error().message, "has no finite sample");
}

TEST(VolumeStatistics, AgreesWithASet) {
    std::mt19937 random(7);
    std::vector<std::int32_t> values(3'000'000);
    for (auto& value : values)
        value = static_cast<std::int32_t>(random() % 100'000) - 50'000;
    const auto statistics = computeStatistics(test::rowOf<std::int32_t>(ScalarType::I32, values));
    ASSERT_THAT(statistics, test::IsOk());
    EXPECT_EQ(statistics.value().distinctValues, std::set<std::int32_t>(values.begin(), values.end()).size());
    EXPECT_EQ(computeStatistics(test::rowOf<std::int32_t>(ScalarType::I32, values), false).value().distinctValues, 0u);
}

TEST(VolumeStatistics, StopsOnRequest) {
    std::stop_source stop;
    stop.request_stop();
    EXPECT_TRUE(
        computeStatistics(test::rowOf<float>(ScalarType::F32, {1, 2}), true, 8, {stop.get_token(), {}}).isCancelled());
}

} // namespace
} // namespace isoslider
