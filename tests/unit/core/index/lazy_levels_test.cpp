#include "core/index/lazy_levels.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <map>

#include <gtest/gtest.h>

#include "core/base/folders.h"
#include "core/extract/full_extraction.h"
#include "core/extract/slide_engine.h"
#include "core/extract/sources/brick_activity.h"
#include "core/grid/scalar_key.h"
#include "core/index/index_reader.h"
#include "tests/property/surface_comparison.h"
#include "tests/property/test_volumes.h"
#include "tests/support/faulty_file_system.h"
#include "tests/support/result_matchers.h"
#include "tests/support/sanitizers.h"
#include "tests/support/temporary_folder.h"

namespace isoslider::index {
namespace {

namespace fs = std::filesystem;
using test::IsOk;
using Lazy = LazyLevels<std::uint16_t>;

TEST(LazyLevels, CutAnyRunOfBlocksIntoTheLargestAlignedGroups) {
    for (std::uint64_t begin = 0; begin < 70; ++begin)
        for (std::uint64_t end = begin; end < 140; ++end) {
            std::uint64_t at = begin;
            for (const auto& group : Lazy::groupsOf(begin, end)) {
                ASSERT_EQ(group.firstBlock(), at);
                ASSERT_GT(group.blockEnd(), at);
                at = group.blockEnd();
                ASSERT_LE(at, end);
                // The group one level up would begin before, or reach beyond.
                const std::uint64_t size = std::uint64_t{2} << group.level;
                ASSERT_TRUE(group.firstBlock() % size != 0 || group.firstBlock() + size > end)
                    << begin << " to " << end;
            }
            ASSERT_EQ(at, end);
        }
}

using Totals = std::map<std::uint64_t, int>; ///< by brick, none of them 0

std::vector<std::uint64_t> keysOf(const ScalarGrid& grid) {
    return visitScalarType(grid.type(), [&](auto sample) {
        std::vector<std::uint64_t> keys;
        for (const auto value : grid.values<decltype(sample)>())
            keys.push_back(keyOf(value));
        return keys;
    });
}

void addTotals(const std::vector<BrickTotal>& from, Totals& to) {
    for (const BrickTotal& total : from)
        to[total.brick.number()] += total.count;
    std::erase_if(to, [](const auto& total) { return total.second == 0; });
}

class LazyLevelsTest : public testing::Test {
protected:
    using Activity = extract::BrickActivity<std::uint16_t>;

    void SetUp() override { buildFrom(test::hillsVolume({30, 28, 26}), 0.05); }

    void buildFrom(const std::shared_ptr<const ScalarGrid>& grid, double redundancy) {
        grid_ = grid;
        preprocess::BuildOptions options;
        options.skipLevels = 2;
        options.redundancyThreshold = redundancy;
        ASSERT_THAT(test::buildIndexOf(grid, path_, options), IsOk());
        reader_ = openReader();
    }
    std::unique_ptr<IndexReader> openReader(FileSystem& fileSystem = defaultFileSystem()) const {
        auto opened = IndexReader::open(path_, fileSystem);
        EXPECT_THAT(opened, IsOk());
        return opened.isOk() ? std::move(opened).value() : nullptr;
    }
    std::uint64_t blockCount() const { return reader_->meta().levels.back().blocks.size(); }

    /// By the definition: what is active of each closed brick beyond the group's interval, less what is before it.
    Totals netTotals(const BlockGroup& group) const {
        const auto& blocks = reader_->meta().levels.back().blocks;
        const std::uint64_t before = blocks[group.firstBlock()].firstKey,
                            beyond = blocks[group.blockEnd() - 1].lastKey + 1;
        const BrickGrid& grid = reader_->grid();
        const GridDims& dims = grid.dims();
        const auto samples = keysOf(*grid_);
        const std::size_t strides[] = {1, static_cast<std::size_t>(dims[0]),
                                       static_cast<std::size_t>(dims[0] * dims[1])};
        Totals totals;
        for (std::uint64_t brick = 0; brick < grid.brickCount(); ++brick) {
            const auto at = grid.brickCoords(BrickIndex(static_cast<std::uint32_t>(brick)));
            std::array<std::int64_t, 3> first{}, last{}; // of its grid points
            for (int axis = 0; axis < 3; ++axis) {
                first[axis] = kBrickSide * at[axis];
                last[axis] = std::min<std::int64_t>(dims[axis] - 1, first[axis] + kBrickSide);
            }
            int count = 0;
            for (std::int64_t z = first[2]; z <= last[2]; ++z)
                for (std::int64_t y = first[1]; y <= last[1]; ++y)
                    for (std::int64_t x = first[0]; x <= last[0]; ++x) {
                        const std::int64_t place[] = {x, y, z};
                        const auto p = static_cast<std::size_t>(x + dims[0] * (y + dims[1] * z));
                        for (int axis = 0; axis < 3; ++axis)
                            if (place[axis] < last[axis]) {
                                const std::uint64_t a = samples[p], b = samples[p + strides[axis]];
                                count +=
                                    ((a >= beyond) != (b >= beyond) ? 1 : 0) - ((a >= before) != (b >= before) ? 1 : 0);
                            }
                    }
            if (count != 0)
                totals[brick] = count;
        }
        return totals;
    }
    Totals totalsOf(const Lazy& lazy, const StoredGroup& group) const {
        Totals totals;
        std::vector<BrickTotal> page;
        for (const StoredPage& stored : group.pages) {
            EXPECT_THAT(lazy.load(stored, page), IsOk());
            EXPECT_EQ(page.size(), stored.totals);
            addTotals(page, totals);
        }
        return totals;
    }
    Lazy::SumUp sumUp() {
        activity_ = std::make_unique<Activity>(reader_->grid(), reader_->info().kind == IndexKind::Edges
                                                                    ? Activity::ListOf::Edges
                                                                    : Activity::ListOf::Bricks);
        return [this](const auto& records, auto& totals) { activity_->sumUp(records, totals); };
    }
    void build(Lazy& lazy, const std::vector<BlockGroup>& groups) const {
        lazy.request(groups);
        lazy.wait();
    }
    /// Those of level 2 that the index has.
    std::vector<BlockGroup> someGroups() const {
        std::vector<BlockGroup> groups;
        for (std::uint64_t g = 0; g < blockCount() >> 2; ++g)
            groups.push_back({2, g});
        return groups;
    }
    /// Jumps give the surface that extracting gives. Returns whether a lazy level was used.
    bool jumpsRight(const extract::SlideOptions& options, int rounds = 2) const {
        const auto engine = extract::SlideEngine::open(path_, options);
        EXPECT_THAT(engine, IsOk());
        bool hasUsed = false;
        for (int round = 0; engine.isOk() && round < rounds; ++round) {
            const double isovalue = round % 2 ? 420.0 : 250.0;
            const auto moved = engine.value()->slideTo(isovalue);
            EXPECT_THAT(moved, IsOk());
            EXPECT_TRUE(
                test::isSameSurface(engine.value()->mesh().value(), extract::extractFull(*grid_, isovalue).value()));
            for (const auto& step : moved.value().walk)
                hasUsed = hasUsed || step.level >= SkipLevel(2);
            engine.value()->waitForPrefetch();
        }
        return hasUsed;
    }
    static extract::SlideOptions withoutBuilding() {
        extract::SlideOptions options;
        options.buildsLevels = false;
        return options;
    }

    test::TemporaryFolder folder_;
    fs::path path_ = folder_ / "a.isx", levels_ = folder_ / "a.isx.levels";
    std::shared_ptr<const ScalarGrid> grid_;
    std::unique_ptr<IndexReader> reader_;
    std::unique_ptr<Activity> activity_;
};

TEST_F(LazyLevelsTest, HoldWhatIsLeftOfTheirBlocks) {
    ASSERT_GT(blockCount(), 16u);
    Lazy lazy(*reader_, 1u << 20, sumUp());
    // Of every size, and each from the blocks alone or from smaller groups that are there already.
    for (int level = 1; std::uint64_t{1} << level <= blockCount(); ++level)
        build(lazy, {{level, 0}, {level, (blockCount() >> level) - 1}});
    std::size_t compared = 0;
    for (int level = 1; std::uint64_t{1} << level <= blockCount(); ++level)
        for (const BlockGroup& group : {BlockGroup{level, 0}, BlockGroup{level, (blockCount() >> level) - 1}}) {
            const auto stored = lazy.find(group);
            ASSERT_NE(stored, nullptr) << level;
            if (!stored->isWorthwhile)
                continue;
            EXPECT_EQ(totalsOf(lazy, *stored), netTotals(group)) << level;
            ++compared;
        }
    EXPECT_GT(compared, 4u);
}

TEST_F(LazyLevelsTest, AreThereForTheNextProgram) {
    EXPECT_FALSE(isPresent(levels_));
    EXPECT_FALSE(jumpsRight(withoutBuilding())) << "there are none yet";
    EXPECT_FALSE(isPresent(levels_)) << "none was built";
    EXPECT_TRUE(jumpsRight({}, 6)) << "built by the first jumps, in the background";
    ASSERT_TRUE(isPresent(levels_));
    EXPECT_TRUE(jumpsRight(withoutBuilding())) << "read by another engine";
    Lazy lazy(*reader_, 1u << 20, sumUp());
    EXPECT_EQ(lazy.memoryBytes(), 0u);
}

TEST_F(LazyLevelsTest, SpareWalksEdges) {
    const auto touched = [&](const extract::SlideOptions& options) {
        const auto engine = extract::SlideEngine::open(path_, options);
        std::uint64_t last = 0;
        for (const double isovalue : {250.0, 420.0, 250.0, 420.0}) {
            last = engine.value()->slideTo(isovalue).value().edgesTouched;
            engine.value()->waitForPrefetch();
        }
        return last;
    };
    const std::uint64_t without = touched(withoutBuilding());
    EXPECT_LT(touched({}), without);
}

// Bricks of noise have long intervals: few of them end where they begin.
TEST_F(LazyLevelsTest, NoteWhatIsNotWorthwhile) {
    preprocess::BuildOptions options;
    options.skipLevels = 2;
    options.redundancyThreshold = 0.01;
    options.kind = IndexKind::Metacells;
    GridGeometry geometry;
    geometry.dims = {200, 33, 33};
    grid_ =
        test::makeVolume<std::uint16_t>(ScalarType::U16, geometry, [](std::int64_t x, std::int64_t y, std::int64_t z) {
            return 20 * x + 101 * (y * 7 + z * 3) % 4001;
        });
    ASSERT_THAT(test::buildIndexOf(grid_, path_, options), IsOk());
    reader_ = openReader();
    ASSERT_GE(blockCount(), 2u);
    Lazy lazy(*reader_, 1u << 20, sumUp());
    build(lazy, {{1, 0}});
    const auto stored = lazy.find({1, 0});
    ASSERT_NE(stored, nullptr);
    EXPECT_FALSE(stored->isWorthwhile);
    EXPECT_TRUE(stored->pages.empty());
    EXPECT_EQ(lazy.memoryBytes(), 0u);
    Lazy again(*reader_, 1u << 20, sumUp());
    ASSERT_NE(again.find({1, 0}), nullptr) << "noted in the file";
    EXPECT_FALSE(again.find({1, 0})->isWorthwhile);
    ASSERT_THAT(extract::SlideEngine::open(path_).value()->slideTo(10000.0), IsOk());
}

// More totals than a page holds, of which each brick has one.
TEST_F(LazyLevelsTest, OfManyBricksHaveSeveralPages) {
    GridGeometry geometry;
    geometry.dims = {2500, 2500, 2};
    // Bricks begin one row after the other. Of four in a row one ends among the blocks, the others beyond.
    grid_ =
        test::makeVolume<std::uint16_t>(ScalarType::U16, geometry, [](std::int64_t x, std::int64_t y, std::int64_t) {
            const bool isInside = x % kBrickSide == 4 && y % kBrickSide == 4;
            const std::int64_t first = 20 * (y / kBrickSide), last = x / kBrickSide % 4 == 0 ? first + 1500 : 60000;
            return isInside ? last : first + x % 3;
        });
    preprocess::BuildOptions options;
    options.skipLevels = 2;
    options.redundancyThreshold = 0.02;
    options.kind = IndexKind::Metacells;
    ASSERT_THAT(test::buildIndexOf(grid_, path_, options), IsOk());
    reader_ = openReader();
    const int level = std::bit_width(blockCount()) - 1; // the largest group
    Lazy lazy(*reader_, 1u << 20, sumUp());
    build(lazy, {{level, 0}});
    const auto stored = lazy.find({level, 0});
    ASSERT_TRUE(stored && stored->isWorthwhile) << level;
    EXPECT_GT(stored->pages.size(), 1u);
    Totals expected;
    const BlockEntry& last = reader_->meta().levels.back().blocks[(std::uint64_t{1} << level) - 1];
    std::vector<std::byte> bytes;
    DecodedPage<std::uint16_t> page;
    for (const PageEntry& place : reader_->meta().levels[0].pages) {
        ASSERT_THAT(reader_->readPage(place, bytes), IsOk());
        ASSERT_THAT(decodePage<std::uint16_t>(bytes, reader_->grid(), page, "page"), IsOk());
        for (std::size_t i = 0; i < page.pointCount(); ++i)
            if (page.keys[i] <= last.lastKey)
                expected[page.ids[i] / kBrickPoints] += page.rising[i] != 0 ? 1 : -1;
    }
    std::erase_if(expected, [](const auto& total) { return total.second == 0; });
    EXPECT_GT(expected.size(), kMaxPageTotals);
    EXPECT_EQ(totalsOf(lazy, *stored), expected);
}

// Who walks for records has no use for those that others have built either.
TEST_F(LazyLevelsTest, AreNotThereWithoutSums) {
    Lazy lazy(*reader_, 1u << 20, {});
    build(lazy, someGroups());
    EXPECT_EQ(lazy.find({2, 0}), nullptr);
    Lazy others(*reader_, 1u << 20, sumUp());
    build(others, {{2, 0}});
    ASSERT_NE(others.find({2, 0}), nullptr);
    ASSERT_TRUE(isPresent(levels_));
    EXPECT_EQ(Lazy(*reader_, 1u << 20, {}).find({2, 0}), nullptr);
}

// What a file states of a page is no reason to take memory for it.
TEST_F(LazyLevelsTest, OfImpossibleSizesAreNone) {
    Lazy lazy(*reader_, 1u << 20, sumUp());
    build(lazy, {{2, 0}});
    const auto stored = lazy.find({2, 0});
    ASSERT_TRUE(stored && !stored->pages.empty());
    for (const StoredPage& page : stored->pages)
        EXPECT_LE(page.bytes, mostBytesOfTotals(page.totals));
    EXPECT_EQ(encodeTotals(std::vector<BrickTotal>{{BrickIndex(7), 256}}).size(), mostBytesOfTotals(1));
}

TEST_F(LazyLevelsTest, OfAnotherIndexAreIgnoredAndReplaced) {
    EXPECT_TRUE(jumpsRight({}, 4));
    ASSERT_TRUE(isPresent(levels_));
    const fs::path kept = folder_ / "kept";
    fs::copy_file(levels_, kept);
    buildFrom(test::noiseVolume({30, 28, 26}, 3, 200), 0.05);
    EXPECT_FALSE(isPresent(levels_)) << "a build removes what lies beside the index that it replaces";
    fs::copy_file(kept, levels_);
    Lazy lazy(*reader_, 1u << 20, sumUp());
    for (int level = 1; level < 6; ++level)
        EXPECT_EQ(lazy.find({level, 0}), nullptr);
    build(lazy, {{2, 0}});
    ASSERT_NE(lazy.find({2, 0}), nullptr);
    EXPECT_EQ(lazy.memoryBytes(), 0u);
    if (lazy.find({2, 0})->isWorthwhile) {
        EXPECT_EQ(totalsOf(lazy, *lazy.find({2, 0})), netTotals({2, 0}));
    }
}

TEST_F(LazyLevelsTest, LeaveAFileOfAnotherKindAlone) {
    std::ofstream(levels_) << "my notes about these levels";
    Lazy lazy(*reader_, 1u << 20, sumUp());
    build(lazy, someGroups());
    ASSERT_NE(lazy.find({2, 0}), nullptr);
    EXPECT_GT(lazy.memoryBytes(), 0u) << "in memory then";
    EXPECT_EQ(totalsOf(lazy, *lazy.find({2, 0})), netTotals({2, 0}));
    buildFrom(grid_, 0.1);
    std::string text;
    std::ifstream in(levels_);
    std::getline(in, text);
    EXPECT_EQ(text, "my notes about these levels");
}

TEST_F(LazyLevelsTest, KeepWithinTheirBoundOfMemory) {
    buildFrom(test::hillsVolume({50, 40, 30}), 0.05);
    test::FaultyFileSystem readOnly(0, EROFS); // the first thing written is the file's creation
    const auto reader = openReader(readOnly);
    Lazy roomy(*reader, 1u << 20, sumUp());
    build(roomy, someGroups());
    EXPECT_FALSE(isPresent(levels_));
    const std::uint64_t all = roomy.memoryBytes();
    ASSERT_GT(all, 2000u);
    test::FaultyFileSystem again(0, EROFS);
    const auto other = openReader(again);
    Lazy small(*other, all / 2, sumUp());
    build(small, someGroups());
    EXPECT_LE(small.memoryBytes(), all / 2);
    EXPECT_GT(small.memoryBytes(), 0u);
    roomy.clear();
    EXPECT_EQ(roomy.memoryBytes(), 0u);
    EXPECT_EQ(roomy.find({2, 0}), nullptr);
}

TEST_F(LazyLevelsTest, AreWrittenByOneProgramAtATime) {
    const auto sums = sumUp();
    Lazy first(*reader_, 1u << 20, sums), second(*reader_, 1u << 20, sums);
    build(first, {{2, 0}});
    build(second, {{2, 0}, {2, 1}});
    EXPECT_EQ(first.memoryBytes(), 0u);
    EXPECT_GT(second.memoryBytes(), 0u) << "in memory, as the first has the file";
    build(first, {{2, 2}});
    for (const BlockGroup& group : {BlockGroup{2, 0}, BlockGroup{2, 2}})
        EXPECT_EQ(totalsOf(first, *first.find(group)), netTotals(group));
    for (const BlockGroup& group : {BlockGroup{2, 0}, BlockGroup{2, 1}})
        EXPECT_EQ(totalsOf(second, *second.find(group)), netTotals(group));
}

TEST_F(LazyLevelsTest, GoOnWhenTheirFileIsRemoved) {
    Lazy lazy(*reader_, 1u << 20, sumUp());
    build(lazy, {{2, 0}});
    fs::remove(levels_);
    build(lazy, {{2, 1}});
    build(lazy, {{2, 2}});
    EXPECT_EQ(totalsOf(lazy, *lazy.find({2, 0})), netTotals({2, 0}));
    ASSERT_NE(lazy.find({2, 2}), nullptr);
    EXPECT_EQ(totalsOf(lazy, *lazy.find({2, 2})), netTotals({2, 2}));
    EXPECT_FALSE(isPresent(levels_));
}

TEST_F(LazyLevelsTest, AreWholeOrAbsentWhicheverWriteFails) {
    int failures = 0;
    for (int call = 0;; ++call) {
        fs::remove(levels_);
        test::FaultyFileSystem faulty(call, ENOSPC);
        {
            const auto reader = openReader(faulty);
            Lazy lazy(*reader, 1u << 20, sumUp());
            for (const BlockGroup& group : {BlockGroup{2, 0}, BlockGroup{2, 1}, BlockGroup{2, 2}}) {
                build(lazy, {group});
                if (const auto stored = lazy.find(group); stored && stored->isWorthwhile) {
                    EXPECT_EQ(totalsOf(lazy, *stored), netTotals(group)) << call;
                }
            }
        }
        Lazy later(*reader_, 1u << 20, sumUp());
        for (const BlockGroup& group : {BlockGroup{2, 0}, BlockGroup{2, 1}, BlockGroup{2, 2}})
            if (const auto stored = later.find(group); stored && stored->isWorthwhile) {
                EXPECT_EQ(totalsOf(later, *stored), netTotals(group)) << call;
            }
        build(later, {{2, 3}});
        ASSERT_NE(later.find({2, 3}), nullptr) << call;
        EXPECT_EQ(totalsOf(later, *later.find({2, 3})), netTotals({2, 3})) << call;
        EXPECT_EQ(later.memoryBytes(), 0u) << "the file is of use again";
        if (faulty.calls() <= call)
            break;
        ++failures;
    }
    EXPECT_GT(failures, 8);
}

std::string bytesOf(const fs::path& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}
void write(const fs::path& path, const std::string& bytes) {
    std::ofstream(path, std::ios::binary | std::ios::trunc) << bytes;
}

TEST_F(LazyLevelsTest, ThatAreDamagedNeverMakeAnotherSurface) {
    buildFrom(test::hillsVolume({22, 20, 17}), 0.02);
    ASSERT_TRUE(jumpsRight({}, 4));
    const std::string whole = bytesOf(levels_);
    ASSERT_GT(whole.size(), 1000u);
    const std::size_t step = whole.size() * test::kSparser / 250;
    for (std::size_t at = 0; at < whole.size(); at += step) {
        std::string damaged = whole;
        damaged[at] = static_cast<char>(damaged[at] ^ 1 << at % 8);
        write(levels_, damaged);
        jumpsRight(withoutBuilding());
        write(levels_, whole.substr(0, at));
        jumpsRight(withoutBuilding());
        std::string zeroed = whole;
        zeroed.replace(at, 64, std::string(std::min<std::size_t>(64, whole.size() - at), '\0'));
        write(levels_, zeroed);
        jumpsRight({});
        ASSERT_FALSE(HasFailure()) << "byte " << at;
    }
}

TEST_F(LazyLevelsTest, ServeIndexesOfEveryKind) {
    // Bricks and edges with short intervals: jumps pass most of them.
    GridGeometry geometry;
    geometry.dims = {400, 24, 22};
    const auto grid =
        test::makeVolume<std::uint16_t>(ScalarType::U16, geometry, [](std::int64_t x, std::int64_t y, std::int64_t z) {
            return 5 * x + (y * y + 3 * z) % 11;
        });
    for (const bool isMerged : {false, true}) {
        preprocess::BuildOptions options;
        options.skipLevels = 2;
        options.redundancyThreshold = 0.05;
        if (isMerged)
            options.mergeError = {extract::MergeBound::Measure::Distance, 0.25};
        else
            options.kind = IndexKind::Metacells;
        fs::remove(levels_);
        ASSERT_THAT(test::buildIndexOf(grid, path_, options), IsOk());
        const auto plain = extract::SlideEngine::open(path_, withoutBuilding());
        const auto engine = extract::SlideEngine::open(path_);
        bool hasUsed = false;
        for (const double isovalue : {250.0, 1700.0, 260.0, 1710.0, 250.0, 1700.0}) {
            ASSERT_THAT(plain.value()->slideTo(isovalue), IsOk());
            const auto moved = engine.value()->slideTo(isovalue);
            ASSERT_THAT(moved, IsOk());
            EXPECT_TRUE(test::isSameSurface(engine.value()->mesh().value(), plain.value()->mesh().value()));
            for (const auto& step : moved.value().walk)
                hasUsed = hasUsed || step.level >= SkipLevel(2);
            engine.value()->waitForPrefetch();
        }
        EXPECT_TRUE(hasUsed) << isMerged;
    }
}

} // namespace
} // namespace isoslider::index
