#include "core/index/lazy_levels.h"

#include <gtest/gtest.h>

#include "core/extract/full_extraction.h"
#include "core/extract/slide_engine.h"
#include "core/index/index_reader.h"
#include "tests/property/surface_comparison.h"
#include "tests/property/test_volumes.h"
#include "tests/support/result_matchers.h"
#include "tests/support/temporary_folder.h"

namespace isoslider::index {
namespace {

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

// Blocks of one point each, key 10 b; each has an edge to the next block's point and one far away.
struct Chain {
    Lazy::Below below() {
        return {[this](std::uint64_t block) -> Result<std::vector<Lazy::Page>> {
                    ++reads;
                    if (failingBlock == block)
                        return makeError(ErrorCode::Corruption, "no");
                    auto page = std::make_shared<DecodedPage<std::uint16_t>>();
                    page->keys = {static_cast<std::uint16_t>(10 * block)};
                    page->ids = {block};
                    page->masks = {0b10010};
                    page->normals = {static_cast<NormalCode>(block)};
                    page->farKeys = {static_cast<std::uint16_t>(10 * block + 10), 60000};
                    page->farNormals = {1, 2};
                    return std::vector<Lazy::Page>{page};
                },
                [](std::uint64_t begin, std::uint64_t end) {
                    return std::pair{10 * begin, 10 * (end - 1) + 1};
                }};
    }
    int reads = 0;
    std::uint64_t failingBlock = ~std::uint64_t{0};
};

TEST(LazyLevels, MergeWhatIsLeftOfAllBlocksAtTheSecondRequest) {
    Chain chain;
    Lazy lazy(1u << 20);
    const Lazy::Group group{3, 2}; // blocks 16 to 23
    const auto first = lazy.get(group, chain.below());
    ASSERT_THAT(first, IsOk());
    EXPECT_EQ(first.value(), nullptr);
    EXPECT_EQ(chain.reads, 0);
    const auto second = lazy.get(group, chain.below());
    ASSERT_THAT(second, IsOk());
    ASSERT_NE(second.value(), nullptr);
    EXPECT_EQ(chain.reads, 8);
    const DecodedPage<std::uint16_t>& page = *second.value();
    ASSERT_EQ(page.pointCount(), 8u);
    // All edges to the next point are redundant but the last one.
    EXPECT_EQ(page.edgeCount(), 9u);
    for (std::size_t i = 0; i < 8; ++i) {
        EXPECT_EQ(page.keys[i], 160 + 10 * i);
        EXPECT_EQ(page.masks[i], i < 7 ? 0b10000 : 0b10010);
        EXPECT_EQ(page.normals[i], 16 + i);
    }
    EXPECT_EQ(page.farKeys[7], 240);
    EXPECT_EQ(page.farNormals[7], 1);
    EXPECT_EQ(page.farKeys[8], 60000);
    EXPECT_EQ(lazy.get(group, chain.below()).value(), second.value()) << "kept";
    EXPECT_EQ(chain.reads, 8);
    EXPECT_GT(lazy.memoryBytes(), 0u);
}

TEST(LazyLevels, KeepNothingBeyondTheirBound) {
    Chain chain;
    Lazy lazy(100); // room for a few points
    for (int round = 0; round < 3; ++round)
        for (std::uint64_t g = 0; g < 4; ++g) {
            const auto got = lazy.get({3, g}, chain.below());
            ASSERT_THAT(got, IsOk());
            EXPECT_EQ(got.value(), nullptr);
        }
    EXPECT_LE(lazy.memoryBytes(), 100u);
}

TEST(LazyLevels, PassErrorsOnAndRecover) {
    Chain chain;
    chain.failingBlock = 3;
    Lazy lazy(1u << 20);
    EXPECT_THAT(lazy.get({2, 0}, chain.below()), IsOk());
    EXPECT_THAT(lazy.get({2, 0}, chain.below()), test::HasError(ErrorCode::Corruption));
    chain.failingBlock = ~std::uint64_t{0};
    const auto got = lazy.get({2, 0}, chain.below());
    ASSERT_THAT(got, IsOk());
    EXPECT_EQ(got.value()->pointCount(), 4u);
}

TEST(LazyLevels, ServeAWalkThatComesAgain) {
    const test::TemporaryFolder folder;
    const auto grid = test::hillsVolume({30, 28, 26});
    preprocess::BuildOptions options;
    options.skipLevels = 2;
    options.redundancyThreshold = 0.05;
    ASSERT_THAT(test::buildIndexOf(grid, folder / "a.isx", options), IsOk());
    const auto engine = extract::SlideEngine::open(folder / "a.isx");
    ASSERT_THAT(engine, IsOk());
    bool hasUsedLazyLevel = false;
    std::uint64_t firstTouched = 0, lastTouched = 0;
    for (int round = 0; round < 8; ++round) {
        const double isovalue = round % 2 ? 420.0 : 250.0;
        const auto moved = engine.value()->slideTo(isovalue);
        ASSERT_THAT(moved, IsOk());
        ASSERT_TRUE(test::isSameSurface(engine.value()->mesh().value(), extract::extractFull(*grid, isovalue).value()))
            << round;
        (round == 1 ? firstTouched : lastTouched) = moved.value().edgesTouched;
        for (const auto& step : moved.value().walk)
            hasUsedLazyLevel = hasUsedLazyLevel || step.level >= SkipLevel(2);
    }
    EXPECT_TRUE(hasUsedLazyLevel);
    EXPECT_LT(lastTouched, firstTouched);
}

} // namespace
} // namespace isoslider::index
