#include "core/base/shared_progress.h"

#include <atomic>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace isoslider {
namespace {

TEST(SharedProgress, NeverOverlapsOrGoesBackAndReportsAHundredTimesAtMost) {
    std::vector<double> reported;
    std::atomic<bool> isInside{false}, hasOverlapped{false};
    JobControl job;
    job.progress = [&](double fraction, std::string_view stage) {
        hasOverlapped = hasOverlapped || isInside.exchange(true);
        EXPECT_EQ(stage, "sorting");
        reported.push_back(fraction);
        isInside = false;
    };
    constexpr std::size_t kThreads = 4, kEach = 30'000;
    SharedProgress progress(job, kThreads * kEach, "sorting");
    {
        std::vector<std::jthread> threads;
        for (std::size_t thread = 0; thread < kThreads; ++thread)
            threads.emplace_back([&] {
                for (std::size_t k = 0; k < kEach; ++k)
                    progress.add(1);
            });
    }
    EXPECT_FALSE(hasOverlapped);
    EXPECT_LE(reported.size(), 101u);
    ASSERT_GT(reported.size(), 3u);
    for (std::size_t k = 1; k < reported.size(); ++k)
        EXPECT_GT(reported[k], reported[k - 1]);
    EXPECT_LE(reported.back(), 1.0);
}

TEST(SharedProgress, OfLittleWorkReportsEachStep) {
    std::vector<double> reported;
    JobControl job;
    job.progress = [&](double fraction, std::string_view) { reported.push_back(fraction); };
    SharedProgress progress(job, 4, "");
    for (int k = 0; k < 4; ++k)
        progress.add(1);
    EXPECT_EQ(reported, (std::vector<double>{0.25, 0.5, 0.75, 1.0}));
    SharedProgress(job, 0, "").add(0);
    EXPECT_EQ(reported.size(), 4u);
}

} // namespace
} // namespace isoslider
