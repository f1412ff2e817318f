#include "core/base/fast_divider.h"

#include <algorithm>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace isoslider {
namespace {

TEST(FastDivider, DividesLikeADivision) {
    std::mt19937 random(7);
    std::vector<std::uint32_t> divisors{1, 2, 3, 7, 64, 4294967295u, 4294967294u, 2147483648u, 65536, 65537};
    for (int i = 0; i < 2000; ++i)
        divisors.push_back(std::max<std::uint32_t>(1, random() >> random() % 32));
    for (const std::uint32_t divisor : divisors) {
        const FastDivider fast(divisor);
        const auto compare = [&](std::uint32_t number) {
            ASSERT_EQ(fast.quotient(number), number / divisor) << number << " by " << divisor;
        };
        for (const std::uint32_t number : {0u, 1u, 4294967295u, 4294967294u})
            compare(number);
        for (int i = 0; i < 50; ++i) { // multiples and what is beside them, and anything
            const auto multiple = static_cast<std::uint32_t>(random() / divisor * std::uint64_t{divisor});
            compare(multiple);
            compare(multiple - 1);
            compare(multiple + 1);
            compare(random());
        }
    }
    EXPECT_EQ(FastDivider(0).quotient(17), 17u);
}

} // namespace
} // namespace isoslider
