#include "core/grid/brick_grid.h"

#include <gtest/gtest.h>

namespace isoslider {
namespace {

TEST(BrickGrid, NamesEachBrickAndPointByItsCoordinates) {
    for (const GridDims& dims : {GridDims{1, 1, 1}, {8, 9, 7}, {40, 1, 23}, {1, 65, 9}, {33, 26, 41}}) {
        const BrickGrid grid(dims);
        BrickIndex next;
        for (std::int64_t z = 0; z < grid.bricks()[2]; ++z)
            for (std::int64_t y = 0; y < grid.bricks()[1]; ++y)
                for (std::int64_t x = 0; x < grid.bricks()[0]; ++x, ++next) {
                    ASSERT_EQ(grid.brickAt(x, y, z), next);
                    ASSERT_EQ(grid.brickCoords(next), (std::array<std::int64_t, 3>{x, y, z}));
                }
        EXPECT_EQ(next.number(), grid.brickCount());
        for (std::int64_t z = 0; z < dims[2]; ++z)
            for (std::int64_t y = 0; y < dims[1]; ++y)
                for (std::int64_t x = 0; x < dims[0]; ++x) {
                    const PointId id = grid.pointId(x, y, z);
                    ASSERT_EQ(grid.pointCoords(id), (std::array<std::int64_t, 3>{x, y, z}));
                    ASSERT_TRUE(grid.contains(id));
                }
    }
}

// Nearly as many bricks as there may be.
TEST(BrickGrid, FindsTheLastBrickOfALargeGrid) {
    for (const GridDims& dims : {GridDims{std::int64_t{1} << 20, (std::int64_t{1} << 18) - 8, 8},
                                 {8, std::int64_t{1} << 20, (std::int64_t{1} << 18) - 8},
                                 {13001, 13003, 12991}}) {
        const BrickGrid grid(dims);
        ASSERT_LT(grid.brickCount(), std::uint64_t{1} << 32);
        const PointId last = grid.pointId(dims[0] - 1, dims[1] - 1, dims[2] - 1);
        EXPECT_EQ(grid.pointCoords(last), (std::array<std::int64_t, 3>{dims[0] - 1, dims[1] - 1, dims[2] - 1}));
        EXPECT_EQ(brickOf(last).number(), grid.brickCount() - 1);
        EXPECT_FALSE(grid.contains(last + 512));
    }
}

} // namespace
} // namespace isoslider
