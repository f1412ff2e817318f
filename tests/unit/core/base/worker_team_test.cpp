#include "core/base/worker_team.h"

#include <algorithm>
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

#if defined(__linux__)
#include <pthread.h>
#include <sched.h>
#endif

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

#if defined(__linux__)
// How long after the start of a loop another thread takes a piece of it, at most `longest`; and whether it may run
// wherever the caller may.
struct Help {
    std::chrono::duration<double> after;
    bool runsAnywhere = true;
};
Help helpInALoop(std::chrono::duration<double> longest) {
    using Clock = std::chrono::steady_clock;
    const auto processors = [] {
        cpu_set_t set;
        CPU_ZERO(&set);
        EXPECT_EQ(pthread_getaffinity_np(pthread_self(), sizeof set, &set), 0);
        return set;
    };
    const std::thread::id caller = std::this_thread::get_id();
    const cpu_set_t allowed = processors();
    std::atomic<bool> hasHelp{false};
    Help help{longest};
    const auto start = Clock::now();
    forEachIndex(2, 1, [&](std::size_t) {
        if (std::this_thread::get_id() != caller) {
            const cpu_set_t own = processors();
            help = {Clock::now() - start, CPU_EQUAL(&own, &allowed) != 0};
            hasHelp = true;
        } else {
            while (!hasHelp && Clock::now() - start < longest) {}
        }
    });
    return help;
}

// As when a handle moves on after a pause. The best of many, since other programs may have the processors.
TEST(WorkerTeam, IsThereAtOnceAfterAPause) {
    if (std::thread::hardware_concurrency() < 2)
        GTEST_SKIP() << "one processor";
    std::vector<double> after;
    for (int round = 0; round < 41; ++round) {
        std::this_thread::sleep_for(20ms); // longer than workers wait without sleeping
        const Help help = helpInALoop(1s);
        EXPECT_TRUE(help.runsAnywhere);
        after.push_back(help.after.count());
    }
    std::sort(after.begin(), after.end());
    EXPECT_LT(after[after.size() / 4], 0.7e-3) << "seconds";
}
#endif

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
