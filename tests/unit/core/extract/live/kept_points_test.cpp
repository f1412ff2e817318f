#include "core/extract/live/kept_points.h"

#include <algorithm>
#include <list>
#include <random>
#include <utility>

#include <gtest/gtest.h>

namespace isoslider::extract {
namespace {

// Against a plain list of bricks, the one that left last in front.
TEST(KeptPoints, GivesUpWhatLeftFirst) {
    std::mt19937 random(3);
    constexpr std::uint32_t kBricks = 60;
    KeptPoints kept(kBricks);
    std::size_t bound = 17;
    kept.setBound(bound);
    std::list<std::pair<std::uint32_t, std::uint32_t>> expected; // brick, begin of its run
    std::uint32_t next = 1;
    for (int step = 0; step < 20000; ++step) {
        const std::uint32_t brick = random() % kBricks;
        const auto at = std::find_if(expected.begin(), expected.end(), [&](const auto& e) { return e.first == brick; });
        if (step % 5000 == 4999) {
            kept.clear();
            expected.clear();
        } else if (step % 50 == 0) {
            bound = 10 + random() % 10;
            kept.setBound(bound);
            while (kept.count() > bound) {
                ASSERT_EQ(kept.giveUp().begin, expected.back().second);
                expected.pop_back();
            }
        } else if (at != expected.end() || random() % 3 == 0) {
            const auto taken = kept.take(BrickIndex{brick});
            ASSERT_EQ(taken.has_value(), at != expected.end());
            if (taken) {
                ASSERT_EQ(taken->run.begin, at->second);
                ASSERT_EQ(taken->version, at->second + 5);
                expected.erase(at);
            }
        } else {
            const auto givenUp = kept.put(BrickIndex{brick}, {{next, 48}, next + 5});
            ASSERT_EQ(givenUp.has_value(), expected.size() == bound);
            if (givenUp) {
                ASSERT_EQ(givenUp->begin, expected.back().second);
                expected.pop_back();
            }
            expected.emplace_front(brick, next++);
        }
        ASSERT_EQ(kept.count(), expected.size());
        if (step % 100 == 0) {
            std::vector<std::uint32_t> runs, expectedRuns;
            kept.forEach([&](const KeptPoints::Kept& each) { runs.push_back(each.run.begin); });
            for (const auto& [its, begin] : expected)
                expectedRuns.push_back(begin);
            std::sort(runs.begin(), runs.end());
            std::sort(expectedRuns.begin(), expectedRuns.end());
            ASSERT_EQ(runs, expectedRuns);
        }
    }
}

} // namespace
} // namespace isoslider::extract
