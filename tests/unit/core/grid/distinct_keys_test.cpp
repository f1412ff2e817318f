#include "core/grid/distinct_keys.h"

#include <algorithm>
#include <atomic>
#include <barrier>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>
#include <random>
#include <set>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "core/grid/classification.h"

namespace isoslider {
namespace {

constexpr std::uint64_t kPlenty = std::uint64_t{1} << 30;
constexpr std::uint64_t kBitmapBytes = 1 << 17;

struct Outcome {
    std::uint64_t count = 0;
    int passes = 1;
};

// Each pass cuts the samples in another way and lets the threads take the spans as they come.
template <class Sample>
Outcome countDistinct(const std::vector<Sample>& samples, std::uint64_t memoryBytes, int threads = 1) {
    DistinctKeys<Sample> distinct(memoryBytes);
    std::mt19937_64 random(7);
    for (Outcome outcome;; ++outcome.passes) {
        std::vector<std::span<const Sample>> spans;
        for (std::span<const Sample> rest = samples; !rest.empty(); rest = rest.subspan(spans.back().size()))
            spans.push_back(rest.first(std::min<std::size_t>(rest.size(), 1 + random() % 5000)));
        std::shuffle(spans.begin(), spans.end(), random);
        std::atomic<std::size_t> next = 0;
        std::vector<std::jthread> running;
        for (int t = 0; t < threads; ++t)
            running.emplace_back([&] {
                for (std::size_t s; (s = next++) < spans.size();)
                    distinct.add(spans[s]);
            });
        running.clear();
        if (distinct.endPass()) {
            outcome.count = distinct.count();
            return outcome;
        }
    }
}

template <class Sample>
std::uint64_t expectedCount(const std::vector<Sample>& samples) {
    std::set<Sample> values; // -0 and +0 are equal to it, too
    for (const Sample sample : samples)
        if (!isMissing(sample))
            values.insert(sample);
    return values.size();
}

template <class T>
class DistinctKeysOf : public testing::Test {
protected:
    std::mt19937_64 random_{11};

    // Any bit pattern: for floats NaNs, infinities and denormals, too.
    std::vector<T> patterns(std::size_t count) {
        std::vector<T> samples(count);
        for (T& sample : samples) {
            const std::uint64_t bits = random_();
            std::memcpy(&sample, &bits, sizeof sample);
        }
        return samples;
    }
    // As in a volume: near each other, each a few times, with runs and the odd missing one.
    std::vector<T> walk(std::size_t count) {
        std::vector<T> samples;
        double at = 40.0;
        while (samples.size() < count) {
            at += static_cast<double>(random_() % 201) / 100.0 - 1.0;
            at = std::clamp(at, 0.0, 120.0);
            samples.insert(samples.end(), 1 + random_() % 3, static_cast<T>(at));
            if (std::is_floating_point_v<T> && random_() % 50 == 0)
                samples.push_back(std::numeric_limits<T>::quiet_NaN());
        }
        return samples;
    }
};

using SampleTypes = testing::Types<std::uint8_t, std::int8_t, std::uint16_t, std::int16_t, std::int32_t, float, double>;
TYPED_TEST_SUITE(DistinctKeysOf, SampleTypes);

TYPED_TEST(DistinctKeysOf, CountsNothing) {
    EXPECT_EQ(countDistinct<TypeParam>({}, kPlenty).count, 0u);
    EXPECT_EQ(countDistinct<TypeParam>({TypeParam(3)}, kPlenty).count, 1u);
}

TYPED_TEST(DistinctKeysOf, CountsAsASetDoes) {
    for (const std::size_t count : {10u, 3000u, 200000u})
        for (const auto& samples : {this->patterns(count), this->walk(count)})
            for (const int threads : {1, 4}) {
                const Outcome outcome = countDistinct(samples, kPlenty, threads);
                EXPECT_EQ(outcome.count, expectedCount(samples)) << count << " samples, " << threads << " threads";
                EXPECT_EQ(outcome.passes, 1);
            }
}

TYPED_TEST(DistinctKeysOf, CountsTheEndsOfTheRange) {
    using Limits = std::numeric_limits<TypeParam>;
    EXPECT_EQ(countDistinct<TypeParam>(
                  {Limits::lowest(), Limits::max(), Limits::max(), TypeParam(0), Limits::min(), Limits::lowest()}, 0)
                  .count,
              std::set<TypeParam>({Limits::lowest(), Limits::max(), TypeParam(0), Limits::min()}).size());
}

TYPED_TEST(DistinctKeysOf, NeedsNoMoreThanOnePassForFewValues) {
    const auto samples = this->walk(300000);
    std::vector<TypeParam> whole; // some hundred values
    for (const TypeParam sample : samples)
        whole.push_back(isMissing(sample) ? sample : static_cast<TypeParam>(static_cast<int>(sample)));
    std::set<std::uint64_t> parts;
    if constexpr (sizeof(TypeParam) == 4)
        for (const TypeParam sample : whole)
            parts.insert(keyOf(sample) >> 20);
    const Outcome outcome = countDistinct(whole, std::max<std::uint64_t>(32, parts.size()) * kBitmapBytes, 4);
    EXPECT_EQ(outcome.count, expectedCount(whole));
    EXPECT_EQ(outcome.passes, 1);
}

template <class Float>
void expectOddFloats() {
    using Limits = std::numeric_limits<Float>;
    const Float odd[] = {
        Float(-0.0),         Float(0.0),           Limits::quiet_NaN(),   -Limits::quiet_NaN(),   Limits::infinity(),
        -Limits::infinity(), Limits::denorm_min(), -Limits::denorm_min(), Limits::signaling_NaN()};
    std::vector<Float> samples(odd, odd + std::size(odd));
    EXPECT_EQ(countDistinct(samples, kPlenty).count, 3u);
    EXPECT_EQ(countDistinct(samples, 0).count, 3u);
    EXPECT_EQ(countDistinct<Float>({Limits::quiet_NaN(), Limits::infinity()}, kPlenty).count, 0u);
    EXPECT_EQ(countDistinct<Float>({Float(-0.0)}, kPlenty).count, 1u);
}

TEST(DistinctKeys, TakesBothZerosForOneAndLeavesOutWhatIsMissing) {
    expectOddFloats<float>();
    expectOddFloats<double>();
}

// Each bitmap holds one of 60 parts of the range.
TEST(DistinctKeys, CountsInAsManyPassesAsTheBoundAsksFor) {
    std::mt19937_64 random(3);
    std::vector<std::int32_t> samples(100000);
    for (std::int32_t& sample : samples)
        sample = static_cast<std::int32_t>(random() % (60 << 20)) - (30 << 20);
    const std::uint64_t expected = expectedCount(samples);
    for (const std::uint64_t bitmaps : {0, 8, 20, 59, 60, 120}) {
        const Outcome alone = countDistinct(samples, bitmaps * kBitmapBytes);
        EXPECT_EQ(alone.count, expected) << bitmaps;
        EXPECT_EQ(alone.passes,
                  static_cast<int>((59 + std::max<std::uint64_t>(bitmaps, 8)) / std::max<std::uint64_t>(bitmaps, 8)))
            << bitmaps;
        const Outcome together = countDistinct(samples, bitmaps * kBitmapBytes, 4);
        EXPECT_EQ(together.count, expected) << bitmaps;
        EXPECT_GE(together.passes, alone.passes) << bitmaps;
        EXPECT_LE(together.passes, 60) << bitmaps;
    }
}

TEST(DistinctKeys, CountsFloatsOfAllMagnitudesInManyPasses) {
    std::mt19937_64 random(5);
    std::vector<float> samples(150000);
    for (float& sample : samples)
        sample = std::bit_cast<float>(static_cast<std::uint32_t>(random() & 0xff0fffffu));
    const Outcome outcome = countDistinct(samples, 60 * kBitmapBytes, 4);
    EXPECT_EQ(outcome.count, expectedCount(samples));
    EXPECT_GE(outcome.passes, 5);
}

// At least 1 MB, that is 131072 keys.
TEST(DistinctKeys, CountsDoublesInManyPasses) {
    std::mt19937_64 random(6);
    std::vector<double> samples(600000);
    for (double& sample : samples)
        sample = std::ldexp(static_cast<double>(random() % 900000) - 4.5e5, static_cast<int>(random() % 2));
    const std::uint64_t expected = expectedCount(samples);
    ASSERT_GT(expected, 3u * 131072u);
    for (const int threads : {1, 4}) {
        const Outcome outcome = countDistinct(samples, 0, threads);
        EXPECT_EQ(outcome.count, expected);
        EXPECT_GT(outcome.passes, 3);
        EXPECT_LT(outcome.passes, 17);
    }
    const Outcome halved = countDistinct(samples, std::uint64_t{3} << 20, 4);
    EXPECT_EQ(halved.count, expected);
    EXPECT_GT(halved.passes, 1);
    EXPECT_LT(halved.passes, 5);
}

// What the threads hold before any list is full exceeds the bound, and all comes at once when room is made.
TEST(DistinctKeys, BearsManyThreadsUnderATightBound) {
    constexpr int kThreads = 24, kEach = 20000, kMore = 200000;
    DistinctKeys<double> distinct(0);
    for (bool isComplete = false; !isComplete; isComplete = distinct.endPass()) {
        std::barrier all(kThreads);
        std::vector<std::jthread> running;
        for (int t = 0; t < kThreads; ++t)
            running.emplace_back([&, t] {
                const int begin = t * kEach;
                std::vector<double> samples(kEach + (t == 0 ? kMore : 0));
                std::iota(samples.begin(), samples.end(), 0.5 + (t == 0 ? -kMore : begin));
                distinct.add(std::span<const double>(samples).first(kEach));
                all.arrive_and_wait();
                distinct.add(std::span<const double>(samples).subspan(kEach));
            });
        running.clear();
    }
    EXPECT_EQ(distinct.count(), static_cast<std::uint64_t>(kThreads * kEach + kMore));
}

// Twenty times as many samples as find room, but they are cut to the distinct ones in time.
TEST(DistinctKeys, KeepsRepeatedDoublesInOnePass) {
    std::mt19937_64 random(8);
    std::vector<double> samples(2600000);
    for (double& sample : samples)
        sample = 0.1 * static_cast<double>(random() % 30000);
    for (const int threads : {1, 4}) {
        const Outcome outcome = countDistinct(samples, 0, threads);
        EXPECT_EQ(outcome.count, 30000u);
        EXPECT_EQ(outcome.passes, 1);
    }
}

} // namespace
} // namespace isoslider
