#include "core/extract/sources/leaf_finding.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "core/extract/live/brick_shapes.h"
#include "core/extract/sources/sample_kernels.h"
#include "tests/unit/core/extract/some_leaves.h"

namespace isoslider::extract {
namespace {

struct alignas(64) FieldSamples {
    float values[kKeptPoints];
};

/// A plane with waves and noise on it.
FieldSamples fieldOf(std::mt19937& random, float waves, float noise) {
    std::uniform_real_distribution<float> around(-1.0f, 1.0f);
    const float a = around(random), b = around(random), c = around(random), phase = 3.0f * around(random);
    FieldSamples samples{};
    for (int p = 0; p < kClosedPoints; ++p) {
        const auto at = coordsOf(ClosedPoint(p));
        const auto x = static_cast<float>(at[0]), y = static_cast<float>(at[1]), z = static_cast<float>(at[2]);
        samples.values[p] =
            a * x + b * y + c * z + waves * std::sin(0.9f * x + 0.7f * y - z + phase) + noise * around(random);
    }
    std::fill(samples.values + kClosedPoints, samples.values + kKeptPoints, samples.values[0]);
    return samples;
}

const BrickMasks& masksOfInnerBrick() {
    static const std::vector<index::MissingCells> none;
    static const BrickShapes shapes({40, 40, 40}, none);
    return shapes.masks(shapes.grid().brickAt(1, 2, 1));
}

bool isMonotoneByDefinition(const FieldSamples& samples, int x0, int y0, int z0, int side) {
    for (int axis = 0; axis < 3; ++axis) {
        bool ascends = true, descends = true;
        for (int z = z0; z <= z0 + side - (axis == 2); ++z)
            for (int y = y0; y <= y0 + side - (axis == 1); ++y)
                for (int x = x0; x <= x0 + side - (axis == 0); ++x) {
                    const float here = samples.values[closedPoint(x, y, z).index()],
                                next =
                                    samples
                                        .values[closedPoint(x + (axis == 0), y + (axis == 1), z + (axis == 2)).index()];
                    ascends = ascends && here <= next;
                    descends = descends && here >= next;
                }
        if (!ascends && !descends)
            return false;
    }
    return true;
}

struct FieldKind {
    float waves, noise;
};
constexpr FieldKind kFieldKinds[] = {{0.0f, 0.0f}, {0.3f, 0.0f}, {1.0f, 0.0f},
                                     {0.0f, 0.1f}, {0.3f, 0.3f}, {0.0f, 3.0f}};

TEST(SureCells, AreMonotoneByDefinition) {
    std::mt19937 random(3);
    int counts[3] = {};
    for (const FieldKind& kind : kFieldKinds)
        for (int round = 0; round < 20; ++round) {
            const FieldSamples samples = fieldOf(random, kind.waves, kind.noise);
            const BrickLeaves found =
                findSureCells<float>(samples.values, masksOfInnerBrick().cells, {MergeBound::Measure::Scalar, 0.1})
                    .monotone;
            for (int i = 0; i < 64; ++i) {
                const bool is = isMonotoneByDefinition(samples, 2 * (i % 4), 2 * (i / 4 % 4), 2 * (i / 16), 2);
                ASSERT_EQ(found.level1 >> i & 1, std::uint64_t{is});
                counts[0] += is;
            }
            for (int i = 0; i < 8; ++i) {
                const bool is = isMonotoneByDefinition(samples, 4 * (i % 2), 4 * (i / 2 % 2), 4 * (i / 4), 4);
                ASSERT_EQ(found.level2 >> i & 1, int{is});
                counts[1] += is;
            }
            ASSERT_EQ(found.level3, isMonotoneByDefinition(samples, 0, 0, 0, 8));
            counts[2] += found.level3;
        }
    EXPECT_GT(counts[0], 2000);
    EXPECT_LT(counts[0], 7000);
    EXPECT_GT(counts[1], 200);
    EXPECT_GT(counts[2], 20);
}

TEST(SureCells, AreNoneBesideMissingSamples) {
    std::mt19937 random(4);
    FieldSamples samples = fieldOf(random, 0.0f, 0.0f);
    samples.values[closedPoint(4, 4, 4).index()] = std::numeric_limits<float>::quiet_NaN();
    const auto sure =
        findSureCells<float>(samples.values, masksOfInnerBrick().cells, {MergeBound::Measure::Scalar, 100.0});
    EXPECT_FALSE(sure.monotone.level3);
    EXPECT_EQ(sure.monotone.level2, 0) << "all eight touch the middle";
    EXPECT_EQ(std::popcount(sure.monotone.level1), 64 - 8);
    EXPECT_FALSE(sure.isOneLeaf);
}

// A large cell may be within the bound though its halves are not: the last sample along each axis pulls their
// interpolant away. Cells are merged from small to large, so it is none.
TEST(SureCells, AreOneLeafOnlyWithAllTheirHalves) {
    FieldSamples samples{};
    for (int p = 0; p < kClosedPoints; ++p) {
        const auto at = coordsOf(ClosedPoint(p));
        samples.values[p] = static_cast<float>(10 * (at[0] + at[1] + at[2]));
    }
    const BitString& cells = masksOfInnerBrick().cells;
    const auto isOneLeaf = [&](double limit) {
        return findSureCells<float>(samples.values, cells, {MergeBound::Measure::Scalar, limit}).isOneLeaf;
    };
    EXPECT_TRUE(isOneLeaf(0.5)) << "a plane";
    for (int p = 0; p < kClosedPoints; ++p) { // up and down in turn inside, nothing at the corners
        const auto at = coordsOf(ClosedPoint(p));
        if (at[0] % 8 != 0)
            samples.values[p] += at[0] % 2 == 0 ? 1.0f : -1.0f;
    }
    const SureCells sure = findSureCells<float>(samples.values, cells, {MergeBound::Measure::Scalar, 1.5});
    EXPECT_TRUE(sure.within.level3 && sure.monotone.level3);
    EXPECT_NE(sure.within.level1, ~std::uint64_t{0}) << "its middle is 2 away from what its ends say";
    EXPECT_FALSE(sure.isOneLeaf);
    EXPECT_TRUE(isOneLeaf(2.5));
}

// Cells that merge or split are highlighted, and count as changed.
TEST(BrickLeaves, ThatDifferInACellAreThoseOfAnotherLevel) {
    std::mt19937 random(6);
    for (int round = 0; round < 300; ++round) {
        const BrickLeaves before = someLeaves(random), now = random() % 8 == 0 ? before : someLeaves(random);
        BitString expected;
        for (int i = 0; i < 512; ++i) {
            const int x = i % 8, y = i / 8 % 8, z = i / 64;
            if (before.levelOf(x, y, z) != now.levelOf(x, y, z))
                expected.set(closedPoint(x, y, z));
        }
        ASSERT_EQ(cellsOfOtherLevel(before, now), expected);
    }
}

// What is known for sure spares work and changes nothing.
TEST(BrickLeaves, AreTheSameWithAndWithoutSureCells) {
    std::mt19937 random(5);
    int merged[4] = {}, oneLeaf = 0;
    for (const FieldKind& kind : kFieldKinds)
        for (const MergeBound bound :
             {MergeBound{MergeBound::Measure::Scalar, 0.3}, MergeBound{MergeBound::Measure::Distance, 0.25}})
            for (int round = 0; round < 30; ++round) {
                const FieldSamples samples = fieldOf(random, kind.waves, kind.noise);
                const BrickMasks& masks = masksOfInnerBrick();
                const SureCells sure = findSureCells<float>(samples.values, masks.cells, bound);
                BitString before;
                FoundLeaves step;
                ExceedingEdges kept;
                for (int at = 0; at < 12; ++at) {
                    ClassifiedBrick<float> found;
                    classify(samples.values, samples.values[random() % kClosedPoints], masks,
                             at == 0 ? std::nullopt : std::optional<BitsInMemory>(before), found);
                    ExceedingEdges none;
                    const FoundLeaves all =
                        findBrickLeaves<float>(samples.values, found.above, found.active, masks.cells, bound, {}, none);
                    const BrickLeaves& plain = all.usable;
                    ASSERT_EQ(findBrickLeaves<float>(samples.values, found.above, found.active, masks.cells, bound,
                                                     sure, kept)
                                  .usable,
                              plain);
                    if (at == 0)
                        step = all;
                    else
                        step = updateBrickLeaves<float>(step.usable, before, found.changed, samples.values, found.above,
                                                        found.active, masks.cells, bound, sure, kept);
                    before = found.above;
                    ASSERT_EQ(step.usable, plain);
                    ASSERT_EQ(step.ofSurface, all.ofSurface);
                    for (int i = 0; i < 64; ++i) {
                        const int x = 2 * (i % 4), y = 2 * (i / 4 % 4), z = 2 * (i / 16),
                                  level = plain.levelOf(x, y, z), side = std::max(2, 1 << level);
                        const std::uint64_t its =
                            pairsOfLeaf(closedPoint(x & -side, y & -side, z & -side), std::max(1, level));
                        const bool isCrossed = (anyOfEight(found.active.cells) & its) != 0;
                        ASSERT_EQ(all.ofSurface.levelOf(x, y, z), isCrossed ? level : 0);
                    }
                    ASSERT_TRUE(plain.level3 || !sure.isOneLeaf || found.active.cells.isEmpty());
                    oneLeaf += sure.isOneLeaf;
                    ++merged[plain.level3 ? 3 : plain.level2 != 0 ? 2 : plain.level1 != 0 ? 1 : 0];
                }
            }
    EXPECT_GT(oneLeaf, 100);
    for (const int count : merged)
        EXPECT_GT(count, 20);
}

} // namespace
} // namespace isoslider::extract
