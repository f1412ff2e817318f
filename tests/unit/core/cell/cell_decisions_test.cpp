// What the product decides of a cell against the slab oracle, which decides exactly and otherwise.

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>

#include <gtest/gtest.h>

#include "tests/support/cell_signs.h"
#include "tests/unit/core/cell/state_labels.h"

namespace isoslider::cell {
namespace {

using test::CellKind;
using test::CellScalars;
using test::Random;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Which faces are joined as the neighbours behind them see it, with the corners of each the other way round: in
// the cell's mirror image along x.
int joinedFacesSeenFromOutside(const CellScalars& scalars, double isovalue) {
    CellScalars mirrored;
    for (std::size_t corner = 0; corner < 8; ++corner)
        mirrored[corner] = scalars[corner ^ 1];
    const int joined = stateAt(mirrored, isovalue).joinedFaces;
    return (joined & ~3) | (joined & 1) << 1 | (joined >> 1 & 1);
}

// Every public decision, by the oracle's answer.
void expectDecisions(const CellScalars& scalars, double isovalue) {
    const test::CellTopology expected = test::sweepCell(scalars, isovalue);
    const StateLabel label = labelOf(expected);
    ASSERT_EQ(signsOf(scalars, isovalue), expected.signs);
    const ResolvedCell cell = resolved(scalars, isovalue);
    ASSERT_EQ(toString(labelOf(cellStates()[cell.state])), toString(label));
    ASSERT_EQ(joinedFacesSeenFromOutside(scalars, isovalue), label.joinedFaces);
    if (mayHaveTunnel(expected.signs, expected.joinedFaces) != 0) {
        ASSERT_EQ(decideTunnel(scalars, isovalue).tunnel, label.tunnel);
    }
    ASSERT_TRUE(cell.interval.contains(isovalue) || !(cell.interval.below <= cell.interval.above));
}

class Decisions : public testing::TestWithParam<CellKind> {};

TEST_P(Decisions, AgreeWithTheOracle) {
    const bool isSlow = GetParam() == CellKind::HugeDoubles || GetParam() == CellKind::HugeFloats;
    const int count = isSlow ? 4000 : 40000;
    Random random(100 + static_cast<unsigned>(GetParam()));
    int tunnels = 0;
    for (int i = 0; i < count; ++i) {
        const CellScalars scalars = test::randomCell(GetParam(), random);
        const double isovalue = test::randomIsovalue(scalars, random);
        expectDecisions(scalars, isovalue);
        ASSERT_FALSE(HasFailure()) << test::toString(scalars, isovalue);
        tunnels += stateAt(scalars, isovalue).tunnel != Tunnel::None;
    }
    RecordProperty("tunnels", tunnels);
}

// The oracle too: three axes, and an Euler number counted without its components.
TEST_P(Decisions, AreOfAnOracleThatAgreesWithItself) {
    const bool isSlow = GetParam() == CellKind::HugeDoubles || GetParam() == CellKind::HugeFloats;
    Random random(200 + static_cast<unsigned>(GetParam()));
    for (int i = 0; i < (isSlow ? 1000 : 10000); ++i) {
        const CellScalars scalars = test::randomCell(GetParam(), random);
        const double isovalue = test::randomIsovalue(scalars, random);
        ASSERT_EQ(test::oracleFault(scalars, isovalue), "") << test::toString(scalars, isovalue);
    }
}

// From one scalar to the next: where a face or the inside changes, to the last bit.
TEST_P(Decisions, ChangeAtTheSameDoubleAsTheOracle) {
    Random random(300 + static_cast<unsigned>(GetParam()));
    int faceChanges = 0, tunnelChanges = 0;
    for (int i = 0; i < 400; ++i) {
        const CellScalars scalars = test::randomCell(GetParam(), random);
        const auto labelAt = [&](double isovalue) { return labelOf(test::sweepCell(scalars, isovalue)); };
        CellScalars sorted = scalars;
        std::sort(sorted.begin(), sorted.end());
        const auto k = static_cast<std::size_t>(test::pickInt(random, 2, 4));
        double start = std::nextafter(sorted[k], kInfinity);
        for (int part = 1; part <= 8 && sorted[k] < sorted[k + 1]; ++part) {
            double end = part == 8 ? sorted[k + 1] : std::lerp(sorted[k], sorted[k + 1], 0.125 * part);
            const StateLabel before = labelAt(start);
            double low = start, high = start = end;
            if (before == labelAt(high))
                continue;
            for (double middle = std::midpoint(low, high); middle > low && middle < high;
                 middle = std::midpoint(low, high))
                (labelAt(middle) == before ? low : high) = middle;
            (labelAt(high).tunnel != before.tunnel ? tunnelChanges : faceChanges) += 1;
            for (const double isovalue :
                 {std::nextafter(low, -kInfinity), low, high, std::nextafter(high, kInfinity)}) {
                expectDecisions(scalars, isovalue);
                ASSERT_FALSE(HasFailure()) << test::toString(scalars, isovalue);
            }
        }
    }
    RecordProperty("faceChanges", faceChanges);
    RecordProperty("tunnelChanges", tunnelChanges);
}

// An interval states for how long nothing has to be asked again.
TEST_P(Decisions, HoldThroughoutTheirInterval) {
    Random random(400 + static_cast<unsigned>(GetParam()));
    for (int i = 0; i < 4000; ++i) {
        const CellScalars scalars = test::randomCell(GetParam(), random);
        const double isovalue = test::randomIsovalue(scalars, random);
        const ResolvedCell cell = resolved(scalars, isovalue);
        if (!(cell.interval.below <= cell.interval.above))
            continue;
        const auto [least, greatest] = std::minmax_element(scalars.begin(), scalars.end());
        const double low = std::max(cell.interval.below, *least), high = std::min(cell.interval.above, *greatest);
        const double share = test::pickUnit(random);
        for (const double other : {low, high, std::nextafter(low, kInfinity), std::nextafter(high, -kInfinity),
                                   (1.0 - share) * low + share * high}) {
            if (!cell.interval.contains(other) || signsOf(scalars, other) != signsOf(scalars, isovalue))
                continue;
            ASSERT_EQ(labelOf(test::sweepCell(scalars, other)), labelOf(cellStates()[cell.state]))
                << test::toString(scalars, isovalue) << ", other isovalue " << other;
            ASSERT_EQ(resolved(scalars, other).state, cell.state)
                << test::toString(scalars, isovalue) << ", other isovalue " << other;
        }
    }
}

std::string kindName(const testing::TestParamInfo<CellKind>& info) {
    std::string name = test::cellKindName(info.param);
    std::replace(name.begin(), name.end(), ' ', '_');
    return name;
}

INSTANTIATE_TEST_SUITE_P(Kinds, Decisions,
                         testing::Values(CellKind::Uniform, CellKind::TinyIntegers, CellKind::SmallIntegers,
                                         CellKind::Saddle, CellKind::Decades, CellKind::Plane, CellKind::NearPlane,
                                         CellKind::Degenerate, CellKind::BodyTies, CellKind::PowersOfTwo,
                                         CellKind::Scaled, CellKind::SignedZeros, CellKind::Denormal,
                                         CellKind::HugeFloats, CellKind::HugeDoubles),
                         kindName);

// All cells of values -1, 0, 1 at the isovalues where they are tied, and between.
TEST(TiedCells, AgreeWithTheOracleOneAndAll) {
    for (int number = 0; number < 6561; ++number) {
        CellScalars scalars;
        for (int i = 0, rest = number; i < 8; ++i, rest /= 3)
            scalars[static_cast<std::size_t>(i)] = rest % 3 - 1;
        for (const double isovalue : {-1.0, -0.5, -0.0, 0.0, 0.25, 1.0}) {
            expectDecisions(scalars, isovalue);
            ASSERT_FALSE(testing::Test::HasFailure()) << test::toString(scalars, isovalue);
        }
    }
}

// A state ends at the isovalue below: there the limit from below has left it.
TEST(StateIntervals, AreHalfOpen) {
    const StateInterval interval{1.0, 2.0};
    EXPECT_FALSE(interval.contains(1.0));
    EXPECT_TRUE(interval.contains(std::nextafter(1.0, 2.0)));
    EXPECT_TRUE(interval.contains(2.0));
    EXPECT_FALSE(interval.contains(std::nextafter(2.0, 3.0)));
    EXPECT_FALSE((StateInterval{1.0, 1.0}.contains(1.0)));
}

// How much of the interval in which the state stays the product's interval covers, where signs stay.
TEST(StateIntervals, CoverMostOfTheStatesTrueInterval) {
    Random random(17);
    double covered = 0.0;
    int cells = 0;
    for (int i = 0; i < 3000; ++i) {
        const CellScalars scalars = test::randomCell(CellKind::Uniform, random);
        const double isovalue = scalars[0] + 0.7 * (scalars[1] - scalars[0]);
        const std::uint8_t signs = signsOf(scalars, isovalue);
        if (!isAmbiguous(signs))
            continue;
        double low = -kInfinity, high = kInfinity; // signs stay
        for (std::size_t k = 0; k < 8; ++k)
            ((signs >> k & 1) != 0 ? high : low) =
                (signs >> k & 1) != 0 ? std::min(high, scalars[k]) : std::max(low, scalars[k]);
        const ResolvedCell cell = resolved(scalars, isovalue);
        constexpr int kSteps = 100;
        int same = 0, inside = 0;
        for (int step = 0; step < kSteps; ++step) {
            const double other = low + (high - low) * (step + 0.5) / kSteps;
            const bool isSame = labelOf(test::sweepCell(scalars, other)) == labelOf(cellStates()[cell.state]);
            same += isSame;
            inside += cell.interval.contains(other) && isSame;
        }
        if (same == 0)
            continue;
        covered += static_cast<double>(inside) / same;
        ++cells;
    }
    RecordProperty("cells", cells);
    RecordProperty("coveredPercent", static_cast<int>(100.0 * covered / cells));
    EXPECT_GT(cells, 1000);
    EXPECT_GT(covered / cells, 0.5);
}

} // namespace
} // namespace isoslider::cell
