#include "preprocess/levels/key_intervals.h"

#include <cmath>
#include <map>
#include <numeric>
#include <random>

#include <gtest/gtest.h>

namespace isoslider::preprocess {
namespace {

template <class Sample>
std::vector<KeyCount> countsOf(const std::vector<double>& values) {
    KeyCounter<KeyOf<Sample>> counter(values.size());
    for (const double value : values)
        counter.add(keyOf(static_cast<Sample>(value)));
    return counter.takeCounts();
}

template <class Sample>
double valueOf(const KeyCount& count) {
    return static_cast<double>(sampleOfKey<Sample>(static_cast<KeyOf<Sample>>(count.key)));
}

// -bound to bound, small ones much more often.
std::vector<double> randomValues(std::size_t count, int bound) {
    std::mt19937 random(9);
    std::vector<double> values(count);
    for (double& value : values) {
        const double share = static_cast<double>(random()) / 4294967296.0;
        value = std::floor(bound * share * share * share) * (random() % 2 == 0 ? 1.0 : -1.0) + 0.0;
    }
    return values;
}

TEST(KeyCounter, CountsExactlyWhereThereAreFewKeysOrFewPoints) {
    for (const auto& values : {randomValues(3'000'000, 400), randomValues(100'000, 30'000), randomValues(1, 3)}) {
        std::map<double, std::uint64_t> expected;
        for (const double value : values)
            ++expected[value];
        const auto counts = countsOf<float>(values);
        ASSERT_EQ(counts.size(), expected.size());
        std::size_t i = 0;
        for (const auto& [value, points] : expected) {
            EXPECT_EQ(valueOf<float>(counts[i]), value);
            EXPECT_EQ(counts[i++].points, points);
        }
    }
    EXPECT_TRUE(countsOf<double>({}).empty());
}

TEST(KeyCounter, EstimatesWhereThereAreManyOfBoth) {
    const auto values = randomValues(5'000'000, 30'000);
    const auto counts = countsOf<double>(values);
    const auto total = std::accumulate(counts.begin(), counts.end(), std::uint64_t{0},
                                       [](std::uint64_t sum, const KeyCount& count) { return sum + count.points; });
    EXPECT_NEAR(static_cast<double>(total), static_cast<double>(values.size()), 10.0);
    double below = 0.0;
    for (const KeyCount& count : counts)
        below += valueOf<double>(count) < 1000.0 ? static_cast<double>(count.points) : 0.0;
    const auto expected = std::count_if(values.begin(), values.end(), [](double value) { return value < 1000.0; });
    EXPECT_NEAR(below / static_cast<double>(expected), 1.0, 0.01);
}

template <class Sample>
void expectSameCounts(const std::vector<KeyCount>& expected, const std::vector<double>& values) {
    const auto counts = countsOf<Sample>(values);
    ASSERT_EQ(counts.size(), expected.size());
    for (std::size_t i = 0; i < counts.size(); ++i) {
        ASSERT_EQ(valueOf<Sample>(counts[i]), valueOf<std::int16_t>(expected[i]));
        ASSERT_EQ(counts[i].points, expected[i].points);
    }
}

TEST(KeyCounter, CountsTheSameFieldAlikeInEveryType) {
    const auto values = randomValues(2'500'000, 30'000);
    const auto expected = countsOf<std::int16_t>(values);
    expectSameCounts<std::int32_t>(expected, values);
    expectSameCounts<float>(expected, values);
    expectSameCounts<double>(expected, values);
}

TEST(KeyIntervals, FindTheIntervalOfEveryKey) {
    std::mt19937_64 random(3);
    for (int round = 0; round < 200; ++round) {
        std::map<std::uint64_t, int> begins{{0, 0}};
        const std::size_t count = 1 + random() % 1500;
        const int shift = static_cast<int>(random() % 64);
        while (begins.size() < count && begins.size() < (std::uint64_t{1} << (63 - shift)))
            begins[random() >> (random() % 2 == 0 ? shift : 63 - static_cast<int>(random() % (64 - shift)))] = 0;
        std::vector<std::uint64_t> list;
        for (const auto& [begin, unused] : begins)
            list.push_back(begin);
        const KeyIntervals intervals(list);
        ASSERT_EQ(intervals.count(), list.size());
        const auto expectFound = [&](std::uint64_t key) {
            const auto after = std::upper_bound(list.begin(), list.end(), key);
            ASSERT_EQ(intervals.find(key), static_cast<std::size_t>(after - list.begin()) - 1) << key;
        };
        for (const std::uint64_t begin : list) {
            expectFound(begin);
            expectFound(begin + 1);
            expectFound(begin - 1);
            expectFound(random() >> shift);
        }
        expectFound(~std::uint64_t{0});
    }
}

TEST(KeyIntervals, SayWhereThereIsOneKeyOnly) {
    const KeyIntervals intervals({0, 1, 5, 6, 9});
    EXPECT_TRUE(intervals.hasOneKey(0));
    EXPECT_FALSE(intervals.hasOneKey(1));
    EXPECT_TRUE(intervals.hasOneKey(2));
    EXPECT_FALSE(intervals.hasOneKey(3));
    EXPECT_FALSE(intervals.hasOneKey(4)) << "the last one goes on to the end";
}

} // namespace
} // namespace isoslider::preprocess
