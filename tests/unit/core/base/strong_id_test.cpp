#include "core/base/strong_id.h"

#include <cstdint>
#include <type_traits>
#include <unordered_set>
#include <vector>

#include <gtest/gtest.h>

namespace isoslider {
namespace {

struct RedTag;
struct BlueTag;
using Red = StrongId<RedTag, std::uint16_t>;
using Blue = StrongId<BlueTag, std::uint16_t>;

static_assert(sizeof(Red) == sizeof(std::uint16_t) && std::is_trivially_copyable_v<Red>);
static_assert(!std::is_convertible_v<Red, Blue> && !std::is_constructible_v<Red, Blue>);
static_assert(!std::is_convertible_v<int, Red> && std::is_constructible_v<Red, int>);
static_assert(!std::is_convertible_v<Red, int>);

template <class A, class B>
concept AreComparable = requires(A a, B b) {
    a == b;
};
static_assert(AreComparable<Red, Red> && !AreComparable<Red, Blue> && !AreComparable<Red, int>);

TEST(StrongId, IsItsNumber) {
    EXPECT_EQ(Red().number(), 0);
    EXPECT_EQ(Red(7).number(), 7);
    EXPECT_EQ(Red(7).index(), std::size_t{7});
    EXPECT_EQ(static_cast<int>(Red(65535)), 65535);
    EXPECT_LT(Red(3), Red(4));
}

TEST(StrongId, HasDistances) {
    EXPECT_EQ(Red(9) - Red(4), 5);
    EXPECT_EQ(Red(4) + 5, Red(9));
    EXPECT_EQ(Red(4) + (-2), Red(2));
    EXPECT_EQ(Red(9) - std::int64_t{5}, Red(4));
    Red red(1);
    EXPECT_EQ(++red, Red(2));
    EXPECT_EQ(--red, Red(1));
}

TEST(StrongId, CountsInLoopsAndSets) {
    std::vector<Red> all;
    for (const Red red : firstIds<Red>(3))
        all.push_back(red);
    EXPECT_EQ(all, (std::vector<Red>{Red(0), Red(1), Red(2)}));
    for (const Red red : firstIds<Red>(0))
        ADD_FAILURE() << red.number();
    EXPECT_EQ(std::unordered_set<Red>(all.begin(), all.end()).size(), 3u);
}

} // namespace
} // namespace isoslider
