#include "core/index/skip_list.h"

#include <algorithm>
#include <random>
#include <set>

#include <gtest/gtest.h>

namespace isoslider::index {
namespace {

// A random index directory: pages of level 0 over random keys, levels of unions of what is below.
struct RandomDirectory {
    std::vector<std::uint64_t> keys; ///< distinct, ascending
    std::vector<LevelDirectory> levels;
};

RandomDirectory randomDirectory(std::mt19937& random) {
    RandomDirectory directory;
    std::set<std::uint64_t> keys;
    const std::size_t count = 1 + random() % 60;
    while (keys.size() < count)
        keys.insert(random() % 200);
    directory.keys.assign(keys.begin(), keys.end());

    LevelDirectory level0;
    for (std::size_t at = 0; at < count;) { // a page ends inside a key's records as often as not
        const std::size_t last = std::min<std::size_t>(count - 1, at + random() % 5);
        PageEntry page;
        page.firstKey = directory.keys[at];
        page.lastKey = directory.keys[last];
        page.edges = 1 + random() % 100;
        level0.pages.push_back(page);
        at = random() % 2 && last > at ? last : last + 1;
    }
    directory.levels.push_back(level0);

    // Blocks as runs of positions in `keys`.
    std::vector<std::size_t> ends;
    for (std::size_t i = 1; i <= count; ++i)
        ends.push_back(i);
    for (std::size_t levels = random() % 5; levels > 0 && ends.size() > 1; --levels) {
        std::vector<std::size_t> merged;
        for (std::size_t i = 0; i < ends.size();) {
            i += 2 + random() % 3;
            merged.push_back(ends[std::min(i, ends.size()) - 1]);
        }
        ends = merged;
        LevelDirectory level;
        std::size_t begin = 0;
        for (const std::size_t end : ends) {
            BlockEntry block{directory.keys[begin], directory.keys[end - 1], level.pages.size(), random() % 4};
            for (std::uint64_t p = 0; p < block.pageCount; ++p) {
                PageEntry page;
                page.firstKey = block.firstKey;
                page.lastKey = block.lastKey;
                page.edges = 1 + random() % 100;
                level.pages.push_back(page);
            }
            level.blocks.push_back(block);
            begin = end;
        }
        directory.levels.push_back(level);
    }
    return directory;
}

void expectGoodPlan(const RandomDirectory& directory, std::uint64_t lower, std::uint64_t upper,
                    const DamagedPages& damaged = {}) {
    const SkipList list(directory.levels);
    const auto segments = list.plan(lower, upper, damaged);
    bool isBlocked = false;
    for (std::size_t i = 0; i < segments.size(); ++i) {
        const WalkSegment& s = segments[i];
        ASSERT_LT(s.beginKey, s.endKey);
        ASSERT_GE(s.beginKey, lower);
        ASSERT_LE(s.endKey, upper);
        if (i > 0) {
            ASSERT_GE(s.beginKey, segments[i - 1].endKey) << "in key order, nothing twice";
        }
        const LevelDirectory& level = directory.levels[s.level.index()];
        if (s.level == kLevel0) {
            EXPECT_EQ(s.blocks, 0u);
            for (std::size_t p = 0; p < level.pages.size(); ++p) {
                const bool isNeeded = level.pages[p].lastKey >= s.beginKey && level.pages[p].firstKey < s.endKey;
                ASSERT_EQ(isNeeded, p >= s.firstPage && p < s.pageEnd) << "page " << p;
                isBlocked = isBlocked || (isNeeded && damaged.contains({kLevel0, p}));
            }
        } else { // whole blocks, their pages and no others
            std::uint64_t blocks = 0, pages = 0;
            for (const BlockEntry& block : level.blocks) {
                const bool isInside = block.firstKey >= s.beginKey && block.lastKey < s.endKey;
                ASSERT_TRUE(isInside || block.lastKey < s.beginKey || block.firstKey >= s.endKey) << "half a block";
                blocks += isInside;
                pages += isInside ? block.pageCount : 0;
                if (isInside) {
                    ASSERT_TRUE(block.firstPage >= s.firstPage && block.firstPage + block.pageCount <= s.pageEnd);
                }
            }
            EXPECT_EQ(blocks, s.blocks);
            EXPECT_EQ(pages, s.pageEnd - s.firstPage);
        }
    }
    EXPECT_EQ(list.isBlocked(lower, upper, damaged), isBlocked);
    const auto isWhole = [&](std::size_t level, const BlockEntry& block) {
        for (std::uint64_t p = block.firstPage; p < block.firstPage + block.pageCount; ++p)
            if (damaged.contains({SkipLevel(level), p}))
                return false;
        return true;
    };
    const auto levelAt = [&](std::uint64_t key) {
        int level = -1, times = 0;
        for (const WalkSegment& s : segments)
            if (key >= s.beginKey && key < s.endKey) {
                level = s.level.number();
                ++times;
            }
        EXPECT_LE(times, 1) << key;
        return level;
    };
    for (const std::uint64_t key : directory.keys) {
        int highest = key >= lower && key < upper ? 0 : -1; // the highest block around the key that fits
        for (std::size_t l = 1; l < directory.levels.size(); ++l)
            for (const BlockEntry& block : directory.levels[l].blocks)
                if (key >= block.firstKey && key <= block.lastKey && block.firstKey >= lower && block.lastKey < upper &&
                    isWhole(l, block))
                    highest = static_cast<int>(l);
        ASSERT_EQ(levelAt(key), highest) << "key " << key << " of [" << lower << ", " << upper << ")";
    }
}

TEST(SkipList, CoversEveryIntervalOnceWithTheHighestBlocks) {
    std::mt19937 random(77);
    for (int round = 0; round < 150 && !testing::Test::HasFailure(); ++round) {
        const RandomDirectory directory = randomDirectory(random);
        SCOPED_TRACE("round " + std::to_string(round));
        expectGoodPlan(directory, 0, 201);
        for (int k = 0; k < 30; ++k) {
            const std::uint64_t a = random() % 202, b = random() % 202;
            expectGoodPlan(directory, std::min(a, b), std::max(a, b));
        }
    }
}

TEST(SkipList, LeavesBlocksWithDamagedPagesToTheLevelsBelow) {
    std::mt19937 random(78);
    for (int round = 0; round < 150 && !testing::Test::HasFailure(); ++round) {
        const RandomDirectory directory = randomDirectory(random);
        SCOPED_TRACE("round " + std::to_string(round));
        for (int k = 0; k < 30; ++k) {
            DamagedPages damaged;
            for (unsigned count = random() % 6; count > 0; --count) {
                const std::size_t level = random() % directory.levels.size();
                if (const std::size_t pages = directory.levels[level].pages.size(); pages > 0)
                    damaged.emplace(SkipLevel(level), random() % pages);
            }
            const std::uint64_t a = random() % 202, b = random() % 202;
            expectGoodPlan(directory, std::min(a, b), std::max(a, b), damaged);
        }
    }
}

TEST(SkipList, PlansNothingForAnEmptyInterval) {
    std::mt19937 random(3);
    const RandomDirectory directory = randomDirectory(random);
    const SkipList list(directory.levels);
    EXPECT_TRUE(list.plan(50, 50).empty());
    EXPECT_TRUE(list.plan(60, 50).empty());
    EXPECT_EQ(list.estimateEdges(50, 50), 0u);
}

TEST(SkipList, EstimatesTheEdgesOfWhatItPlans) {
    std::mt19937 random(8);
    for (int round = 0; round < 50; ++round) {
        const RandomDirectory directory = randomDirectory(random);
        const SkipList list(directory.levels);
        std::uint64_t all = 0;
        for (const WalkSegment& s : list.plan(0, 300))
            for (std::size_t p = s.firstPage; p < s.pageEnd; ++p)
                all += list.page(s.level, p).edges;
        EXPECT_NEAR(static_cast<double>(list.estimateEdges(0, 300)), static_cast<double>(all), 1.0);
        // A part never costs more than the whole of its pages at level 0.
        const SkipList plain(std::span(directory.levels).first(1));
        for (int k = 0; k < 10; ++k) {
            const std::uint64_t a = random() % 200, b = a + random() % 50;
            std::uint64_t most = 0;
            for (const WalkSegment& s : plain.plan(a, b))
                for (std::size_t p = s.firstPage; p < s.pageEnd; ++p)
                    most += plain.page(kLevel0, p).edges;
            EXPECT_LE(plain.estimateEdges(a, b), most);
        }
    }
}

} // namespace
} // namespace isoslider::index
