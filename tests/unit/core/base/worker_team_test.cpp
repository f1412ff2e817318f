#include "core/base/worker_team.h"

#include <atomic>
#include <chrono>
#include <mutex>
#include <new>
#include <numeric>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

namespace isoslider {
namespace {

using namespace std::chrono_literals;

// What takes part in a loop that lasts long enough for all to come.
std::size_t threadsOfALoop() {
    std::mutex mutex;
    std::set<std::thread::id> seen;
    forEachIndex(64, 1, [&](std::size_t) {
        std::this_thread::sleep_for(1ms);
        const std::lock_guard lock(mutex);
        seen.insert(std::this_thread::get_id());
    });
    return seen.size();
}

TEST(WorkerTeam, TakesEachElementOnce) {
    for (const std::size_t count : {0u, 1u, 2u, 15u, 16u, 17u, 1000u, 100003u})
        for (const std::size_t grain : {1u, 16u, 5000u}) {
            std::vector<std::atomic<int>> taken(count);
            forRanges(count, grain, [&](std::size_t begin, std::size_t end) {
                ASSERT_LE(end - begin, grain);
                for (std::size_t i = begin; i < end; ++i)
                    ++taken[i];
            });
            for (const auto& times : taken)
                ASSERT_EQ(times, 1) << count << " by " << grain;
        }
}

TEST(WorkerTeam, KeepsNothingOfALoopThatIsOver) {
    std::uint64_t sum = 0;
    for (int loop = 0; loop < 20000; ++loop) {
        std::vector<std::uint64_t> parts(4, 0); // gone before the next loop
        forEachIndex(parts.size(), 1, [&](std::size_t i) { parts[i] = i + 1; });
        sum += std::accumulate(parts.begin(), parts.end(), std::uint64_t{0});
    }
    EXPECT_EQ(sum, 20000u * 10u);
}

TEST(WorkerTeam, UsesTheThreadsThatTbbMayUse) {
    const unsigned cores = std::thread::hardware_concurrency();
    EXPECT_LE(threadsOfALoop(), cores);
    if (cores > 1) {
        EXPECT_GT(threadsOfALoop(), 1u);
        const tbb::global_control two(tbb::global_control::max_allowed_parallelism, 2);
        EXPECT_EQ(threadsOfALoop(), 2u);
    }
    tbb::task_arena one(1);
    EXPECT_EQ(one.execute(threadsOfALoop), 1u);
    const tbb::global_control alone(tbb::global_control::max_allowed_parallelism, 1);
    EXPECT_EQ(threadsOfALoop(), 1u);
}

TEST(WorkerTeam, HandsOnWhatAPieceThrows) {
    for (int round = 0; round < 200; ++round) {
        std::atomic<int> begun{0};
        EXPECT_THROW(forEachIndex(1000, 1,
                                  [&](std::size_t i) {
                                      ++begun;
                                      if (i == 3)
                                          throw std::bad_alloc();
                                  }),
                     std::bad_alloc);
        EXPECT_GE(begun, 4);
        int after = 0;
        forEachIndex(1, 1, [&](std::size_t) { ++after; });
        EXPECT_EQ(after, 1);
    }
    EXPECT_THROW(forEachIndex(1000, 1, [](std::size_t i) { throw std::out_of_range(std::to_string(i)); }),
                 std::out_of_range);
}

TEST(WorkerTeam, LoopsMayBeNestedAndCalledFromAnyThread) {
    std::atomic<int> sum{0};
    forEachIndex(10, 1, [&](std::size_t) { forEachIndex(10, 1, [&](std::size_t) { ++sum; }); });
    EXPECT_EQ(sum, 100);
    sum = 0;
    {
        std::vector<std::jthread> callers;
        for (int caller = 0; caller < 4; ++caller)
            callers.emplace_back([&] {
                for (int loop = 0; loop < 2000; ++loop)
                    forEachIndex(8, 1, [&](std::size_t) { ++sum; });
            });
    }
    EXPECT_EQ(sum, 4 * 2000 * 8);
}

// The threads have gone to sleep meanwhile.
TEST(WorkerTeam, WakesForALoopAfterAPause) {
    if (std::thread::hardware_concurrency() < 2)
        GTEST_SKIP() << "one processor";
    for (int round = 0; round < 20; ++round) {
        std::this_thread::sleep_for(5ms);
        EXPECT_GT(threadsOfALoop(), 1u);
    }
}

} // namespace
} // namespace isoslider
