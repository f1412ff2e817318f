// Cells that are decided together, under every instruction set that the machine has, against one by one.

#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/cell/cell_states.h"
#include "core/cell/undecided_cells.h"
#include "core/extract/sources/sample_kernels.h"
#include "tests/support/cell_cases.h"
#include "tests/support/cell_signs.h"

namespace isoslider::cell {
namespace {

using test::CellKind;

class UndecidedCellsTest : public testing::TestWithParam<std::size_t> {
protected:
    void SetUp() override { extract::useKernelTarget(GetParam()); }
    void TearDown() override { extract::useKernelTarget(0); }

    std::vector<ResolvedCell> resolve(double isovalue) const {
        std::vector<ResolvedCell> resolved(cells_->count);
        resolveCells(*cells_, isovalue, resolved.data());
        return resolved;
    }
    void add(std::uint8_t signs, const CornerScalars& scalars) {
        for (std::size_t corner = 0; corner < 8; ++corner)
            cells_->scalars[corner][cells_->count] = scalars[corner];
        cells_->signs[cells_->count++] = signs;
    }
    void expectAsOneByOne(double isovalue) {
        const std::vector<ResolvedCell> resolved = resolve(isovalue);
        for (std::size_t i = 0; i < cells_->count; ++i) {
            const ResolvedCell alone =
                resolveCell(static_cast<std::uint8_t>(cells_->signs[i]), cells_->scalarsOf(i), isovalue);
            ASSERT_EQ(resolved[i].state, alone.state) << "cell " << i << " at " << isovalue;
            ASSERT_EQ(resolved[i].interval.below, alone.interval.below);
            ASSERT_EQ(resolved[i].interval.above, alone.interval.above);
            tunnels_ += cellStates()[alone.state].tunnel != Tunnel::None;
        }
        cells_->count = 0;
    }

    std::unique_ptr<UndecidedCells> cells_ = std::make_unique<UndecidedCells>();
    int tunnels_ = 0;
};

std::string targetName(const testing::TestParamInfo<std::size_t>& info) {
    return extract::kernelTargets().at(info.param);
}

INSTANTIATE_TEST_SUITE_P(Targets, UndecidedCellsTest, testing::Range(std::size_t{0}, extract::kernelTargets().size()),
                         targetName);

TEST_P(UndecidedCellsTest, AreAsOneByOne) {
    for (int kind = 0; kind < test::kCellKinds; ++kind) {
        test::Random random(7 + static_cast<unsigned>(kind));
        std::size_t most = 1; // batches of all sizes, at one isovalue each
        for (int i = 0; i < 1500; ++i) {
            const CornerScalars scalars = test::randomCell(static_cast<CellKind>(kind), random);
            const double isovalue = test::randomIsovalue(scalars, random);
            if (!std::isfinite(isovalue) || !isAmbiguous(signsOf(scalars, isovalue)))
                continue;
            for (std::size_t k = 0; k < most; ++k) { // the cell, and its mirror images
                CornerScalars mirrored;
                for (std::size_t corner = 0; corner < 8; ++corner)
                    mirrored[corner] = scalars[corner ^ (k % 8)];
                add(signsOf(mirrored, isovalue), mirrored);
            }
            most = most % UndecidedCells::kMost + 1;
            ASSERT_NO_FATAL_FAILURE(expectAsOneByOne(isovalue)) << test::toString(scalars, isovalue);
        }
    }
    EXPECT_GT(tunnels_, 1000);
}

TEST_P(UndecidedCellsTest, WithoutASoundScalarKeepTheirSigns) {
    constexpr std::uint8_t kSigns = 0b01101001; // no two neighbours alike
    ASSERT_TRUE(isAmbiguous(kSigns));
    for (const double lost : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()})
        for (std::size_t corner = 0; corner < 8; ++corner) {
            CornerScalars scalars;
            for (std::size_t i = 0; i < 8; ++i)
                scalars[i] = (kSigns >> i & 1) != 0 ? 2.0 : -1.0;
            add(kSigns, scalars);
            scalars[corner] = lost;
            add(kSigns, scalars);
            const std::vector<ResolvedCell> resolved = resolve(0.0);
            EXPECT_TRUE(resolved[0].interval.contains(0.0));
            EXPECT_EQ(resolved[1].state, kSigns);
            EXPECT_FALSE(resolved[1].interval.contains(0.0));
            cells_->count = 0;
        }
}

} // namespace
} // namespace isoslider::cell
