// Which closed bricks hold a point, and which of its edges they have.

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "core/extract/live/brick_shapes.h"
#include "core/extract/sources/point_holders.h"

namespace isoslider::extract {
namespace {

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
            std::vector<std::array<std::uint32_t, 2>> found, expected;
            holders.forEach(id, [&](BrickIndex holder, unsigned inside) {
                found.push_back({holder.number(), inside});
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
                    expected.push_back({brick.number(), inside});
            }
            std::sort(found.begin(), found.end());
            ASSERT_EQ(found, expected) << here[0] << " " << here[1] << " " << here[2];
            if (holders.isHeldOnce(id)) {
                ASSERT_EQ(expected, (decltype(expected){{brickOf(id).number(), 63}}));
            }
        }
    }
}

} // namespace
} // namespace isoslider::extract
