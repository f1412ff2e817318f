// What an index of edges makes of the points that a move crosses, under every instruction set that the machine has,
// against plain code.

#include <algorithm>
#include <bit>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/extract/live/brick_shapes.h"
#include "core/extract/sources/crossed_points.h"
#include "core/extract/sources/edge_kernels.h"
#include "core/extract/sources/sample_kernels.h"

namespace isoslider::extract {
namespace {

class EdgeKernels : public testing::TestWithParam<std::size_t> {
protected:
    void SetUp() override { useKernelTarget(GetParam()); }
    void TearDown() override { useKernelTarget(0); }
    std::mt19937 random_{5};
};

std::string setName(const testing::TestParamInfo<std::size_t>& info) { return kernelTargets().at(info.param); }
INSTANTIATE_TEST_SUITE_P(Targets, EdgeKernels, testing::Range(std::size_t{0}, kernelTargets().size()), setName);

// Columns end at the last far key: nothing behind it is read, which sanitizers see.
template <class Key>
void expectSameEdges(std::mt19937& random) {
    constexpr Key kMost = std::numeric_limits<Key>::max();
    const std::vector<KeyThreshold> thresholds{0, 1, 7, 8, 1000, KeyThreshold{kMost} - 1, kMost};
    for (const std::size_t points : {0, 1, 2, 3, 17, 300})
        for (std::size_t l = 0; l + 1 < thresholds.size(); ++l)
            for (std::size_t u = l + 1; u < thresholds.size(); ++u) {
                std::vector<std::uint8_t> masks(points);
                std::vector<Key> far;
                for (std::uint8_t& mask : masks) {
                    mask = static_cast<std::uint8_t>(random() % 63 + 1);
                    for (int left = std::popcount(unsigned{mask}); left > 0; --left)
                        far.push_back(static_cast<Key>(thresholds[random() % thresholds.size()] + random() % 3));
                }
                std::vector<std::uint8_t> above(points), below(points), plainAbove(points), plainBelow(points);
                findChangedEdges<Key>(masks, far, thresholds[l], thresholds[u], above.data(), below.data());
                findChangedEdgesReference<Key>(masks, far, thresholds[l], thresholds[u], plainAbove.data(),
                                               plainBelow.data());
                ASSERT_EQ(above, plainAbove) << points << " points, " << thresholds[l] << " to " << thresholds[u];
                ASSERT_EQ(below, plainBelow);
            }
}

TEST_P(EdgeKernels, FindsTheEdgesThatChange) {
    expectSameEdges<std::uint16_t>(random_);
    expectSameEdges<std::uint32_t>(random_);
    expectSameEdges<std::uint64_t>(random_);
}

// A small volume of samples with many ties, and what records and bricks say of it.
class SmallVolume {
public:
    SmallVolume(const GridDims& dims, std::mt19937& random)
        : shapes_(dims, none_), samples_(static_cast<std::size_t>(dims[0] * dims[1] * dims[2])) {
        for (int& sample : samples_)
            sample = static_cast<int>(random() % 12);
    }
    const BrickShapes& shapes() const { return shapes_; }
    bool isInside(const std::array<std::int64_t, 3>& p) const {
        const GridDims& dims = shapes_.grid().dims();
        return p[0] >= 0 && p[1] >= 0 && p[2] >= 0 && p[0] < dims[0] && p[1] < dims[1] && p[2] < dims[2];
    }
    int at(const std::array<std::int64_t, 3>& p) const {
        const GridDims& dims = shapes_.grid().dims();
        return samples_[static_cast<std::size_t>(p[0] + dims[0] * (p[1] + dims[1] * p[2]))];
    }
    std::array<std::int64_t, 3> placeOf(BrickIndex brick, ClosedPoint point) const {
        const auto origin = shapes_.origin(brick);
        const auto c = coordsOf(point);
        return {origin[0] + c[0], origin[1] + c[1], origin[2] + c[2]};
    }
    // Active edges of the brick's cells, by their samples.
    std::array<BitString, 3> edgesOf(BrickIndex brick, int threshold) const {
        std::array<BitString, 3> edges;
        for (std::size_t a = 0; a < 3; ++a)
            forEachSetBit(shapes_.masks(brick).edges[a], [&](ClosedPoint start) {
                const auto lower = placeOf(brick, start), upper = placeOf(brick, start + kPointStride[a]);
                if ((at(lower) >= threshold) != (at(upper) >= threshold))
                    edges[a].set(start);
            });
        return edges;
    }

private:
    std::vector<index::MissingCells> none_;
    BrickShapes shapes_;
    std::vector<int> samples_;
};

// The points that a move crosses, by closed brick, as records have them.
std::vector<std::vector<CrossedEdges>> crossedPoints(const SmallVolume& volume, int from, int to) {
    const BrickGrid& grid = volume.shapes().grid();
    const PointHolders holders(grid);
    std::vector<std::vector<CrossedEdges>> crossed(grid.brickCount());
    const int lower = std::min(from, to), upper = std::max(from, to);
    for (std::uint64_t i = 0; i < grid.idCount(); ++i) {
        const PointId id(i);
        if (!grid.contains(id))
            continue;
        const auto here = grid.pointCoords(id);
        if (volume.at(here) < lower || volume.at(here) >= upper)
            continue;
        unsigned activated = 0, deactivated = 0;
        for (unsigned e = 0; e < 6; ++e) {
            auto far = here;
            far[e >> 1] += e & 1 ? 1 : -1;
            if (!volume.isInside(far) || (volume.at(far) >= lower && volume.at(far) < upper))
                continue;
            ((volume.at(far) >= upper) == (to > from) ? activated : deactivated) |= 1u << e;
        }
        holders.forEach(id, [&](BrickIndex holder, ClosedPoint point, unsigned inside) {
            CrossedEdges edges{};
            edges.brick = holder;
            edges.point = point;
            edges.activated = static_cast<std::uint8_t>(activated & inside);
            edges.deactivated = static_cast<std::uint8_t>(deactivated & inside);
            crossed[holder.index()].push_back(edges);
        });
    }
    return crossed;
}

// Dims with points at the end of bricks, and bricks of points only.
const std::vector<GridDims> kDims{{17, 20, 24}, {8, 9, 16}, {25, 2, 17}};

TEST(PointHolders, AreTheClosedBricksWithCellsThatHoldIt) {
    const std::vector<index::MissingCells> none;
    for (const GridDims& dims : kDims) {
        const BrickShapes shapes(dims, none);
        const BrickGrid& grid = shapes.grid();
        const PointHolders holders(grid);
        for (std::uint64_t i = 0; i < grid.idCount(); ++i) {
            const PointId id(i);
            if (!grid.contains(id))
                continue;
            const auto here = grid.pointCoords(id);
            std::vector<std::array<std::uint32_t, 3>> found, expected;
            holders.forEach(id, [&](BrickIndex holder, ClosedPoint point, unsigned inside) {
                found.push_back({holder.number(), point.number(), inside});
            });
            for (const BrickIndex brick : firstIds<BrickIndex>(grid.brickCount())) {
                const auto origin = shapes.origin(brick);
                std::array<std::int64_t, 3> c{};
                bool isHeld = shapes.hasCells(brick);
                unsigned inside = 0;
                for (std::size_t a = 0; a < 3; ++a) {
                    c[a] = here[a] - origin[a];
                    isHeld = isHeld && c[a] >= 0 && c[a] <= kCellSide;
                    inside |= unsigned{c[a] > 0} << (2 * a) | unsigned{c[a] < kCellSide} << (2 * a + 1);
                }
                if (isHeld)
                    expected.push_back(
                        {brick.number(),
                         closedPoint(static_cast<int>(c[0]), static_cast<int>(c[1]), static_cast<int>(c[2])).number(),
                         inside});
            }
            std::sort(found.begin(), found.end());
            ASSERT_EQ(found, expected) << here[0] << " " << here[1] << " " << here[2];
            if (holders.isHeldOnce(id)) {
                ASSERT_EQ(expected, (decltype(expected){{brickOf(id).number(),
                                                         PointHolders::closedPointOf(localOf(id)).number(), 63}}));
            }
        }
    }
}

// Upwards and downwards, by one value and by many, from nothing too.
TEST_P(EdgeKernels, BringEdgesAndSignsToWhereSamplesHaveThem) {
    for (const GridDims& dims : kDims) {
        const SmallVolume volume(dims, random_);
        const BrickShapes& shapes = volume.shapes();
        for (const auto& step : {std::pair{0, 5}, {5, 6}, {6, 3}, {3, 4}, {4, 12}, {12, 7}, {7, 0}}) {
            const int from = step.first, to = step.second;
            const auto crossed = crossedPoints(volume, from, to);
            for (const BrickIndex brick : firstIds<BrickIndex>(shapes.grid().brickCount())) {
                if (!shapes.hasCells(brick)) {
                    ASSERT_TRUE(crossed[brick.index()].empty());
                    continue;
                }
                const BrickMasks& masks = shapes.masks(brick);
                const auto before = volume.edgesOf(brick, from), after = volume.edgesOf(brick, to);
                BitString aboveBefore; // known at the ends of edges
                BitString ends;
                endsOfEdges(before, ends);
                forEachSetBit(ends, [&](ClosedPoint p) {
                    if (volume.at(volume.placeOf(brick, p)) >= from)
                        aboveBefore.set(p);
                });
                ToggledEdges toggled;
                listToggledEdges(crossed[brick.index()].data(), sizeof(CrossedEdges), crossed[brick.index()].size(),
                                 masks, to > from, toggled);
                auto edges = before;
                ChangedBrick changed;
                changeEdges(toggled, masks, aboveBefore, edges, changed);
                ASSERT_TRUE(changed.isConsistent && changed.isOfSigns);
                ASSERT_EQ(edges, after) << from << " to " << to;
                std::uint32_t owned = 0;
                BitString corners;
                for (std::size_t a = 0; a < 3; ++a)
                    forEachSetBit(after[a], [&](ClosedPoint start) { owned += unsigned{masks.owned[a].test(start)}; });
                ASSERT_EQ(changed.ownedEdges, owned);
                forEachSetBit(masks.cells, [&](ClosedPoint cell) {
                    int above = 0;
                    bool isToggled = false;
                    for (unsigned c = 0; c < 8; ++c) {
                        const ClosedPoint p =
                            cell + ((c & 1) + kPointStride[1] * (c >> 1 & 1) + kPointStride[2] * (c >> 2));
                        above += volume.at(volume.placeOf(brick, p)) >= to;
                        for (std::size_t a = 0; a < 3; ++a)
                            if ((c >> a & 1) == 0)
                                isToggled |= before[a].test(p) != after[a].test(p);
                    }
                    EXPECT_EQ(changed.signs.cells.test(cell), above > 0 && above < 8);
                    EXPECT_TRUE(changed.changed.test(cell) || !isToggled);
                    if (above == 0 || above == 8)
                        return;
                    for (unsigned c = 0; c < 8; ++c) {
                        const ClosedPoint p =
                            cell + ((c & 1) + kPointStride[1] * (c >> 1 & 1) + kPointStride[2] * (c >> 2));
                        EXPECT_EQ(changed.signs.above.test(p), volume.at(volume.placeOf(brick, p)) >= to);
                    }
                });
                if (HasFailure())
                    return;
            }
        }
    }
}

// What no index states unless it is damaged.
TEST_P(EdgeKernels, SeeEdgesThatBecomeWhatTheyWereAndEdgesOfNoSamples) {
    const SmallVolume volume({17, 17, 17}, random_);
    const BrickIndex brick(0);
    const BrickMasks& masks = volume.shapes().masks(brick);
    const auto crossed = crossedPoints(volume, 0, 6)[0];
    ToggledEdges toggled;
    listToggledEdges(crossed.data(), sizeof(CrossedEdges), crossed.size(), masks, true, toggled);
    std::array<BitString, 3> edges;
    ChangedBrick changed;
    changeEdges(toggled, masks, {}, edges, changed);
    ASSERT_TRUE(changed.isConsistent && changed.isOfSigns);
    const EdgeSigns signs = changed.signs;
    ASSERT_TRUE(areEdgesOfSigns(edges, signs));

    auto again = edges;
    changeEdges(toggled, masks, signs.above, again, changed);
    EXPECT_FALSE(changed.isConsistent) << "active edges become active";
    std::swap(toggled.activated, toggled.deactivated);
    again = {};
    changeEdges(toggled, masks, {}, again, changed);
    EXPECT_FALSE(changed.isConsistent) << "inactive edges become inactive";

    for (std::size_t a = 0; a < 3; ++a) {
        auto odd = edges;
        const ClosedPoint start = closedPoint(3, 4, 5);
        odd[a].flip(start); // four faces with an odd number of active edges
        EXPECT_FALSE(areEdgesOfSigns(odd, signs)) << a;
    }
}

TEST_P(EdgeKernels, SpreadSignsAlongEdgesThatAreStill) {
    // A row of points along each axis, of which only the first is known to be above, and every edge between them still.
    for (std::size_t a = 0; a < 3; ++a) {
        std::array<BitString, 3> still;
        BitString seeds;
        const ClosedPoint first(4 * (kPointStride[0] + kPointStride[1] + kPointStride[2]) - 4 * kPointStride[a]);
        for (int i = 0; i < kCellSide; ++i)
            still[a].set(first + i * kPointStride[a]);
        seeds.set(first + 3 * kPointStride[a]);
        EdgeSigns signs;
        spreadSigns({}, still, seeds, {}, 2, signs);
        EXPECT_EQ(signs.above.count(), 5) << a;
        spreadSigns({}, still, seeds, {}, kClosedPoints, signs);
        EXPECT_EQ(signs.above.count(), kPointSide) << a;
        for (int i = 0; i < kPointSide; ++i)
            EXPECT_TRUE(signs.above.test(first + i * kPointStride[a])) << a;
    }
}

} // namespace
} // namespace isoslider::extract
