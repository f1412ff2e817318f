#include "preprocess/levels/block_intervals.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <random>

#include <gtest/gtest.h>

namespace isoslider::preprocess {
namespace {

std::vector<KeyCount> randomCounts(std::mt19937& random, std::size_t keys) {
    std::map<std::uint64_t, std::uint64_t> points;
    while (points.size() < keys)
        points[std::uint64_t{random()} << (random() % 32)] += 1 + random() % 50;
    std::vector<KeyCount> counts;
    for (const auto& [key, count] : points)
        counts.push_back({key, count});
    return counts;
}

TEST(SpanBins, AreOnePerValueWhereTheseAreFew) {
    std::mt19937 random(1);
    const auto counts = randomCounts(random, 300);
    const KeyIntervals bins = makeSpanBins(counts);
    ASSERT_EQ(bins.count(), counts.size());
    for (std::size_t i = 0; i < counts.size(); ++i)
        EXPECT_EQ(bins.find(counts[i].key), i);
}

TEST(SpanBins, ShareThePointsWhereValuesAreMany) {
    std::mt19937 random(2);
    const auto counts = randomCounts(random, 30000);
    std::uint64_t total = 0, most = 0;
    for (const KeyCount& count : counts) {
        total += count.points;
        most = std::max(most, count.points);
    }
    const KeyIntervals bins = makeSpanBins(counts);
    EXPECT_LE(bins.count(), static_cast<std::size_t>(kMaxSpanBins));
    EXPECT_GT(bins.count(), static_cast<std::size_t>(kMaxSpanBins) / 2);
    std::vector<std::uint64_t> points(bins.count(), 0);
    for (const KeyCount& count : counts)
        points[bins.find(count.key)] += count.points;
    for (const std::uint64_t p : points)
        EXPECT_LE(p, total / kMaxSpanBins + 1 + most);
}

// Random edges over a few values, kept so that everything can be counted again.
struct Edges {
    explicit Edges(std::mt19937& random, std::size_t bins) : histogram(bins) {
        for (std::size_t i = 0; i < 40 * bins; ++i) {
            const auto a = static_cast<std::size_t>(random() % bins);
            const auto b = static_cast<std::size_t>(std::min<std::size_t>(bins - 1, a + random() % (1 + bins / 8)));
            histogram.add(a, b);
            list.emplace_back(a, b);
        }
    }
    std::uint64_t inside(std::uint64_t begin, std::uint64_t end) const {
        return static_cast<std::uint64_t>(
            std::count_if(list.begin(), list.end(), [&](auto& e) { return e.first >= begin && e.second < end; }));
    }
    std::uint64_t activeAt(std::uint64_t at) const {
        return static_cast<std::uint64_t>(
            std::count_if(list.begin(), list.end(), [&](auto& e) { return e.first < at && e.second >= at; }));
    }
    std::vector<std::pair<std::uint64_t, std::uint64_t>> list;
    SpanHistogram histogram;
    KeyIntervals spanBins = upTo(histogram.bins());

    static KeyIntervals upTo(std::size_t bins) {
        std::vector<std::uint64_t> begins(bins);
        std::iota(begins.begin(), begins.end(), 0u);
        return KeyIntervals(std::move(begins));
    }
};

// Block begins of each level, closed by the end; level 0 is every bin on its own.
std::vector<std::vector<std::uint64_t>> closedLevels(const Edges& edges, int skipLevels, double k) {
    std::vector<std::vector<std::uint64_t>> levels = chooseBlockBegins(edges.histogram, edges.spanBins, skipLevels, k);
    levels.emplace(levels.begin(), edges.spanBins.count());
    std::iota(levels.front().begin(), levels.front().end(), 0u);
    for (auto& level : levels)
        level.push_back(edges.spanBins.count());
    return levels;
}

TEST(BlockIntervals, AreUnionsOfAtLeastTwoBlocksBelow) {
    std::mt19937 random(3);
    for (int round = 0; round < 60; ++round) {
        const Edges edges(random, 1 + random() % 90);
        const int skipLevels = 1 + static_cast<int>(random() % 8);
        const auto levels = closedLevels(edges, skipLevels, 0.01 * static_cast<double>(1 + random() % 300));
        ASSERT_LE(levels.size(), static_cast<std::size_t>(skipLevels));
        for (std::size_t l = 1; l < levels.size(); ++l) {
            ASSERT_EQ(levels[l].front(), 0u);
            ASSERT_GT(levels[l].size(), 2u) << "one block over everything holds nothing";
            for (std::size_t i = 0; i + 1 < levels[l].size(); ++i) {
                const auto begin = std::find(levels[l - 1].begin(), levels[l - 1].end(), levels[l][i]);
                const auto end = std::find(levels[l - 1].begin(), levels[l - 1].end(), levels[l][i + 1]);
                ASSERT_TRUE(begin != levels[l - 1].end() && end != levels[l - 1].end())
                    << "cuts a block of the level below";
                ASSERT_GE(end - begin, 2);
            }
        }
    }
}

// PAPER 2.1: a block ends when its redundant edges, those that the level below still had, exceed k
// times the active edges.
TEST(BlockIntervals, EndWhereRedundantEdgesExceedTheThreshold) {
    std::mt19937 random(4);
    int longBlocks = 0;
    for (int round = 0; round < 40; ++round) {
        const Edges edges(random, 20 + random() % 60);
        const double k = 0.02 * static_cast<double>(1 + random() % 100);
        const auto levels = closedLevels(edges, 4, k);
        for (std::size_t l = 1; l < levels.size(); ++l)
            for (std::size_t i = 0; i + 2 < levels[l].size(); ++i) { // the last one may be longer
                const auto first = std::find(levels[l - 1].begin(), levels[l - 1].end(), levels[l][i]);
                const auto exceeds = [&](auto end) {
                    std::uint64_t redundant = edges.inside(*first, *end);
                    for (auto sub = first; l > 1 && sub != end; ++sub)
                        redundant -= edges.inside(*sub, *(sub + 1));
                    return static_cast<double>(redundant) > k * static_cast<double>(edges.activeAt(*end));
                };
                const auto end = std::find(levels[l - 1].begin(), levels[l - 1].end(), levels[l][i + 1]);
                ASSERT_TRUE(exceeds(end)) << "ended too early";
                for (auto sooner = first + 2; sooner != end; ++sooner)
                    ASSERT_FALSE(exceeds(sooner)) << "should have ended before";
                longBlocks += end - first > 2;
            }
    }
    EXPECT_GT(longBlocks, 100);
}

TEST(BlockIntervals, LargerThresholdsGiveFewerBlocks) {
    std::mt19937 random(5);
    const Edges edges(random, 80);
    const auto blocks = [&](double k) {
        const auto levels = chooseBlockBegins(edges.histogram, edges.spanBins, 2, k);
        return levels.empty() ? std::size_t{1} : levels[0].size();
    };
    EXPECT_GT(blocks(0.01), blocks(0.5));
    EXPECT_GT(blocks(0.5), blocks(3.0));
    EXPECT_EQ(blocks(1e9), 1u);
}

TEST(SpanHistogram, Merges) {
    SpanHistogram a(3), b(3);
    a.add(0, 2);
    b.add(0, 2);
    b.add(1, 1);
    a.merge(b);
    EXPECT_EQ(a.at(0, 2), 2u);
    EXPECT_EQ(a.at(1, 1), 1u);
    EXPECT_EQ(a.at(2, 0), 0u);
}

} // namespace
} // namespace isoslider::preprocess
