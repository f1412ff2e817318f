#include "core/extract/run_allocator.h"

#include <map>
#include <new>
#include <random>

#include <gtest/gtest.h>

namespace isoslider::extract {
namespace {

TEST(RunAllocator, NeverHandsOutWhatIsInUse) {
    RunAllocator allocator(16, 1u << 20);
    std::mt19937 random(6);
    std::map<std::uint32_t, std::uint32_t> inUse; // begin, count asked for
    for (int round = 0; round < 5000; ++round) {
        if (!inUse.empty() && random() % 2) {
            const auto victim = std::next(inUse.begin(), static_cast<std::ptrdiff_t>(random() % inUse.size()));
            allocator.free(victim->first, victim->second);
            inUse.erase(victim);
            continue;
        }
        const std::uint32_t count = 1 + random() % 300;
        const std::uint32_t begin = allocator.allocate(count);
        ASSERT_EQ(begin % 16, 0u);
        const auto next = inUse.lower_bound(begin);
        if (next != inUse.end()) {
            ASSERT_LE(begin + allocator.roundUp(count), next->first);
        }
        if (next != inUse.begin()) {
            const auto before = std::prev(next);
            ASSERT_LE(before->first + allocator.roundUp(before->second), begin);
        }
        ASSERT_LE(begin + allocator.roundUp(count), allocator.top());
        inUse.emplace(begin, count);
    }
}

TEST(RunAllocator, ReusesFreedRunsOfTheSameSize) {
    RunAllocator allocator(16, 1u << 20);
    const std::uint32_t a = allocator.allocate(40);
    allocator.allocate(40);
    const std::uint64_t top = allocator.top();
    allocator.free(a, 40);
    EXPECT_EQ(allocator.allocate(33), a) << "33 and 40 both round up to 48";
    EXPECT_EQ(allocator.top(), top);
}

TEST(RunAllocator, StopsAtItsLimit) {
    RunAllocator allocator(16, 64);
    EXPECT_EQ(allocator.allocate(48), 0u);
    EXPECT_THROW(allocator.allocate(17), std::bad_alloc);
    EXPECT_EQ(allocator.allocate(16), 48u);
    allocator.clear();
    EXPECT_EQ(allocator.top(), 0u);
    EXPECT_EQ(allocator.allocate(64), 0u);
}

} // namespace
} // namespace isoslider::extract
