// Which edges of the points that a move crosses change, under every instruction set that the machine has, against plain
// code; and which bricks hold the points.

#include <algorithm>
#include <bit>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/extract/live/brick_shapes.h"
#include "core/extract/sources/edge_change_kernels.h"
#include "core/extract/sources/point_holders.h"
#include "core/extract/sources/sample_kernels.h"

namespace isoslider::extract {
namespace {

class EdgeChangeKernels : public testing::TestWithParam<std::size_t> {
protected:
    void SetUp() override { useKernelTarget(GetParam()); }
    void TearDown() override { useKernelTarget(0); }
    std::mt19937 random_{5};
};

std::string setName(const testing::TestParamInfo<std::size_t>& info) { return kernelTargets().at(info.param); }
INSTANTIATE_TEST_SUITE_P(Targets, EdgeChangeKernels, testing::Range(std::size_t{0}, kernelTargets().size()), setName);

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

TEST_P(EdgeChangeKernels, FindsTheEdgesThatChange) {
    expectSameEdges<std::uint16_t>(random_);
    expectSameEdges<std::uint32_t>(random_);
    expectSameEdges<std::uint64_t>(random_);
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

} // namespace
} // namespace isoslider::extract
