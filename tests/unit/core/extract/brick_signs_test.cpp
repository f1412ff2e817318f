#include "core/extract/brick_signs.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <memory>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "core/grid/classification.h"

namespace isoslider::extract {
namespace {

template <class Sample>
struct Kinds {
    using Limits = std::numeric_limits<Sample>;
    static std::vector<Sample> odd() {
        std::vector<Sample> odd{Limits::lowest(), Limits::max(), Sample(0), static_cast<Sample>(Limits::lowest() + 1),
                                static_cast<Sample>(Limits::max() - 1)};
        if constexpr (std::is_floating_point_v<Sample>)
            odd.insert(odd.end(), {Sample(-0.0), Limits::denorm_min(), -Limits::denorm_min()});
        return odd;
    }
    static std::vector<Sample> missing() {
        if constexpr (std::is_floating_point_v<Sample>)
            return {Limits::quiet_NaN(), -Limits::quiet_NaN(), Limits::infinity(), -Limits::infinity()};
        else
            return {};
    }
};

template <class Sample>
Sample anySample(std::mt19937_64& random) {
    if constexpr (std::is_floating_point_v<Sample>)
        return std::bit_cast<Sample>(static_cast<KeyOf<Sample>>(random()));
    else
        return static_cast<Sample>(random());
}

// Few different values or many, near each other or anywhere, with or without missing ones.
template <class Sample>
void fill(SampleBlock<Sample>& block, std::mt19937_64& random) {
    const Sample base = static_cast<Sample>(static_cast<int>(random() % 200) - 100);
    const bool isRough = random() % 3 == 0;
    const unsigned oddShare = random() % 2 ? 1000 : 20, missingShare = random() % 2 ? 0 : 300;
    const auto odd = Kinds<Sample>::odd(), missing = Kinds<Sample>::missing();
    for (int z = -1; z < 10; ++z)
        for (int y = -1; y < 10; ++y)
            for (int x = -1; x < 15; ++x) {
                Sample& sample = block.samples[static_cast<std::size_t>(block.offset(x, y, z))];
                do
                    sample = isRough ? anySample<Sample>(random)
                                     : static_cast<Sample>(base + static_cast<Sample>(random() % 20));
                while (isMissing(sample));
                if (random() % oddShare == 0)
                    sample = odd[random() % odd.size()];
                const bool isOutside = !block.isInside(x, y, z) || std::max({x, y, z}) > 8 || std::min({x, y, z}) < 0;
                const bool isMade = missingShare != 0 && random() % missingShare == 0;
                if (!missing.empty() && (isMade || (isOutside && random() % 4 == 0)))
                    sample = missing[random() % missing.size()];
            }
}

// Words with the bits of the points that have a sign.
template <class Sample>
SignWords finitePoints(const SampleBlock<Sample>& block) {
    return findBrickSignsPlainly(block, 0, 0).to;
}

template <class Words>
void expectEqual(const Words& found, const Words& expected, const Words& mask) {
    for (std::size_t z = 0; z < expected.size(); ++z)
        EXPECT_EQ(found[z] & mask[z], expected[z]) << "plane " << z;
}

void expectEqual(const SignWords& found, const SignWords& expected, const SignWords& mask) {
    expectEqual(found.here, expected.here, mask.here);
    expectEqual(found.right, expected.right, mask.right);
    expectEqual(found.behind, expected.behind, mask.behind);
}

// Samples of the block, what lies between them, and both ends.
template <class Sample>
KeyThreshold anyThreshold(const SampleBlock<Sample>& block, std::mt19937_64& random) {
    const auto greatest = KeyThreshold{std::numeric_limits<KeyOf<Sample>>::max()};
    switch (random() % 12) {
        case 0: return 0;
        case 1: return KeyThreshold{keyOf(std::numeric_limits<Sample>::max())} + 1 + random() % 3;
        case 2: return greatest;
        case 3: return sizeof(Sample) == 8 ? greatest : greatest + 1 + random() % 3;
        case 4: return KeyThreshold{keyOf(Sample(0))} - random() % 2;
        case 5: return random() % (sizeof(Sample) == 8 ? greatest : greatest + 1);
        default: break;
    }
    const auto at = [&] { return static_cast<int>(random() % 9); };
    const Sample sample = block.samples[static_cast<std::size_t>(block.offset(at(), at(), at()))];
    return isMissing(sample) ? 1 : KeyThreshold{keyOf(sample)} + random() % 2;
}

template <class Sample>
class BrickSignsTest : public testing::Test {};
using Samples = testing::Types<std::uint8_t, std::int8_t, std::uint16_t, std::int16_t, std::int32_t, float, double>;
TYPED_TEST_SUITE(BrickSignsTest, Samples);

TYPED_TEST(BrickSignsTest, AgreesWithThePlainOneOnBoxesOfAllSizes) {
    std::mt19937_64 random(5);
    const auto block = std::make_unique<SampleBlock<TypeParam>>();
    for (int round = 0; round < 3000; ++round) {
        SCOPED_TRACE(round);
        for (std::size_t a = 0; a < 3; ++a) {
            block->begin[a] = random() % 2 ? -1 : 0;
            block->end[a] = random() % 2 ? 10 : 1 + static_cast<int>(random() % 10);
        }
        fill(*block, random);
        const KeyThreshold from = anyThreshold(*block, random), to = anyThreshold(*block, random);
        const BrickSigns found = findBrickSigns(*block, from, to), expected = findBrickSignsPlainly(*block, from, to);
        const SignWords finite = finitePoints(*block);
        expectEqual(found.from, expected.from, finite);
        expectEqual(found.to, expected.to, finite);
        EXPECT_EQ(found.up, expected.up);
        EXPECT_EQ(found.down, expected.down);
        EXPECT_EQ(found.hasMissing, expected.hasMissing);
        if (this->HasFailure())
            FAIL() << "thresholds " << from << ", " << to << " and seed 5";
    }
}

TYPED_TEST(BrickSignsTest, KeepsNothingFromOutsideTheBox) {
    std::mt19937_64 random(6);
    const auto block = std::make_unique<SampleBlock<TypeParam>>();
    for (int round = 0; round < 300; ++round) {
        SCOPED_TRACE(round);
        for (std::size_t a = 0; a < 3; ++a)
            block->end[a] = 1 + static_cast<int>(random() % 9);
        fill(*block, random);
        const BrickSigns signs = findBrickSigns(*block, anyThreshold(*block, random), anyThreshold(*block, random));
        for (int z = 0; z < 9; ++z)
            for (int y = 0; y < 8; ++y)
                for (int x = 0; x < 8; ++x) {
                    const auto word = static_cast<std::size_t>(z);
                    const auto bit = [&](const auto& from, const auto& to) {
                        return ((from[word] | to[word]) >> (x + 8 * y) & 1) != 0;
                    };
                    ASSERT_TRUE(block->isInside(x, y, z) || !bit(signs.from.here, signs.to.here));
                    ASSERT_TRUE(block->isInside(x + 1, y, z) || !bit(signs.from.right, signs.to.right));
                    ASSERT_TRUE(block->isInside(x, y + 1, z) || !bit(signs.from.behind, signs.to.behind));
                }
    }
}

// The plain one, from first principles: one sample stands out.
TEST(BrickSigns, FindsOneSampleWhereverItIs) {
    SampleBlock<float> block;
    block.begin = {-1, -1, -1};
    block.end = {10, 10, 10};
    for (int z = 0; z < 9; ++z)
        for (int y = 0; y < 9; ++y)
            for (int x = 0; x < 9; ++x) {
                block.samples.fill(1.0f);
                block.samples[static_cast<std::size_t>(block.offset(x, y, z))] = 3.0f;
                const BrickSigns signs = findBrickSignsPlainly(block, keyOf(4.0f), keyOf(2.0f));
                SignWords expected;
                const auto set = [z](auto& words, int column, int row) {
                    if (column >= 0 && column < 8 && row >= 0 && row < 8)
                        words[static_cast<std::size_t>(z)] |= std::uint64_t{1} << (column + 8 * row);
                };
                set(expected.here, x, y);
                set(expected.right, x - 1, y);
                set(expected.behind, x, y - 1);
                EXPECT_EQ(signs.to.here, expected.here);
                EXPECT_EQ(signs.to.right, expected.right);
                EXPECT_EQ(signs.to.behind, expected.behind);
                EXPECT_EQ(signs.from.here, SignWords{}.here);
                EXPECT_EQ(signs.up, keyOf(3.0f));
                EXPECT_EQ(signs.down, keyOf(1.0f));
            }
}

} // namespace
} // namespace isoslider::extract
