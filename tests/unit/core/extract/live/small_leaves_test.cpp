// What lies around a brick's leaves, and the polygons of those of side 2, against what they stand for.

#include <algorithm>
#include <array>
#include <bit>
#include <functional>
#include <limits>
#include <random>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "core/cell/merged_cell.h"
#include "core/extract/live/leaves_around.h"
#include "core/extract/live/pair_cells.h"
#include "core/extract/live/small_leaf_polygons.h"
#include "tests/unit/core/extract/some_leaves.h"

namespace isoslider::extract {
namespace {

BitString someSigns(std::mt19937& random) {
    BitString above;
    for (int p = 0; p < kClosedPoints; ++p)
        if (random() % 2 != 0)
            above.set(ClosedPoint(p));
    return above;
}

/// A brick somewhere in a grid of three bricks along each axis, which may end inside the last ones.
struct Neighbourhood {
    GridDims dims;
    std::array<std::int32_t, 3> origin;
    std::array<BrickLeaves, 27> leaves; ///< around the brick, by step
    std::array<bool, 27> isLive;

    explicit Neighbourhood(std::mt19937& random) {
        for (std::size_t a = 0; a < 3; ++a) {
            dims[a] = static_cast<std::int64_t>(18 + random() % 8); // 17 to 24 cells
            origin[a] = static_cast<std::int32_t>(8 * (random() % 3));
        }
        for (BrickLeaves& each : leaves)
            each = someLeaves(random);
        for (bool& each : isLive)
            each = random() % 5 != 0;
        isLive[13] = true;
    }
    static std::size_t numberOf(const BrickStep& step) {
        return static_cast<std::size_t>(step[0] + 1 + 3 * (step[1] + 1) + 9 * (step[2] + 1));
    }
    void fill(LeavesAround& around, const BitString& above) const {
        around.fill(dims, origin, above, [this](const BrickStep& step) {
            return isLive[numberOf(step)] ? &leaves[numberOf(step)] : nullptr;
        });
    }
    bool isInBox(const std::array<int, 3>& cell) const {
        for (std::size_t a = 0; a < 3; ++a)
            if (origin[a] + cell[a] < 0 || origin[a] + cell[a] >= dims[a] - 1)
                return false;
        return true;
    }
    int levelOf(const std::array<int, 3>& cell) const {
        BrickStep step;
        std::array<int, 3> inside;
        for (std::size_t a = 0; a < 3; ++a) {
            step[a] = cell[a] < 0 ? -1 : cell[a] < 8 ? 0 : 1;
            inside[a] = cell[a] - 8 * step[a];
        }
        if (!isInBox(cell))
            return kNoLevel;
        return isLive[numberOf(step)] ? leaves[numberOf(step)].levelOf(inside[0], inside[1], inside[2]) : 0;
    }
};

bool isAcrossCorner(const std::array<int, 3>& cell, int last) {
    return std::all_of(cell.begin(), cell.end(), [&](int at) { return at < 0 || at > last; });
}

TEST(LeavesAround, KnowLevelsInTheBrickAndOneCellBeyond) {
    std::mt19937 random(11);
    int outside = 0, beyond = 0;
    for (int round = 0; round < 200; ++round) {
        const Neighbourhood neighbourhood(random);
        const BitString above;
        LeavesAround around;
        neighbourhood.fill(around, above);
        for (int i = 0; i < 1000; ++i) {
            const std::array<int, 3> cell{i % 10 - 1, i / 10 % 10 - 1, i / 100 - 1};
            if (isAcrossCorner(cell, 7))
                continue;
            const int expected = neighbourhood.levelOf(cell);
            ASSERT_EQ(around.levelAt(i), expected) << cell[0] << ' ' << cell[1] << ' ' << cell[2];
            outside += expected == kNoLevel;
            beyond += cell[0] < 0 || cell[0] > 7;
        }
        for (int i = 0; i < 64; ++i) {
            const int x = i % 4, y = i / 4 % 4, z = i / 16;
            const std::uint64_t unmerged = around.unmergedAround(x, y, z);
            for (int k = 0; k < 27; ++k) {
                const std::array<int, 3> step{k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1},
                    pair{x + step[0], y + step[1], z + step[2]};
                if (isAcrossCorner(pair, 3))
                    continue;
                std::array<int, 3> first;
                for (std::size_t a = 0; a < 3; ++a)
                    first[a] = pair[a] < 0 ? -1 : 2 * pair[a]; // its cell nearest to the brick's
                ASSERT_EQ(unmerged >> LeavesAround::beside(step[0], step[1], step[2]) & 1,
                          std::uint64_t{neighbourhood.levelOf(first) == 0});
            }
        }
    }
    EXPECT_GT(outside, 1000);
    EXPECT_GT(beyond, 1000);
}

TEST(PairCells, AreTheirEightCellsTogether) {
    std::mt19937_64 random(12);
    for (int round = 0; round < 100; ++round) {
        const std::uint64_t pairs = random() & (round % 2 == 0 ? ~std::uint64_t{0} : random());
        const BitString cells = cellsOfPairs(pairs);
        EXPECT_EQ(anyOfEight(cells), pairs);
        EXPECT_EQ(allOfEight(cells), pairs);
        EXPECT_EQ(cells.count(), 8 * std::popcount(pairs));
        BitString fewer = cells;
        std::uint64_t still = pairs;
        for (int i = 0; i < 64; ++i)
            if ((pairs >> i & 1) != 0 && random() % 2 == 0) {
                const unsigned k = static_cast<unsigned>(random() % 8);
                fewer.flip(closedPoint(2 * (i % 4) + static_cast<int>(k & 1),
                                       2 * (i / 4 % 4) + static_cast<int>(k >> 1 & 1),
                                       2 * (i / 16) + static_cast<int>(k >> 2)));
                still &= ~(std::uint64_t{1} << i);
            }
        EXPECT_EQ(anyOfEight(fewer), pairs);
        EXPECT_EQ(allOfEight(fewer), still);
    }
}

/// Signs of a wavy plane through the brick: leaves of side 2 in it mostly keep topology.
BitString signsOfPlane(std::mt19937& random) {
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    const double a = uniform(random), b = uniform(random), c = uniform(random), noise = 0.5 * uniform(random);
    BitString above;
    for (int p = 0; p < kClosedPoints; ++p) {
        const auto at = coordsOf(ClosedPoint(p));
        if (a * (at[0] - 4) + b * (at[1] - 4) + c * (at[2] - 4) + noise * uniform(random) >= 0.0)
            above.set(ClosedPoint(p));
    }
    return above;
}

// A table lookup and the polygon that is made for the leaf alone: the same edges, levels and triangles.
TEST(SmallLeafPolygons, AreThoseOfMergedPolygon) {
    std::mt19937 random(13);
    SmallLeafPolygons polygons;
    MergedPolygon<LeavesAround> oracle;
    std::size_t checked = 0, split = 0, mostCorners = 0;
    for (int round = 0; round < 3000; ++round) {
        const Neighbourhood neighbourhood(random);
        const BitString above = round % 8 == 0 ? someSigns(random) : signsOfPlane(random);
        LeavesAround around;
        neighbourhood.fill(around, above);
        for (int i = 0; i < 64; ++i) {
            const int x = i % 4, y = i / 4 % 4, z = i / 16;
            const ClosedPoint first = closedPoint(2 * x, 2 * y, 2 * z);
            const std::uint32_t signs = signsOfPair(above, first);
            if (neighbourhood.levelOf({2 * x, 2 * y, 2 * z}) != 1 ||
                !neighbourhood.isInBox({2 * x + 1, 2 * y + 1, 2 * z + 1}) || signs == 0 || signs == cell::kAllAbove ||
                !cell::keepsTopology(signs))
                continue;
            const SmallLeafPolygons::Leaf leaf = SmallLeafPolygons::leafAt(around, x, y, z);
            const SmallLeafPolygons::Polygon polygon = polygons.find(around, leaf);
            oracle.make(around, {first.number(), LeavesAround::cellAt(first.number()), 1});
            ASSERT_EQ(polygon.edges.size(), oracle.corners().size());
            ASSERT_EQ(polygon.triangles.size(), 3 * oracle.triangles().size());
            for (std::size_t k = 0; k < polygon.edges.size(); ++k) {
                const std::int64_t edge = oracle.corners()[k];
                ASSERT_EQ(SmallLeafPolygons::edgeOf(polygon.edges[k], leaf),
                          closedEdge(static_cast<int>(edge & 3), ClosedPoint(static_cast<int>(edge >> 2))));
                const int level = smallestLevelAt(around, edge);
                ASSERT_EQ(SmallLeafPolygons::levelOf(polygon.edges[k], leaf), level);
                split += level == 0;
            }
            for (std::size_t k = 0; k < polygon.triangles.size(); ++k)
                ASSERT_EQ(polygon.triangles[k], oracle.triangles()[k / 3][k % 3]);
            ++checked;
            mostCorners = std::max(mostCorners, polygon.edges.size());
        }
    }
    EXPECT_GT(checked, 10000u);
    EXPECT_GT(split, 5000u);
    EXPECT_GT(mostCorners, 9u);
}

/// The triangulation of least area, triangle by triangle.
std::vector<std::array<std::uint32_t, 3>> trianglesOfLeastArea(const std::vector<PolygonCorner>& corners) {
    constexpr float kNone = std::numeric_limits<float>::infinity();
    const std::size_t k = corners.size();
    std::vector<float> least(k * k, kNone);
    std::vector<std::size_t> apex(k * k);
    for (std::size_t i = 0; i + 1 < k; ++i)
        least[i * k + i + 1] = 0.0f;
    for (std::size_t span = 2; span < k; ++span)
        for (std::size_t i = 0; i + span < k; ++i) {
            const std::size_t j = i + span;
            if (span + 1 < k && (corners[i].faces & corners[j].faces) != 0)
                continue;
            for (std::size_t m = i + 1; m < j; ++m) {
                const float all = least[i * k + m] + least[m * k + j] +
                                  glm::length(glm::cross(corners[m].position - corners[i].position,
                                                         corners[j].position - corners[i].position));
                if (all < least[i * k + j]) {
                    least[i * k + j] = all;
                    apex[i * k + j] = m;
                }
            }
        }
    std::vector<std::array<std::uint32_t, 3>> triangles;
    const std::function<void(std::size_t, std::size_t)> add = [&](std::size_t i, std::size_t j) {
        if (j - i < 2)
            return;
        const std::size_t m = apex[i * k + j];
        triangles.push_back(
            {static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(m), static_cast<std::uint32_t>(j)});
        add(m, j);
        add(i, m);
    };
    if (least[k - 1] != kNone)
        add(0, k - 1);
    return triangles;
}

TEST(PolygonTriangulation, IsOfLeastAreaWithoutDiagonalsInFaces) {
    std::mt19937 random(14);
    std::uniform_real_distribution<float> place(0.0f, 4.0f);
    PolygonTriangulation triangulation;
    std::vector<std::array<std::uint32_t, 3>> found;
    int without = 0;
    for (int round = 0; round < 2000; ++round) {
        std::vector<PolygonCorner> corners(3 + random() % 30);
        for (PolygonCorner& corner : corners)
            corner = {{place(random), place(random), place(random)},
                      static_cast<std::uint8_t>(random() % 2 == 0 ? 0 : 1u << random() % 6)};
        if (round % 4 == 0) // most in one face
            for (PolygonCorner& corner : corners)
                corner.faces = static_cast<std::uint8_t>(corner.faces | (random() % 8 != 0 ? 1 : 0));
        triangulation.make(corners, found);
        ASSERT_EQ(found, trianglesOfLeastArea(corners)) << corners.size() << " corners";
        without += found.empty();
    }
    EXPECT_GT(without, 20);
    EXPECT_LT(without, 1500);
}

} // namespace
} // namespace isoslider::extract
