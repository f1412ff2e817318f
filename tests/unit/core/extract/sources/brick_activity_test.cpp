// How many active edges bricks have, from records of points and of edges on leaf edges, against samples.

#include <algorithm>
#include <bit>
#include <map>
#include <random>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "core/extract/live/brick_shapes.h"
#include "core/extract/sources/brick_activity.h"

namespace isoslider::extract {
namespace {

using Key = std::uint16_t;
using Part = BlockWalk<Key>::Part;

// Samples of few values, so that many are equal; and what an index states of them.
class SmallVolume {
public:
    SmallVolume(const GridDims& dims, std::mt19937& random) : shapes_(dims, none_) {
        for (std::int64_t i = 0; i < pointCount(dims); ++i)
            samples_.push_back(static_cast<Key>(random() % 12));
    }
    const BrickShapes& shapes() const { return shapes_; }
    const BrickGrid& grid() const { return shapes_.grid(); }
    bool isInside(const std::array<std::int64_t, 3>& p) const {
        const GridDims& dims = grid().dims();
        return p[0] >= 0 && p[1] >= 0 && p[2] >= 0 && p[0] < dims[0] && p[1] < dims[1] && p[2] < dims[2];
    }
    Key at(const std::array<std::int64_t, 3>& p) const {
        const GridDims& dims = grid().dims();
        return samples_[static_cast<std::size_t>(p[0] + dims[0] * (p[1] + dims[1] * p[2]))];
    }
    // Of the closed brick, by its samples.
    std::uint32_t activeEdges(BrickIndex brick, KeyThreshold threshold) const {
        std::uint32_t count = 0;
        const auto origin = shapes_.origin(brick);
        for (std::size_t a = 0; a < 3; ++a)
            forEachSetBit(shapes_.masks(brick).edges[a], [&](ClosedPoint start) {
                const auto c = coordsOf(start);
                std::array<std::int64_t, 3> lower{origin[0] + c[0], origin[1] + c[1], origin[2] + c[2]}, upper = lower;
                ++upper[a];
                count += (at(lower) >= threshold) != (at(upper) >= threshold);
            });
        return count;
    }
    // The records of all points with keys in [lower, upper), in no order.
    index::DecodedPage<Key> page(KeyThreshold lower, KeyThreshold upper, std::mt19937& random) const {
        std::vector<PointId> ids;
        for (std::uint64_t i = 0; i < grid().idCount(); ++i)
            if (const PointId id(i); grid().contains(id))
                if (const Key key = at(grid().pointCoords(id)); key >= lower && key < upper)
                    ids.push_back(id);
        std::shuffle(ids.begin(), ids.end(), random);
        index::DecodedPage<Key> page;
        for (const PointId id : ids) {
            std::uint8_t mask = 0;
            std::uint8_t rising = 0;
            for (unsigned e = 0; e < index::kPointEdges; ++e) {
                auto end = grid().pointCoords(id);
                end[e >> 1] += e & 1 ? 1 : -1;
                if (!isInside(end) || at(end) == at(grid().pointCoords(id)))
                    continue;
                mask |= static_cast<std::uint8_t>(1u << e);
                rising |= static_cast<std::uint8_t>((at(end) > at(grid().pointCoords(id)) ? 1u : 0u) << e);
            }
            if (mask == 0)
                continue;
            page.ids.push_back(id.number());
            page.keys.push_back(at(grid().pointCoords(id)));
            page.masks.push_back(mask);
            page.rising.push_back(rising);
        }
        return page;
    }

private:
    std::vector<index::MissingCells> none_;
    BrickShapes shapes_;
    std::vector<Key> samples_;
};

// In parts, as pages are given out; or, with a size of 0, as totals of pages of some records each.
void addAll(const index::DecodedPage<Key>& decoded, BrickActivity<Key>& counts, std::size_t partSize) {
    index::ChangePage<Key> page;
    page.assign(decoded);
    if (partSize == 0) {
        index::ChangePage<Key> totals;
        std::vector<index::BrickTotal> sums;
        counts.sumUp(page, sums);
        totals.assignTotals(page, sums);
        std::sort(sums.begin(), sums.end(), [](const auto& a, const auto& b) { return a.brick < b.brick; });
        for (std::size_t i = 0; i < sums.size(); ++i) {
            ASSERT_NE(sums[i].count, 0);
            ASSERT_TRUE(i == 0 || sums[i - 1].brick < sums[i].brick);
        }
        return counts.add(Part{totals, 0, 0});
    }
    for (std::size_t begin = 0; begin < page.recordCount(); begin += partSize)
        counts.add(Part{page, begin, std::min(begin + partSize, page.recordCount())});
}

// Dims with points at the end of bricks, and bricks of points only.
const std::vector<GridDims> kVolumes{{17, 20, 24}, {8, 9, 16}, {25, 2, 17}};

// Upwards and downwards, by one value and by many, from nothing too.
TEST(BrickActivity, AreThoseOfSamples) {
    std::mt19937 random(5);
    for (const GridDims& dims : kVolumes) {
        const SmallVolume volume(dims, random);
        BrickActivity<Key> counts(volume.grid(), BrickActivity<Key>::ListOf::Edges);
        KeyThreshold from = 0;
        for (const KeyThreshold to : {5, 6, 3, 4, 12, 7, 0, 1}) {
            const KeyThreshold lower = std::min(from, to), upper = std::max(from, to);
            counts.beginWalk(to > from);
            addAll(volume.page(lower, upper, random), counts, to % 3 == 0 ? 0 : to % 3 == 1 ? 7 : 1000);
            ASSERT_TRUE(counts.apply(counts.changes()));
            for (const BrickIndex brick : firstIds<BrickIndex>(volume.grid().brickCount()))
                if (volume.shapes().hasCells(brick)) {
                    ASSERT_EQ(counts.count(brick), volume.activeEdges(brick, to)) << brick.number() << ", " << to;
                }
            from = to;
        }
        counts.clear();
        for (const BrickIndex brick : firstIds<BrickIndex>(volume.grid().brickCount()))
            ASSERT_EQ(counts.count(brick), 0u);
    }
}

TEST(BrickActivity, ChangeNothingUntilTheyAreApplied) {
    std::mt19937 random(6);
    const SmallVolume volume(kVolumes[0], random);
    BrickActivity<Key> counts(volume.grid(), BrickActivity<Key>::ListOf::Edges);
    counts.beginWalk(true);
    addAll(volume.page(0, 6, random), counts, 100);
    const auto first = counts.changes();
    ASSERT_FALSE(first.empty());
    ASSERT_EQ(counts.count(first.front().brick), 0u);
    ASSERT_TRUE(counts.apply(first));
    const std::uint32_t before = counts.count(first.front().brick);
    counts.beginWalk(true); // ahead of a move that does not come
    addAll(volume.page(6, 9, random), counts, 100);
    ASSERT_FALSE(counts.changes().empty());
    counts.beginWalk(false);
    addAll(volume.page(4, 6, random), counts, 100);
    EXPECT_EQ(counts.count(first.front().brick), before);
    ASSERT_TRUE(counts.apply(counts.changes()));
    for (const BrickIndex brick : firstIds<BrickIndex>(volume.grid().brickCount()))
        if (volume.shapes().hasCells(brick)) {
            ASSERT_EQ(counts.count(brick), volume.activeEdges(brick, 4));
        }
}

// Each thread adds up what it is given; several have changes of the same bricks.
TEST(BrickActivity, AreTheSameFromSeveralThreads) {
    std::mt19937 random(8);
    const SmallVolume volume(kVolumes[0], random);
    BrickActivity<Key> counts(volume.grid(), BrickActivity<Key>::ListOf::Edges);
    index::ChangePage<Key> page;
    page.assign(volume.page(0, 7, random));
    for (int round = 0; round < 3; ++round) { // the tables of threads that are gone are used again
        counts.clear();
        counts.beginWalk(true);
        std::vector<std::jthread> threads;
        for (std::size_t t = 0; t < 4; ++t)
            threads.emplace_back([&, t] {
                for (std::size_t i = t; i < page.recordCount(); i += 4)
                    counts.add(Part{page, i, i + 1});
            });
        threads.clear();
        ASSERT_TRUE(counts.apply(counts.changes()));
        for (const BrickIndex brick : firstIds<BrickIndex>(volume.grid().brickCount()))
            if (volume.shapes().hasCells(brick)) {
                ASSERT_EQ(counts.count(brick), volume.activeEdges(brick, 7)) << brick.number();
            }
    }
}

TEST(BrickDeltas, AddUpInTheOrderInWhichBricksCome) {
    std::mt19937 random(9);
    for (const std::uint32_t bricks : {5u, 3000u, 4'000'000'000u}) {
        BrickDeltas deltas;
        for (int round = 0; round < 2; ++round) {
            std::vector<BrickIndex> order;
            std::map<BrickIndex, std::int32_t> sums;
            for (int i = 0; i < 20'000; ++i) {
                const BrickIndex brick(random() % bricks);
                const auto count = static_cast<std::int32_t>(random() % 13) - 6;
                deltas.add(brick, count);
                if (!sums.contains(brick))
                    order.push_back(brick);
                sums[brick] += count;
            }
            ASSERT_EQ(deltas.size(), order.size());
            std::size_t next = 0;
            deltas.forEach([&](BrickIndex brick, std::int32_t count) {
                ASSERT_EQ(brick, order[next++]);
                ASSERT_EQ(count, sums[brick]);
            });
            deltas.clear();
            EXPECT_EQ(deltas.size(), 0u);
        }
        EXPECT_LT(deltas.memoryBytes(), 16'384 + 64 * std::min<std::size_t>(bricks, 20'000))
            << "in proportion to what it held";
    }
}

TEST(BrickDeltas, StayWithinWhatNumbersHold) {
    BrickDeltas deltas;
    constexpr std::int32_t kMany = 1'000'000'000;
    for (int i = 0; i < 5; ++i) {
        deltas.add(BrickIndex(3), kMany);
        deltas.add(BrickIndex(4), -kMany);
    }
    deltas.forEach(
        [&](BrickIndex brick, std::int32_t count) { EXPECT_GE(brick == BrickIndex(3) ? count : -count, kMany); });
}

// What only a damaged index states.
TEST(BrickActivity, RefuseMoreOrFewerEdgesThanThereCanBe) {
    std::mt19937 random(7);
    const SmallVolume volume(kVolumes[1], random);
    BrickActivity<Key> counts(volume.grid(), BrickActivity<Key>::ListOf::Edges);
    const auto walk = [&](bool goesUp) {
        counts.beginWalk(goesUp);
        addAll(volume.page(0, 6, random), counts, 100);
        return counts.apply(counts.changes());
    };
    EXPECT_FALSE(walk(false));
    EXPECT_EQ(counts.count(BrickIndex(0)), 0u);
    int ups = 0;
    while (ups < 1000 && walk(true))
        ++ups;
    EXPECT_GT(ups, 1);
    EXPECT_LE(ups * volume.activeEdges(BrickIndex(0), 6), std::uint32_t{BrickActivity<Key>::kMostEdges});
}

// Each end of the interval in which an edge carries a vertex on a leaf edge has a record. Leaves are not counted.
TEST(BrickActivity, CountEdgesOnLeafEdges) {
    namespace form = index::record_form;
    const BrickGrid grid({17, 17, 17});
    BrickActivity<Key> counts(grid, BrickActivity<Key>::ListOf::Edges);
    index::DecodedPage<Key> page;
    const auto add = [&](PointId id, std::uint8_t which, Key key, Key other) {
        page.ids.push_back(id.number());
        page.forms.push_back(which);
        page.keys.push_back(key);
        page.masks.push_back(form::maskOf(which));
        page.rising.push_back(other > key ? form::maskOf(which) : std::uint8_t{0});
    };
    add(grid.pointId(8, 3, 8), form::edge(1, 1), 2, 7); // on faces of four bricks
    add(grid.pointId(8, 3, 8), form::edge(0, 2), 3, 7); // of two
    add(grid.pointId(8, 3, 8), form::edge(2, 0), 1, 4); // comes and goes
    add(grid.pointId(8, 3, 8), form::edge(2, 0), 4, 1);
    add(grid.pointId(8, 0, 8), form::leaf(1), 2, 7);
    counts.beginWalk(true);
    addAll(page, counts, 3);
    ASSERT_TRUE(counts.apply(counts.changes()));
    const auto at = [&](int x, int y, int z) { return counts.count(grid.brickAt(x, y, z)); };
    EXPECT_EQ(at(0, 0, 0), 1u);
    EXPECT_EQ(at(1, 0, 0), 2u);
    EXPECT_EQ(at(0, 0, 1), 1u);
    EXPECT_EQ(at(1, 0, 1), 2u);
    EXPECT_EQ(at(0, 1, 0) + at(1, 1, 0) + at(0, 1, 1), 0u);
    counts.beginWalk(false);
    addAll(page, counts, 1);
    ASSERT_TRUE(counts.apply(counts.changes()));
    EXPECT_EQ(at(0, 0, 0) + at(1, 0, 0) + at(0, 0, 1) + at(1, 0, 1), 0u);
}

// A list of bricks: each has a record at its least and one at its greatest key.
TEST(BrickActivity, OfAListOfBricksIsTheirs) {
    const BrickGrid grid({33, 17, 9});
    BrickActivity<Key> activity(grid, BrickActivity<Key>::ListOf::Bricks);
    index::DecodedPage<Key> page;
    const auto add = [&](BrickIndex brick, Key key, Key other) {
        page.ids.push_back(pointIn(brick, LocalPoint()).number());
        page.keys.push_back(key);
        page.masks.push_back(2);
        page.rising.push_back(other > key ? 2 : 0);
    };
    add(BrickIndex(3), 2, 9);
    add(BrickIndex(5), 1, 4); // comes and goes
    add(BrickIndex(5), 4, 1);
    activity.beginWalk(true);
    addAll(page, activity, 0);
    ASSERT_TRUE(activity.apply(activity.changes()));
    EXPECT_EQ(activity.count(BrickIndex(3)), 1u);
    EXPECT_EQ(activity.count(BrickIndex(5)), 0u);
    activity.beginWalk(true);
    addAll(page, activity, 2);
    EXPECT_FALSE(activity.apply(activity.changes())) << "twice";
}

} // namespace
} // namespace isoslider::extract
