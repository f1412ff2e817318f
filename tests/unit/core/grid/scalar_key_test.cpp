#include "core/grid/scalar_key.h"

#include <cfloat>
#include <vector>

#include <gtest/gtest.h>

#include "core/grid/classification.h"

namespace isoslider {
namespace {

template <class Sample>
class ScalarKey : public testing::Test {};

using SampleTypes = testing::Types<std::uint8_t, std::int8_t, std::uint16_t, std::int16_t, std::int32_t, float, double>;
TYPED_TEST_SUITE(ScalarKey, SampleTypes);

// Samples in ascending order, the awkward ones among them.
template <class Sample>
std::vector<Sample> orderedSamples() {
    using Limits = std::numeric_limits<Sample>;
    std::vector<Sample> samples;
    if constexpr (std::is_floating_point_v<Sample>) {
        const Sample d = Limits::denorm_min();
        samples = {Limits::lowest(),
                   std::nextafter(Limits::lowest(), Sample(0)),
                   -1.5f,
                   -1,
                   -Limits::min(),
                   -2 * d,
                   -d,
                   0,
                   d,
                   2 * d,
                   Limits::min(),
                   std::nextafter(Limits::min(), Sample(1)),
                   Sample(0.1),
                   1,
                   std::nextafter(Sample(1), Sample(2)),
                   3,
                   std::nextafter(Limits::max(), Sample(0)),
                   Limits::max()};
    } else if constexpr (sizeof(Sample) <= 2) {
        for (std::int64_t v = Limits::min(); v <= Limits::max(); ++v)
            samples.push_back(static_cast<Sample>(v));
    } else {
        samples = {Limits::min(), Limits::min() + 1, -70000, -2, -1, 0, 1, 2, 70000, Limits::max() - 1, Limits::max()};
    }
    return samples;
}

TYPED_TEST(ScalarKey, KeepsOrderAndHasAnInverse) {
    const auto samples = orderedSamples<TypeParam>();
    for (std::size_t i = 0; i < samples.size(); ++i) {
        ASSERT_EQ(sampleOfKey<TypeParam>(keyOf(samples[i])), samples[i]) << i;
        if (i > 0) {
            ASSERT_LT(keyOf(samples[i - 1]), keyOf(samples[i])) << i;
        }
    }
}

// The rule for ties, for every pair of sample and isovalue: above when scalar >= isovalue.
TYPED_TEST(ScalarKey, ThresholdClassifiesAsTheSignConventionSays) {
    const auto all = orderedSamples<TypeParam>();
    std::vector<TypeParam> samples;
    for (std::size_t i = 0; i < all.size(); ++i) { // of 65536, those near both ends and the middle
        const std::size_t fromMiddle = i > all.size() / 2 ? i - all.size() / 2 : all.size() / 2 - i;
        if (all.size() < 600 || i < 40 || i + 40 >= all.size() || fromMiddle < 40)
            samples.push_back(all[i]);
    }
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    std::vector<double> isovalues = {-kInfinity, -DBL_MAX, -1e300,  -3e9, -0.0,  0.0,     0.5,
                                     -0.5,       1e-320,   -1e-320, 3e9,  1e300, DBL_MAX, kInfinity};
    for (const TypeParam sample : samples) {
        const double value = static_cast<double>(sample);
        isovalues.insert(isovalues.end(), {value, std::nextafter(value, kInfinity), std::nextafter(value, -kInfinity)});
    }
    for (const double isovalue : isovalues) {
        const KeyThreshold threshold = thresholdOf<TypeParam>(isovalue);
        for (const TypeParam sample : samples)
            ASSERT_EQ(keyOf(sample) >= threshold, isAbove(sample, isovalue)) << +sample << " at isovalue " << isovalue;
    }
}

TYPED_TEST(ScalarKey, ThresholdsNeverFallAsIsovaluesRise) {
    KeyThreshold before = 0;
    for (double isovalue = -70000.25; isovalue < 70000.0; isovalue += 13.375) {
        const KeyThreshold threshold = thresholdOf<TypeParam>(isovalue);
        ASSERT_GE(threshold, before) << isovalue;
        before = threshold;
    }
}

TEST(ScalarKeyFacts, ZerosAreOneKey) {
    EXPECT_EQ(keyOf(-0.0f), keyOf(0.0f));
    EXPECT_EQ(keyOf(-0.0), keyOf(0.0));
    EXPECT_EQ(thresholdOf<float>(-0.0), thresholdOf<float>(0.0));
    EXPECT_EQ(thresholdOf<double>(-0.0), thresholdOf<double>(0.0));
    EXPECT_FALSE(std::signbit(sampleOfKey<float>(keyOf(-0.0f))));
}

TEST(ScalarKeyFacts, HasTheWidthThatTheFormatSays) {
    EXPECT_EQ(sizeof(KeyOf<std::uint8_t>), 2u);
    EXPECT_EQ(sizeof(KeyOf<std::int16_t>), 2u);
    EXPECT_EQ(sizeof(KeyOf<std::int32_t>), 4u);
    EXPECT_EQ(sizeof(KeyOf<float>), 4u);
    EXPECT_EQ(sizeof(KeyOf<double>), 8u);
    EXPECT_EQ(keyOf(std::uint8_t{7}), 7u);
    EXPECT_EQ(keyOf(std::int8_t{-128}), 0u);
    EXPECT_EQ(keyOf(1.0f), 0xbf800000u);
    EXPECT_EQ(keyOf(-1.0f), 0x407fffffu);
}

} // namespace
} // namespace isoslider
