// Codes of cells, a row at a time, against one cell after the other.

#include "core/topology/analysis/cell_codes.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <random>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/cell/cell_numbering.h"
#include "core/extract/sources/sample_kernels.h"
#include "core/topology/analysis/body_saddles.h"
#include "core/topology/analysis/higher_neighbours.h"
#include "core/topology/cell_saddles.h"

namespace isoslider::topology {
namespace {

class CellCodes : public testing::TestWithParam<std::size_t> {
protected:
    void SetUp() override { extract::useKernelTarget(GetParam()); }
    void TearDown() override { extract::useKernelTarget(0); }
    std::mt19937 random_{20261128};
};

bool isLater(const cell::CornerScalars& scalars, unsigned a, unsigned b) {
    return std::pair(scalars[a], a) > std::pair(scalars[b], b);
}

// What the edges tell: faces, and whether along no axis all edges go the same way.
unsigned codeOf(const cell::CornerScalars& scalars) {
    unsigned code = 0;
    for (unsigned face = 0; face < 6; ++face) {
        const auto& c = cell::kFaceCorners[face];
        for (unsigned up = 0; up < 2; ++up)
            if (isLater(scalars, c[up], c[up + 1]) && isLater(scalars, c[up], c[(up + 3) % 4]) &&
                isLater(scalars, c[up + 2], c[up + 1]) && isLater(scalars, c[up + 2], c[(up + 3) % 4]))
                code |= 1u << face;
    }
    bool mayHaveInner = true;
    for (unsigned axis = 0; axis < 3; ++axis) {
        int ascending = 0;
        for (unsigned corner = 0; corner < 8; ++corner)
            if ((corner >> axis & 1u) == 0)
                ascending += isLater(scalars, corner | 1u << axis, corner) ? 1 : 0;
        mayHaveInner = mayHaveInner && ascending != 0 && ascending != 4;
    }
    return code | (mayHaveInner ? kMayHaveInner : 0);
}

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
        const unsigned plain = codeOf(scalars), code = codes[static_cast<std::size_t>(x)];
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
    for (int round = 0; round < 20; ++round) // differences of few bits beside large scalars
        expectCodes<float>(70, [&] { return 1e6f + 0.0625f * static_cast<float>(random_() % 5); });
}

INSTANTIATE_TEST_SUITE_P(Targets, CellCodes, testing::Range(std::size_t{0}, extract::kernelTargets().size()),
                         [](const testing::TestParamInfo<std::size_t>& tested) {
                             return extract::kernelTargets().at(tested.param);
                         });

} // namespace
} // namespace isoslider::topology
