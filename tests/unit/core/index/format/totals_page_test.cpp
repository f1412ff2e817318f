// Totals by brick in bytes: what is given back, and what is refused.

#include "core/index/format/totals_page.h"

#include <map>
#include <random>

#include <gtest/gtest.h>

#include "tests/support/result_matchers.h"

namespace isoslider::index {
namespace {

using test::HasError;
using test::IsOk;

const BrickGrid& grid() {
    static const BrickGrid grid({400, 300, 200});
    return grid;
}

std::vector<BrickTotal> randomTotals(std::size_t count, std::mt19937& random) {
    std::vector<BrickTotal> totals;
    while (totals.size() < count) {
        const std::int32_t sum = static_cast<std::int32_t>(random() % 3889) - 1944;
        totals.push_back({BrickIndex(static_cast<std::uint32_t>(random() % grid().brickCount())), sum});
    }
    return totals;
}

TEST(BrickTotals, AreCombinedByBrick) {
    std::mt19937 random(3);
    auto totals = randomTotals(40000, random);
    std::map<std::uint64_t, int> expected;
    for (const BrickTotal& total : totals)
        expected[total.brick.number()] += total.count;
    std::erase_if(expected, [](const auto& sum) { return sum.second == 0; });
    combineTotals(totals);
    ASSERT_EQ(totals.size(), expected.size());
    auto next = expected.begin();
    for (const BrickTotal& total : totals) {
        ASSERT_EQ(total.brick.number(), next->first);
        ASSERT_EQ(total.count, next->second);
        ++next;
    }
    std::vector<BrickTotal> huge(5, {BrickIndex(7), kMostOfTotal}), none{{BrickIndex(7), 4}, {BrickIndex(7), -4}};
    combineTotals(huge);
    EXPECT_EQ(huge, (std::vector<BrickTotal>{{BrickIndex(7), kMostOfTotal}}));
    combineTotals(none);
    EXPECT_TRUE(none.empty());
}

TEST(BrickTotals, GiveBackWhatTheyTook) {
    std::mt19937 random(4);
    std::vector<BrickTotal> back;
    for (const std::size_t count : {1, 2, 900, 60000}) {
        auto totals = randomTotals(count, random);
        combineTotals(totals);
        const auto bytes = encodeTotals(totals);
        ASSERT_THAT(decodeTotals(bytes, grid(), back, "x"), IsOk());
        EXPECT_EQ(back, totals);
        EXPECT_EQ(encodeTotals(totals), bytes);
    }
    std::vector<BrickTotal> ends{{BrickIndex(0), kMostOfTotal},
                                 {BrickIndex(static_cast<std::uint32_t>(grid().brickCount() - 1)), -kMostOfTotal}};
    ASSERT_THAT(decodeTotals(encodeTotals(ends), grid(), back, "x"), IsOk());
    EXPECT_EQ(back, ends);
}

TEST(BrickTotals, AreRefusedWhereTheyCannotBe) {
    std::vector<BrickTotal> back;
    const auto refuses = [&](const std::vector<BrickTotal>& totals) {
        return testing::Value(decodeTotals(encodeTotals(totals), grid(), back, "x"), HasError(ErrorCode::Corruption));
    };
    const BrickIndex last(static_cast<std::uint32_t>(grid().brickCount() - 1));
    EXPECT_FALSE(refuses({{last, 1}}));
    EXPECT_TRUE(refuses({{last + 1, 1}})) << "outside the grid";
    EXPECT_TRUE(refuses({{last, 1}, {last, 1}})) << "twice";
    EXPECT_TRUE(refuses({{BrickIndex(5), 1}, {BrickIndex(3), 1}})) << "out of order";
    EXPECT_TRUE(refuses({{last, 0}}));
    EXPECT_TRUE(refuses({{last, kMostOfTotal + 1}}));
    EXPECT_TRUE(refuses({{last, -kMostOfTotal - 1}}));
}

// Each bit, each length: whatever is not refused keeps the promises.
TEST(BrickTotals, SurviveDamage) {
    std::mt19937 random(5);
    auto totals = randomTotals(300, random);
    combineTotals(totals);
    const auto bytes = encodeTotals(totals);
    std::vector<BrickTotal> back;
    for (std::size_t length = 0; length < bytes.size(); ++length) {
        const std::vector<std::byte> cut(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(length));
        ASSERT_THAT(decodeTotals(cut, grid(), back, "x"), HasError(ErrorCode::Corruption)) << length;
    }
    int accepted = 0;
    for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
        auto damaged = bytes;
        damaged[bit / 8] ^= std::byte(1 << bit % 8);
        if (!decodeTotals(damaged, grid(), back, "x").isOk())
            continue;
        ++accepted;
        for (std::size_t i = 0; i < back.size(); ++i) {
            ASSERT_LT(back[i].brick.number(), grid().brickCount());
            ASSERT_TRUE(i == 0 || back[i - 1].brick < back[i].brick);
            ASSERT_NE(back[i].count, 0);
        }
    }
    EXPECT_GT(accepted, 0) << "checksums, which are checked before, find those";
}

} // namespace
} // namespace isoslider::index
