// Cells measured together, under every instruction set that the machine has, against one at a time.

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/extract/sources/sample_kernels.h"
#include "core/topology/analysis/cell_batches.h"
#include "core/topology/analysis/cell_measure.h"

namespace isoslider::topology {
namespace {

class CellBatchesTest : public testing::TestWithParam<std::size_t> {
protected:
    void SetUp() override { extract::useKernelTarget(GetParam()); }
    void TearDown() override { extract::useKernelTarget(0); }
};

std::string targetName(const testing::TestParamInfo<std::size_t>& info) {
    return extract::kernelTargets().at(info.param);
}

INSTANTIATE_TEST_SUITE_P(Targets, CellBatchesTest, testing::Range(std::size_t{0}, extract::kernelTargets().size()),
                         targetName);

GridGeometry skewed(double unit) {
    GridGeometry geometry;
    geometry.spacing = {unit, 2.5 * unit, 0.25 * unit};
    geometry.direction = glm::dmat3(0.8, 0.6, 0.0, -0.6, 0.8, 0.0, 0.0, 0.0, 1.0);
    return geometry;
}

// Isovalues between samples of -unit to unit; all cells, or a third of them, are looked at.
MeasurePlan planFor(double unit) {
    MeasurePlan plan;
    plan.least = -unit;
    plan.greatest = unit;
    plan.usual = {-0.9 * unit, 0.9 * unit};
    for (int i = 0; i < 37; ++i) {
        plan.isovalues.push_back(unit * (-0.95 + 0.05 * i));
        plan.shares.push_back(i % 3 == 0 ? 1.0 / 3.0 : 1.0);
    }
    return plan;
}

// Noise: most of these cells are ambiguous at some isovalue, and some have tunnels.
std::vector<MeasuredCell> noise(const MeasurePlan& plan, double unit, int count) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> scalar(-unit, unit);
    std::vector<MeasuredCell> cells;
    while (static_cast<int>(cells.size()) < count) {
        MeasuredCell cell;
        for (double& s : cell.scalars)
            s = random() % 16 == 0 ? plan.isovalues[random() % plan.isovalues.size()] : scalar(random);
        const auto [low, high] = std::minmax_element(cell.scalars.begin(), cell.scalars.end());
        const auto beyond = [&](double s) {
            return std::upper_bound(plan.isovalues.begin(), plan.isovalues.end(), s) - plan.isovalues.begin();
        };
        cell.first = static_cast<std::uint32_t>(beyond(*low));
        cell.end = static_cast<std::uint32_t>(beyond(*high));
        cell.rank = static_cast<std::uint32_t>(random());
        cell.isUsual = *low >= plan.usual.first && *high <= plan.usual.second;
        cells.push_back(cell);
    }
    return cells;
}

struct Expected {
    std::vector<BatchSum> sums;
    int tunnels = 0;
};

Expected oneAtATime(const MeasurePlan& plan, const GridGeometry& geometry, const std::vector<MeasuredCell>& cells) {
    Expected expected;
    expected.sums.resize(2 * plan.isovalues.size());
    CellMeasure measure(geometry);
    for (const MeasuredCell& cell : cells)
        for (std::size_t k = cell.first; k < cell.end; ++k) {
            if (cell.rank > CellBatches::lastRank(plan.shares[k]))
                continue;
            unsigned signs = 0;
            for (unsigned c = 0; c < 8; ++c)
                signs |= (cell.scalars[c] >= plan.isovalues[k] ? 1u : 0u) << c;
            const auto pattern = static_cast<std::uint8_t>(signs);
            const cell::StateId id = cell::isAmbiguous(pattern)
                                         ? cell::resolveCell(pattern, cell.scalars, plan.isovalues[k]).state
                                         : pattern;
            const cell::CellState& state = cell::cellStates()[id];
            expected.tunnels += state.tunnel != cell::Tunnel::None ? 1 : 0;
            const CellSum sum = measure.at(cell.scalars, state, plan.isovalues[k]);
            BatchSum& into = expected.sums[2 * k + (cell.isUsual ? 1 : 0)];
            into.area += sum.area;
            into.volume += sum.volume;
            into.gradient += sum.gradient;
            into.triangles += state.triangleCount;
        }
    return expected;
}

TEST_P(CellBatchesTest, MeasureAsOneCellAtATime) {
    for (const double unit : {1.0, 3e-120, 2e120}) {
        SCOPED_TRACE(unit);
        const MeasurePlan plan = planFor(unit);
        const GridGeometry geometry = skewed(0.125);
        const auto cells = noise(plan, unit, 5000);
        const Expected expected = oneAtATime(plan, geometry, cells);
        EXPECT_GT(expected.tunnels, 10);
        CellBatches batches(plan, geometry);
        for (std::size_t from = 0; from < cells.size(); from += 100)
            batches.add(std::span(cells).subspan(from, 100));
        const auto& found = batches.finish();
        ASSERT_EQ(found.size(), expected.sums.size());
        for (std::size_t i = 0; i < found.size(); ++i) {
            const BatchSum is = batches.measured(i, found[i]);
            const BatchSum& should = expected.sums[i];
            EXPECT_EQ(is.triangles, should.triangles) << i;
            EXPECT_NEAR(is.area, should.area, 1e-5 * should.area) << i;
            EXPECT_NEAR(is.volume, should.volume, 1e-5 * should.triangles) << i;
            EXPECT_NEAR(is.gradient, should.gradient, 1e-5 * should.gradient) << i;
        }
    }
}

TEST_P(CellBatchesTest, AreTheSameToTheBitForEveryInstructionSet) {
    const MeasurePlan plan = planFor(1.0);
    const auto cells = noise(plan, 1.0, 2000);
    CellBatches batches(plan, skewed(3.0));
    batches.add(cells);
    const auto found = batches.finish();
    extract::useKernelTarget(0);
    CellBatches others(plan, skewed(3.0));
    others.add(cells);
    const auto& expected = others.finish();
    for (std::size_t i = 0; i < found.size(); ++i)
        EXPECT_TRUE(found[i] == expected[i]) << i;
}

TEST_P(CellBatchesTest, AreTheSameToTheBitInAnyOrderAndParts) {
    const MeasurePlan plan = planFor(1.0);
    auto cells = noise(plan, 1.0, 2000);
    CellBatches batches(plan, skewed(3.0));
    batches.add(cells);
    const auto found = batches.finish();
    std::shuffle(cells.begin(), cells.end(), std::mt19937(5));
    std::vector<ExactSum> parts(found.size());
    for (std::size_t from = 0; from < cells.size(); from += 400) {
        CellBatches part(plan, skewed(3.0));
        part.add(std::span(cells).subspan(from, 400));
        const auto& its = part.finish();
        for (std::size_t i = 0; i < parts.size(); ++i)
            parts[i].add(its[i]);
    }
    for (std::size_t i = 0; i < found.size(); ++i)
        EXPECT_TRUE(found[i] == parts[i]) << i;
}

// A fill value orders of magnitude away from all others.
TEST_P(CellBatchesTest, StandFillValues) {
    MeasurePlan plan = planFor(1.0);
    plan.greatest = 1e300;
    MeasuredCell cell;
    cell.scalars = {-0.5, -0.5, -0.5, -0.5, -0.5, -0.5, -0.5, 1e300};
    cell.first = 20;
    cell.end = 37;
    cell.isUsual = false;
    CellBatches batches(plan, GridGeometry());
    batches.add({&cell, 1});
    const auto& sums = batches.finish();
    EXPECT_GT(batches.measured(40, sums[40]).gradient, 1e250);
    for (std::size_t i = 0; i < sums.size(); ++i) {
        const BatchSum sum = batches.measured(i, sums[i]);
        EXPECT_TRUE(std::isfinite(sum.area) && std::isfinite(sum.volume));
        EXPECT_LE(sum.area, 0.87); // the corner's whole triangle: half of sqrt(3)
    }
}

} // namespace
} // namespace isoslider::topology
