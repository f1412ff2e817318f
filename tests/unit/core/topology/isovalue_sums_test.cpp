// Changes in the order of isovalues, and summed up while they come.

#include <algorithm>
#include <bit>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <random>
#include <tuple>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/topology/analysis/isovalue_order.h"
#include "core/topology/analysis/isovalue_sums.h"
#include "tests/support/result_matchers.h"
#include "tests/support/temporary_folder.h"

namespace isoslider::topology {
namespace {

struct Item {
    double isovalue;
    int number;
};

TEST(IsovalueOrder, IsThatOfAStableSort) {
    std::mt19937_64 random(1);
    IsovalueOrder order;
    for (const std::size_t count : {0u, 1u, 17u, 255u, 256u, 5000u, 1000u}) // the memory of a longer one is used again
        for (const int kind : {0, 1, 2, 3, 4, 5}) {
            std::vector<Item> items;
            for (std::size_t i = 0; i < count; ++i) {
                const double any = std::bit_cast<double>(random());
                const double value = kind == 0   ? 7.5
                                     : kind == 1 ? static_cast<double>(random() % 20) - 10.0
                                     : kind == 2 ? static_cast<double>(static_cast<std::int64_t>(random()))
                                     : kind == 4 ? (random() % 30 == 0 ? -1e300 : 1.0) +
                                                       static_cast<double>(random() % 50) * 0x1p-52 // side by side
                                     : kind == 5          ? 1000.0 + static_cast<double>(random() % 70000) / 64.0
                                     : std::isfinite(any) ? any
                                                          : std::numeric_limits<double>::lowest();
                items.push_back({i % 9 == 8 ? -0.0 * value : value, static_cast<int>(i)});
            }
            std::vector<Item> expected = items;
            std::stable_sort(expected.begin(), expected.end(),
                             [](const Item& a, const Item& b) { return a.isovalue < b.isovalue; });
            const auto places = order.of(items);
            ASSERT_EQ(places.size(), items.size());
            for (std::size_t i = 0; i < count; ++i)
                ASSERT_EQ(items[places[i]].number, expected[i].number) << kind << ", " << i << " of " << count;
            order.sort(items);
            for (std::size_t i = 0; i < count; ++i)
                ASSERT_EQ(items[i].number, expected[i].number);
        }
}

template <class Change>
std::vector<Change> allOf(SortedChanges<Change> changes) {
    std::vector<Change> all;
    while (changes.isovalue() < std::numeric_limits<double>::infinity())
        changes.takeAt(changes.isovalue(), [&](const Change& change) { all.push_back(change); });
    EXPECT_THAT(changes.status(), test::IsOk());
    return all;
}

TEST(IsovalueSums, AddUpChangesOfTheEulerNumberPartByPart) {
    std::mt19937 random(2);
    IsovalueSums<EulerChange> sums;
    std::map<std::pair<double, bool>, std::int64_t> expected;
    for (int part = 0; part < 50; ++part) {
        std::vector<EulerChange> changes;
        for (int i = 0; i < 3000; ++i) {
            const double isovalue = static_cast<double>(random() % 4000) / 8.0 - 100.0;
            const bool isVertex = random() % 2 == 0;
            const Point point = random();
            const auto euler = static_cast<std::int64_t>(random() % 5) - 2;
            if (euler == 0)
                continue;
            changes.emplace_back(isovalue, isVertex ? Cause::vertex(point) : Cause::saddle(point, 3), euler);
            expected[{isovalue, isVertex}] += euler;
        }
        ASSERT_THAT(sums.add(changes), test::IsOk());
        EXPECT_LE(sums.count(), 8000u + 8000u / 3 + (1u << 15) + 3000u) << "not all that came";
    }
    const std::vector<EulerChange> found = allOf(sums.take()); // also what cancels out
    ASSERT_EQ(found.size(), expected.size());
    EXPECT_TRUE(std::is_sorted(found.begin(), found.end(),
                               [](const EulerChange& a, const EulerChange& b) { return a.isovalue < b.isovalue; }));
    for (const EulerChange& change : found)
        EXPECT_EQ(change.euler(), (expected[{change.isovalue, change.cause().isVertex()}])) << change.isovalue;
}

// What is summed up does not depend on how it came, nor does the cause.
TEST(IsovalueSums, AreTheSameInAnyOrderAndParts) {
    std::mt19937 random(7);
    std::vector<EulerChange> changes;
    for (int i = 0; i < 60'000; ++i)
        changes.emplace_back(static_cast<double>(random() % 3000), Cause::vertex(random() % 100'000),
                             static_cast<std::int64_t>(random() % 5) - 2);
    std::vector<std::vector<EulerChange>> found;
    for (const std::size_t together : {60'000u, 17'000u, 900u}) {
        IsovalueSums<EulerChange> sums;
        for (std::size_t from = 0; from < changes.size(); from += together) {
            std::vector<EulerChange> part(changes.begin() + static_cast<std::ptrdiff_t>(from),
                                          changes.begin() +
                                              static_cast<std::ptrdiff_t>(std::min(from + together, changes.size())));
            IsovalueOrder().sort(part);
            sumUp(part);
            ASSERT_THAT(sums.add(part), test::IsOk());
        }
        found.push_back(allOf(sums.take()));
        ASSERT_EQ(found.back().size(), found.front().size());
        for (std::size_t i = 0; i < found.back().size(); ++i) {
            EXPECT_EQ(found.back()[i].euler(), found.front()[i].euler());
            EXPECT_EQ(found.back()[i].cause(), found.front()[i].cause()) << found.back()[i].isovalue;
        }
        std::shuffle(changes.begin(), changes.end(), random);
    }
}

// Of a component that comes, by grid points and by saddles.
using Totals = std::map<std::pair<double, bool>, std::tuple<std::uint64_t, std::uint64_t, double, std::uint64_t>>;
void note(Totals& totals, const ComponentChange& change) {
    auto& [count, closed, persistence, point] = totals[{change.isovalue, change.cause.isVertex()}];
    if (change.persistence > persistence || count == 0)
        point = change.cause.point();
    else if (change.persistence == persistence)
        point = std::min(point, change.cause.point());
    persistence = std::max(persistence, change.persistence);
    count += change.count;
    closed += change.closed;
}

TEST(IsovalueSums, GoToAFileWhereMemoryDoesNotHoldThem) {
    const test::TemporaryFolder folder;
    for (const std::size_t most : {1000u, 20'000u, 300'000u}) {
        ScratchFile scratch(folder / "changes");
        std::mt19937 random(3);
        IsovalueSums<ComponentChange> sums({&scratch, most}), held;
        IsovalueSums<EulerChange> beside({&scratch, most}); // in the same file
        Totals expected;
        std::int64_t euler = 0;
        for (int part = 0; part < 30; ++part) {
            std::vector<ComponentChange> changes;
            std::vector<EulerChange> others;
            const unsigned count = 1 + static_cast<unsigned>(random() % 3000);
            for (unsigned i = 0; i < count; ++i) {
                const double isovalue = static_cast<double>(random() % 9000) / 8.0 - 100.0;
                const Cause cause = random() % 2 == 0 ? Cause::vertex(random()) : Cause::saddle(random(), 3);
                changes.push_back({isovalue, static_cast<double>(random() % 100), cause, 1,
                                   static_cast<std::uint32_t>(random() % 2)});
                note(expected, changes.back());
                others.emplace_back(-isovalue, cause, 2);
                euler += 2;
            }
            ASSERT_THAT(sums.add(changes), test::IsOk());
            ASSERT_THAT(beside.add(others), test::IsOk());
            ASSERT_THAT(held.add(changes), test::IsOk());
            EXPECT_LE(sums.count() * sizeof(ComponentChange), 2 * most + changes.size() * sizeof(ComponentChange));
        }
        EXPECT_GT(sums.spilledCount(), 0u);
        EXPECT_EQ(held.spilledCount(), 0u);
        const std::vector<ComponentChange> found = allOf(sums.take()), whole = allOf(held.take());
        EXPECT_TRUE(std::is_sorted(found.begin(), found.end(), [](const ComponentChange& a, const ComponentChange& b) {
            return a.isovalue < b.isovalue;
        }));
        EXPECT_GE(found.size(), whole.size());
        for (const auto* each : {&found, &whole}) {
            Totals totals;
            for (const ComponentChange& change : *each)
                note(totals, change);
            EXPECT_EQ(totals, expected);
        }
        std::int64_t eulerFound = 0;
        for (const EulerChange& change : allOf(beside.take()))
            eulerFound += change.euler();
        EXPECT_EQ(eulerFound, euler);
    }
    EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(IsovalueSums, ReportAFileThatCannotBeWritten) {
    ScratchFile scratch("/nowhere/at/all");
    IsovalueSums<ClosedChange> sums({&scratch, 1000});
    EXPECT_THAT(sums.add(std::vector<ClosedChange>(10, {1.0, 1})), test::IsOk()) << "nothing to write yet";
    std::vector<ClosedChange> many;
    for (int i = 0; i < 1000; ++i)
        many.push_back({static_cast<double>(i), 1});
    EXPECT_THAT(sums.add(many), test::HasError(ErrorCode::NotFound));
}

TEST(IsovalueSums, AddUpComponentsThatReachTheBoundary) {
    std::vector<ClosedChange> changes{{1.0, 2}, {1.0, 3}, {2.0, 1}, {4.0, 1}, {4.0, 7}};
    sumUp(changes);
    ASSERT_EQ(changes.size(), 3u);
    EXPECT_EQ(changes[0].count, 5u);
    EXPECT_EQ(changes[1].count, 1u);
    EXPECT_EQ(changes[2].count, 8u);
}

TEST(IsovalueSums, KeepLargeChangesInParts) {
    std::vector<EulerChange> changes(5, EulerChange(1.0, Cause::vertex(77), -EulerChange::kMost));
    changes.emplace_back(1.0, Cause::saddle(5, 1), 3);
    changes.emplace_back(2.0, Cause::vertex(77), EulerChange::kMost);
    sumUp(changes);
    std::map<std::pair<double, bool>, std::int64_t> found;
    for (const EulerChange& change : changes)
        found[{change.isovalue, change.cause().isVertex()}] += change.euler();
    EXPECT_EQ(found,
              (std::map<std::pair<double, bool>, std::int64_t>{
                  {{1.0, true}, -5 * EulerChange::kMost}, {{1.0, false}, 3}, {{2.0, true}, EulerChange::kMost}}));
    EXPECT_EQ(changes.front().cause(), Cause::saddle(5, 1));
    EXPECT_EQ(changes.back().cause(), Cause::vertex(77));
}

TEST(IsovalueSums, NameThePieceThatLastsLongest) {
    std::vector<ComponentChange> changes{{1.0, 2.0, Cause::vertex(4), 1, 0},
                                         {1.0, 5.0, Cause::vertex(9), 2, 1},
                                         {1.0, 9.0, Cause::saddle(1, 2), 1, 1},
                                         {1.0, 5.0, Cause::vertex(3), 1, 1},
                                         {3.0, 1.0, Cause::vertex(2), 1, 0}};
    sumUp(changes);
    ASSERT_EQ(changes.size(), 3u);
    EXPECT_EQ(changes[0].cause, Cause::saddle(1, 2));
    EXPECT_EQ(changes[1].cause, Cause::vertex(3)) << "of two that last as long the first";
    EXPECT_EQ(changes[1].persistence, 5.0);
    EXPECT_EQ(changes[1].count, 4u);
    EXPECT_EQ(changes[1].closed, 2u);
    EXPECT_EQ(changes[2].isovalue, 3.0);
}

} // namespace
} // namespace isoslider::topology
