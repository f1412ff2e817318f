#include "core/index/page_cache.h"

#include <algorithm>
#include <map>
#include <random>
#include <thread>

#include <gtest/gtest.h>

#include "tests/property/test_volumes.h"
#include "tests/support/forged_index.h"
#include "tests/support/result_matchers.h"
#include "tests/support/temporary_folder.h"

namespace isoslider::index {
namespace {

using test::IsOk;
using Cache = PageCache<std::uint16_t>;
using KeptPage = ChangePage<std::uint16_t>;

class PageCacheTest : public testing::Test {
protected:
    void SetUp() override {
        ASSERT_THAT(test::buildIndexOf(test::noiseVolume({70, 64, 64}, 3, 200), folder_ / "a.isx"), IsOk());
        auto opened = IndexReader::open(folder_ / "a.isx");
        ASSERT_THAT(opened, IsOk());
        reader_ = std::move(opened).value();
        Cache all(*reader_, std::uint64_t{1} << 30);
        for (std::size_t i = 0; i < pageCount(0); ++i)
            largest_ = std::max<std::uint64_t>(largest_, get(all, 0, i).page->memoryBytes());
        ASSERT_GT(pageCount(0), 40u);
    }
    std::size_t pageCount(int level) const {
        return reader_->meta().levels[static_cast<std::size_t>(level)].pages.size();
    }
    static Cache::Lookup get(Cache& cache, int level, std::size_t page) {
        auto found = cache.get(SkipLevel(level), page);
        EXPECT_THAT(found, IsOk());
        return found.isOk() ? std::move(found).value() : Cache::Lookup{std::make_shared<KeptPage>(), 0};
    }
    bool isKept(Cache& cache, std::size_t page) const { return get(cache, 0, page).bytesRead == 0; }

    test::TemporaryFolder folder_;
    std::unique_ptr<IndexReader> reader_;
    std::uint64_t largest_ = 0; ///< memory of the largest page of level 0
};

// What is really alive is counted, not what the cache states of itself. Eight pages may wait for their memory to be
// used again.
TEST_F(PageCacheTest, KeepsWithinItsBoundWhateverIsRead) {
    constexpr std::uint64_t kSpares = 8;
    for (const std::uint64_t pages : {1, 3, 12}) {
        const std::uint64_t bound = pages * largest_;
        Cache cache(*reader_, bound);
        std::map<const KeptPage*, std::weak_ptr<const KeptPage>> handedOut;
        std::mt19937 random(5);
        std::uint64_t largest = 0;
        for (int round = 0; round < 400; ++round) {
            const int level = static_cast<int>(random() % reader_->meta().levels.size());
            {
                const auto found = get(cache, level, random() % pageCount(level));
                largest = std::max<std::uint64_t>(largest, found.page->memoryBytes());
                handedOut[found.page.get()] = found.page;
            }
            std::uint64_t alive = 0;
            for (const auto& [address, page] : handedOut)
                if (const auto held = page.lock())
                    alive += held->memoryBytes();
            ASSERT_LE(alive, bound + kSpares * largest) << "round " << round;
            ASSERT_LE(cache.memoryBytes(), bound);
        }
        EXPECT_GT(cache.memoryBytes(), 0u);
    }
}

TEST_F(PageCacheTest, KeepsWhatWasUsedLast) {
    Cache cache(*reader_, 3 * largest_);
    for (const std::size_t page : {0, 1, 2, 0, 3, 0})
        get(cache, 0, page);
    EXPECT_TRUE(isKept(cache, 0));
    EXPECT_TRUE(isKept(cache, 3));
    EXPECT_FALSE(isKept(cache, 1));
    cache.clear();
    EXPECT_EQ(cache.memoryBytes(), 0u);
    EXPECT_FALSE(isKept(cache, 0));
}

TEST_F(PageCacheTest, HandsOutButDoesNotKeepAPageLargerThanTheBound) {
    Cache cache(*reader_, 100);
    for (int twice = 0; twice < 2; ++twice) {
        const auto found = get(cache, 0, 0);
        EXPECT_GT(found.bytesRead, 0u);
        EXPECT_EQ(found.page->recordCount(), 4096u);
        EXPECT_EQ(cache.memoryBytes(), 0u);
    }
}

// In either form, each kept for itself; without a way to add up, records are given.
TEST_F(PageCacheTest, GivesTotalsOfPagesThatAreTakenWhole) {
    using Form = Cache::Form;
    int sums = 0;
    Cache cache(*reader_, std::uint64_t{1} << 30, [&](const KeptPage& records, std::vector<BrickTotal>& totals) {
        ++sums;
        totals.push_back({BrickIndex(7), static_cast<std::int32_t>(records.recordCount())});
    });
    for (int round = 0; round < 2; ++round) {
        const auto whole = cache.get(kLevel0, 3, Form::Totals).value(), part = cache.get(kLevel0, 3).value();
        EXPECT_EQ(whole.bytesRead == 0, round > 0);
        EXPECT_EQ(part.bytesRead == 0, round > 0);
        ASSERT_TRUE(whole.page->hasTotals);
        ASSERT_FALSE(part.page->hasTotals);
        EXPECT_EQ(whole.page->recordCount(), 0u);
        ASSERT_EQ(whole.page->totals.size(), 1u);
        EXPECT_EQ(whole.page->totals[0].count, 4096);
        EXPECT_EQ(whole.page->entries, part.page->entries);
        EXPECT_EQ(whole.page->entries, reader_->meta().levels[0].pages[3].edges);
        std::size_t keys = 1;
        for (std::size_t i = 1; i < part.page->recordCount(); ++i)
            keys += part.page->keys[i] != part.page->keys[i - 1];
        EXPECT_EQ(whole.page->distinctKeys, keys);
        EXPECT_EQ(part.page->recordCount(), 4096u);
    }
    EXPECT_EQ(sums, 1);
    Cache plain(*reader_, std::uint64_t{1} << 30);
    EXPECT_FALSE(plain.get(kLevel0, 3, Form::Totals).value().page->hasTotals);
}

// A walk that takes it whole would take what lies beyond, too.
TEST_F(PageCacheTest, RefusesAPageWithRecordsOutsideItsRange) {
    for (const bool isFirst : {true, false}) {
        IndexMeta meta = reader_->meta();
        auto& pages = meta.levels[0].pages;
        const auto wide = std::find_if(pages.begin(), pages.end(),
                                       [](const PageEntry& page) { return page.firstKey < page.lastKey; });
        ASSERT_NE(wide, pages.end());
        (isFirst ? wide->firstKey : wide->lastKey) = isFirst ? wide->lastKey : wide->firstKey;
        const auto forged =
            IndexReader::open(folder_.write("forged.isx", test::forgedIndex(test::readText(folder_ / "a.isx"), meta)));
        ASSERT_THAT(forged, IsOk());
        Cache cache(*forged.value(), std::uint64_t{1} << 30);
        const auto page = static_cast<std::size_t>(wide - pages.begin());
        EXPECT_THAT(cache.get(kLevel0, page), test::HasError(ErrorCode::Corruption)) << isFirst;
        EXPECT_THAT(cache.get(kLevel0, page == 0 ? 1 : 0), IsOk());
    }
}

// One that had the memory of records would count as much as these.
TEST_F(PageCacheTest, KeepsTotalsAsSmallAsTheyAre) {
    using Form = Cache::Form;
    const auto sumUp = [](const KeptPage&, std::vector<BrickTotal>& totals) { totals.push_back({BrickIndex(7), 1}); };
    Cache cache(*reader_, 2 * largest_, sumUp);
    for (std::size_t page = 0; page < 20; ++page) { // most are given up again
        ASSERT_THAT(cache.get(kLevel0, page), IsOk());
        ASSERT_THAT(cache.get(kLevel0, page, Form::Totals), IsOk());
    }
    for (std::size_t page = 0; page < 20; ++page)
        EXPECT_LT(cache.get(kLevel0, page, Form::Totals).value().page->memoryBytes(), largest_ / 10);
    for (std::size_t page = 0; page < 20; ++page)
        EXPECT_EQ(cache.get(kLevel0, page, Form::Totals).value().bytesRead, 0u) << "all are kept";
}

TEST_F(PageCacheTest, KeepsWithinItsBoundBesideManyThreads) {
    Cache cache(*reader_, 5 * largest_);
    std::vector<std::jthread> threads;
    for (unsigned t = 0; t < 4; ++t)
        threads.emplace_back([&, t] {
            std::mt19937 random(t);
            for (int round = 0; round < 100; ++round) {
                const std::size_t page = random() % pageCount(0);
                EXPECT_EQ(get(cache, 0, page).page->recordCount(), reader_->meta().levels[0].pages[page].points);
                EXPECT_LE(cache.memoryBytes(), 5 * largest_);
            }
        });
}

} // namespace
} // namespace isoslider::index
