#include "core/index/lazy_levels.h"

#include <bit>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <tuple>

#include <gtest/gtest.h>

#include "core/base/folders.h"
#include "core/extract/full_extraction.h"
#include "core/extract/slide_engine.h"
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
using Page = DecodedPage<std::uint16_t>;

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

/// One edge of a record: point, its key, edge number, key at the other end.
using Entry = std::tuple<std::uint64_t, std::uint16_t, int, std::uint16_t>;

template <class Keep>
void addEntries(const Page& page, const Keep& keep, std::multiset<Entry>& entries) {
    std::size_t at = 0;
    for (std::size_t i = 0; i < page.pointCount(); ++i)
        for (unsigned rest = page.masks[i]; rest != 0; rest &= rest - 1, ++at)
            if (keep(page.keys[i], page.farKeys[at]))
                entries.insert({page.ids[i], page.keys[i], std::countr_zero(rest), page.farKeys[at]});
}

class LazyLevelsTest : public testing::Test {
protected:
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

    /// By the definition: the records of level 0 in the group's interval, without what lies in it with both ends.
    std::multiset<Entry> netEntries(const BlockGroup& group) const {
        const auto& blocks = reader_->meta().levels.back().blocks;
        std::multiset<Entry> entries;
        std::vector<std::byte> bytes;
        Page page;
        const std::uint64_t begin = blocks[group.firstBlock()].firstKey;
        const std::uint64_t end = blocks[group.blockEnd() - 1].lastKey + 1;
        const auto isNet = [&](std::uint64_t key, std::uint64_t farKey) {
            return key >= begin && key < end && (farKey < begin || farKey >= end);
        };
        for (const PageEntry& place : reader_->meta().levels[0].pages) {
            EXPECT_THAT(reader_->readPage(place, bytes), IsOk());
            EXPECT_THAT(decodePage<std::uint16_t>(bytes, reader_->grid(), page, "page"), IsOk());
            addEntries(page, isNet, entries);
        }
        return entries;
    }
    static std::multiset<Entry> entriesOf(const Lazy& lazy, const StoredGroup& group) {
        std::multiset<Entry> entries;
        Page page;
        for (const StoredPage& stored : group.pages) {
            EXPECT_THAT(lazy.load(stored, page), IsOk());
            addEntries(
                page, [](auto, auto) { return true; }, entries);
        }
        return entries;
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
};

TEST_F(LazyLevelsTest, HoldWhatIsLeftOfTheirBlocks) {
    ASSERT_GT(blockCount(), 16u);
    Lazy lazy(*reader_, 1u << 20);
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
            EXPECT_EQ(entriesOf(lazy, *stored), netEntries(group)) << level;
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
    Lazy lazy(*reader_, 1u << 20);
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

TEST_F(LazyLevelsTest, NoteWhatIsNotWorthwhile) {
    buildFrom(test::noiseVolume({20, 20, 20}, 5, 200), 4.0);
    if (blockCount() < 2)
        GTEST_SKIP() << "one block";
    Lazy lazy(*reader_, 1u << 20);
    std::size_t worthwhile = 0, noted = 0;
    for (std::uint64_t g = 0; g < blockCount() / 2; ++g) {
        build(lazy, {{1, g}});
        const auto stored = lazy.find({1, g});
        ASSERT_NE(stored, nullptr);
        (stored->isWorthwhile ? worthwhile : noted) += 1;
        if (!stored->isWorthwhile) {
            EXPECT_TRUE(stored->pages.empty());
            const std::uint64_t net = netEntries({1, g}).size();
            std::uint64_t below = 0;
            for (const std::uint64_t b : {2 * g, 2 * g + 1}) {
                const BlockEntry& block = reader_->meta().levels.back().blocks[b];
                for (std::uint64_t p = 0; p < block.pageCount; ++p)
                    below += reader_->meta().levels.back().pages[block.firstPage + p].edges;
            }
            EXPECT_GT(net, below - below / 8);
        }
    }
    RecordProperty("worthwhile", static_cast<int>(worthwhile));
    Lazy again(*reader_, 1u << 20);
    EXPECT_NE(again.find({1, 0}), nullptr) << "noted in the file";
}

TEST_F(LazyLevelsTest, OfAnotherIndexAreIgnoredAndReplaced) {
    EXPECT_TRUE(jumpsRight({}, 4));
    ASSERT_TRUE(isPresent(levels_));
    const fs::path kept = folder_ / "kept";
    fs::copy_file(levels_, kept);
    buildFrom(test::noiseVolume({30, 28, 26}, 3, 200), 0.05);
    EXPECT_FALSE(isPresent(levels_)) << "a build removes what lies beside the index that it replaces";
    fs::copy_file(kept, levels_);
    Lazy lazy(*reader_, 1u << 20);
    for (int level = 1; level < 6; ++level)
        EXPECT_EQ(lazy.find({level, 0}), nullptr);
    build(lazy, {{2, 0}});
    ASSERT_NE(lazy.find({2, 0}), nullptr);
    EXPECT_EQ(lazy.memoryBytes(), 0u);
    if (lazy.find({2, 0})->isWorthwhile) {
        EXPECT_EQ(entriesOf(lazy, *lazy.find({2, 0})), netEntries({2, 0}));
    }
}

TEST_F(LazyLevelsTest, LeaveAFileOfAnotherKindAlone) {
    std::ofstream(levels_) << "my notes about these levels";
    Lazy lazy(*reader_, 1u << 20);
    build(lazy, someGroups());
    ASSERT_NE(lazy.find({2, 0}), nullptr);
    EXPECT_GT(lazy.memoryBytes(), 0u) << "in memory then";
    EXPECT_EQ(entriesOf(lazy, *lazy.find({2, 0})), netEntries({2, 0}));
    buildFrom(grid_, 0.1);
    std::string text;
    std::ifstream in(levels_);
    std::getline(in, text);
    EXPECT_EQ(text, "my notes about these levels");
}

TEST_F(LazyLevelsTest, KeepWithinTheirBoundOfMemory) {
    test::FaultyFileSystem readOnly(0, EROFS); // the first thing written is the file's creation
    const auto reader = openReader(readOnly);
    Lazy roomy(*reader, 1u << 20);
    build(roomy, someGroups());
    EXPECT_FALSE(isPresent(levels_));
    const std::uint64_t all = roomy.memoryBytes();
    ASSERT_GT(all, 2000u);
    test::FaultyFileSystem again(0, EROFS);
    const auto other = openReader(again);
    Lazy small(*other, all / 2);
    build(small, someGroups());
    EXPECT_LE(small.memoryBytes(), all / 2);
    EXPECT_GT(small.memoryBytes(), 0u);
    roomy.clear();
    EXPECT_EQ(roomy.memoryBytes(), 0u);
    EXPECT_EQ(roomy.find({2, 0}), nullptr);
}

TEST_F(LazyLevelsTest, AreWrittenByOneProgramAtATime) {
    Lazy first(*reader_, 1u << 20), second(*reader_, 1u << 20);
    build(first, {{2, 0}});
    build(second, {{2, 0}, {2, 1}});
    EXPECT_EQ(first.memoryBytes(), 0u);
    EXPECT_GT(second.memoryBytes(), 0u) << "in memory, as the first has the file";
    build(first, {{2, 2}});
    for (const BlockGroup& group : {BlockGroup{2, 0}, BlockGroup{2, 2}})
        EXPECT_EQ(entriesOf(first, *first.find(group)), netEntries(group));
    for (const BlockGroup& group : {BlockGroup{2, 0}, BlockGroup{2, 1}})
        EXPECT_EQ(entriesOf(second, *second.find(group)), netEntries(group));
}

TEST_F(LazyLevelsTest, GoOnWhenTheirFileIsRemoved) {
    Lazy lazy(*reader_, 1u << 20);
    build(lazy, {{2, 0}});
    fs::remove(levels_);
    build(lazy, {{2, 1}});
    build(lazy, {{2, 2}});
    EXPECT_EQ(entriesOf(lazy, *lazy.find({2, 0})), netEntries({2, 0}));
    ASSERT_NE(lazy.find({2, 2}), nullptr);
    EXPECT_EQ(entriesOf(lazy, *lazy.find({2, 2})), netEntries({2, 2}));
    EXPECT_FALSE(isPresent(levels_));
}

TEST_F(LazyLevelsTest, AreWholeOrAbsentWhicheverWriteFails) {
    int failures = 0;
    for (int call = 0;; ++call) {
        fs::remove(levels_);
        test::FaultyFileSystem faulty(call, ENOSPC);
        {
            const auto reader = openReader(faulty);
            Lazy lazy(*reader, 1u << 20);
            for (const BlockGroup& group : {BlockGroup{2, 0}, BlockGroup{2, 1}, BlockGroup{2, 2}}) {
                build(lazy, {group});
                if (const auto stored = lazy.find(group); stored && stored->isWorthwhile) {
                    EXPECT_EQ(entriesOf(lazy, *stored), netEntries(group)) << call;
                }
            }
        }
        Lazy later(*reader_, 1u << 20);
        for (const BlockGroup& group : {BlockGroup{2, 0}, BlockGroup{2, 1}, BlockGroup{2, 2}})
            if (const auto stored = later.find(group); stored && stored->isWorthwhile) {
                EXPECT_EQ(entriesOf(later, *stored), netEntries(group)) << call;
            }
        build(later, {{2, 3}});
        ASSERT_NE(later.find({2, 3}), nullptr) << call;
        EXPECT_EQ(entriesOf(later, *later.find({2, 3})), netEntries({2, 3})) << call;
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
    buildFrom(test::hillsVolume({14, 13, 12}), 0.05);
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
