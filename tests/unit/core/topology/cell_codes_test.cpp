// Codes of cells, a row at a time, against one cell after the other.

#include "core/topology/analysis/cell_codes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "core/extract/sources/sample_kernels.h"
#include "core/topology/analysis/higher_neighbours.h"
#include "core/topology/cell_saddles.h"
#include "tests/unit/core/topology/cell_code_reference.h"

namespace isoslider::topology {
namespace {

class CellCodes : public testing::TestWithParam<std::size_t> {
protected:
    void SetUp() override { extract::useKernelTarget(GetParam()); }
    void TearDown() override { extract::useKernelTarget(0); }
    std::mt19937 random_{20261128};
};

bool hasInnerPoint(const cell::CornerScalars& scalars) {
    CellHistory history;
    history.find(scalars);
    return std::any_of(history.saddles().begin(), history.saddles().end(),
                       [](const CellSaddle& saddle) { return saddle.face < 0; });
}

// Two rows of two planes of `nx` points, and the codes of the cells between them. How many of the cells that may have
// an inner critical point by their edges are left.
struct Left {
    int of = 0, count = 0;
};
template <class Sample, class Make>
Left expectCodes(std::int64_t nx, const Make& make) {
    const GridDims dims{nx, 2, 2};
    std::vector<Sample> samples(static_cast<std::size_t>(4 * nx));
    for (Sample& sample : samples)
        sample = make();
    HigherNeighbours higher;
    higher.find(samples.data(), dims, 2, false, false);
    std::vector<CellCode> codes(static_cast<std::size_t>(nx), 255);
    findCellCodes(samples.data(), higher.edges(), nx, 2 * nx, nx - 1, codes.data());
    EXPECT_EQ(codes.back(), 255) << "nothing is written behind the last";
    Left left;
    for (std::int64_t x = 0; x + 1 < nx; ++x) {
        cell::CornerScalars scalars{};
        for (std::int64_t c = 0; c < 8; ++c)
            scalars[static_cast<std::size_t>(c)] = static_cast<double>(
                samples[static_cast<std::size_t>(x + (c & 1) + nx * (c >> 1 & 1) + 2 * nx * (c >> 2))]);
        const unsigned plain = test::cellCodeOf(scalars), code = codes[static_cast<std::size_t>(x)];
        EXPECT_EQ(code & kSaddleFaces, plain & kSaddleFaces) << x;
        EXPECT_EQ(code & ~plain, 0u) << x;
        left.of += (plain & kMayHaveInner) != 0 ? 1 : 0;
        left.count += (code & kMayHaveInner) != 0 ? 1 : 0;
        if ((plain & ~code) != 0) {
            EXPECT_FALSE(hasInnerPoint(scalars)) << x;
        }
    }
    return left;
}

TEST_P(CellCodes, LeaveNoCellWithAnInnerCriticalPointOut) {
    std::array<Left, 6> left{};
    const auto add = [](Left& to, const Left& more) {
        to.of += more.of;
        to.count += more.count;
    };
    for (int round = 0; round < 40; ++round)
        for (const std::int64_t nx : {2, 3, 9, 17, 18, 64, 65, 66, 131}) {
            const int most = std::array{2, 5, 60, 250}[random_() % 4]; // few values: ties and levels everywhere
            const auto number = [&] { return static_cast<int>(random_() % static_cast<unsigned>(most)); };
            const auto real = [&] { return std::uniform_real_distribution<double>(-1.0, 1.0)(random_); };
            add(left[0], expectCodes<std::uint8_t>(nx, [&] { return static_cast<std::uint8_t>(number()); }));
            add(left[1], expectCodes<std::int8_t>(nx, [&] { return static_cast<std::int8_t>(number() - 100); }));
            add(left[2], expectCodes<std::int16_t>(nx, [&] { return static_cast<std::int16_t>(random_()); }));
            add(left[3], expectCodes<std::int32_t>(nx, [&] { return static_cast<std::int32_t>(random_()); }));
            add(left[4], expectCodes<float>(nx, [&] { return static_cast<float>(real()); }));
            add(left[5], expectCodes<double>(nx, [&] { return real(); }));
        }
    for (const Left& each : left) {
        EXPECT_GT(each.of, 1000);
        EXPECT_LT(each.count, each.of / 2) << "the scalars exclude most";
    }
}

// Sums and products beyond what single precision holds, or lost in it, exclude nothing.
TEST_P(CellCodes, ExcludeNothingThatOverflowsOrVanishes) {
    for (const double scale : {1e38, 1e30, 1e-12, 1e-30, 1e-44})
        for (int round = 0; round < 20; ++round)
            expectCodes<float>(70, [&] {
                return static_cast<float>(scale * std::uniform_real_distribution<double>(-1.0, 1.0)(random_));
            });
    for (const double scale : {1e308, 1e200, 1e-160, 1e-310})
        for (int round = 0; round < 20; ++round)
            expectCodes<double>(70, [&] { return scale * std::uniform_real_distribution<double>(-1.0, 1.0)(random_); });
    // Some products of differences vanish, or lose their digits, beside others that do not.
    const auto ofAnySize = [&](int decades) {
        const double exponent = std::uniform_real_distribution<double>(-decades, decades / 2)(random_);
        return random_() % 3 == 0 ? 0.0 : std::pow(10.0, exponent) * (random_() % 2 == 0 ? 1.0 : -1.0);
    };
    for (int round = 0; round < 300; ++round) {
        expectCodes<float>(70, [&] { return static_cast<float>(ofAnySize(30)); });
        expectCodes<double>(70, [&] { return ofAnySize(250); });
    }
    for (int round = 0; round < 20; ++round) // differences of few bits beside large scalars
        expectCodes<float>(70, [&] { return 1e6f + 0.0625f * static_cast<float>(random_() % 5); });
}

INSTANTIATE_TEST_SUITE_P(Targets, CellCodes, testing::Range(std::size_t{0}, extract::kernelTargets().size()),
                         [](const testing::TestParamInfo<std::size_t>& tested) {
                             return extract::kernelTargets().at(tested.param);
                         });

} // namespace
} // namespace isoslider::topology
