// Codes of cells, a row at a time, against one cell after the other.

#include "core/topology/analysis/cell_codes.h"

#include <algorithm>
#include <array>
#include <bit>
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

// How many of the cells that may have an inner critical point by their edges are left; of how many saddles of faces the
// sides are known.
struct Left {
    int of = 0, count = 0;
    int saddles = 0, known = 0;
};

void expectSides(const cell::CornerScalars& scalars, unsigned faces, unsigned grows, unsigned isKnown, Left& left) {
    for (; faces != 0; faces &= faces - 1) {
        const int face = std::countr_zero(faces);
        ++left.saddles;
        if ((isKnown >> face & 1u) == 0)
            continue;
        ++left.known;
        CellSaddles saddles;
        const bool isCertain = saddles.find(scalars, 1u << face, false);
        EXPECT_TRUE(isCertain) << "face " << face;
        if (isCertain) {
            EXPECT_EQ((grows >> face & 1u) != 0, saddles.eulerAtFace(face) < 0) << "face " << face;
        }
    }
}

// Two rows of two planes of `nx` points, and the codes of the cells between them.
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
    std::vector<std::uint8_t> grows(codes.size(), 255), isKnown(codes.size(), 255);
    findFaceSides(samples.data(), codes.data(), nx, 2 * nx, nx - 1, grows.data(), isKnown.data());
    EXPECT_EQ(std::min({codes.back(), grows.back(), isKnown.back()}), 255) << "nothing is written behind the last";
    Left left;
    for (std::int64_t x = 0; x + 1 < nx; ++x) {
        cell::CornerScalars scalars{};
        for (std::int64_t c = 0; c < 8; ++c)
            scalars[static_cast<std::size_t>(c)] = static_cast<double>(
                samples[static_cast<std::size_t>(x + (c & 1) + nx * (c >> 1 & 1) + 2 * nx * (c >> 2))]);
        const unsigned plain = test::cellCodeOf(scalars), code = codes[static_cast<std::size_t>(x)];
        EXPECT_EQ(code & kSaddleFaces, plain & kSaddleFaces) << x;
        EXPECT_EQ(code & ~plain, 0u) << x;
        expectSides(scalars, plain & kSaddleFaces, grows[static_cast<std::size_t>(x)],
                    isKnown[static_cast<std::size_t>(x)], left);
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
        to.saddles += more.saddles;
        to.known += more.known;
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
        EXPECT_GT(each.known, each.saddles / 5 * 4) << "few are left open";
    }
}

// The derivative at the saddle of a face is zero, but for the last digits of a scalar.
TEST_P(CellCodes, LeaveOpenWhatRoundingDecides) {
    constexpr std::int64_t kPoints = 20;
    int nearlyFlat = 0;
    for (int round = 0; round < 3000; ++round) {
        std::vector<float> row(static_cast<std::size_t>(4 * kPoints));
        for (float& sample : row)
            sample = std::uniform_real_distribution<float>(-1.0f, 1.0f)(random_);
        const unsigned face = random_() % 6, across = 1u << face / 2;
        const auto& c = cell::kFaceCorners[face];
        const auto at = [&](unsigned corner) -> float& {
            return row[(corner & 1u) + static_cast<std::size_t>(kPoints) * (corner >> 1)];
        };
        const auto difference = [&](std::size_t i, std::size_t k) { return double{at(c[i])} - double{at(c[k])}; };
        const auto inwards = [&](std::size_t i) { return double{at(c[i] ^ across)} - double{at(c[i])}; };
        const double ab = difference(0, 1), ad = difference(0, 3), cb = difference(2, 1), cd = difference(2, 3);
        const double others = cb * cd * inwards(0) + ad * cd * inwards(1) + ad * ab * inwards(2);
        const double needed = double{at(c[3])} - others / (cb * ab);
        if (!(std::abs(needed) < 4.0))
            continue;
        at(c[3] ^ across) = static_cast<float>(needed);
        ++nearlyFlat;
        std::size_t next = 0;
        expectCodes<float>(kPoints, [&] { return row[next++]; });
    }
    EXPECT_GT(nearlyFlat, 1000);
}

// Against the two pairs of opposite corners of each face.
TEST_P(CellCodes, TellWhichJoinsAreNeedless) {
    int needlessCount = 0, others = 0;
    for (int round = 0; round < 40; ++round)
        for (const std::int64_t nx : {2, 3, 17, 33, 70}) {
            const GridDims dims{nx, 2, 2};
            const auto size = static_cast<std::size_t>(4 * nx);
            std::vector<std::int16_t> samples(size);
            std::array<std::vector<std::uint32_t>, 2> leads{std::vector<std::uint32_t>(size),
                                                            std::vector<std::uint32_t>(size)};
            for (std::size_t p = 0; p < size; ++p) {
                samples[p] = static_cast<std::int16_t>(random_() % 100);
                for (auto& side : leads)
                    side[p] = random_() % 3;
            }
            HigherNeighbours higher;
            higher.find(samples.data(), dims, 2, false, false);
            std::vector<std::uint8_t> needless(static_cast<std::size_t>(nx), 255);
            findNeedlessJoins(leads[0].data(), leads[1].data(), higher.edges(), nx, 2 * nx, nx - 1, needless.data());
            EXPECT_EQ(needless.back(), 255) << "nothing is written behind the last";
            for (std::int64_t x = 0; x + 1 < nx; ++x) {
                std::array<std::size_t, 8> at{};
                cell::CornerScalars scalars{};
                for (std::int64_t c = 0; c < 8; ++c) {
                    at[static_cast<std::size_t>(c)] =
                        static_cast<std::size_t>(x + (c & 1) + nx * (c >> 1 & 1) + 2 * nx * (c >> 2));
                    scalars[static_cast<std::size_t>(c)] = samples[at[static_cast<std::size_t>(c)]];
                }
                for (unsigned faces = test::cellCodeOf(scalars) & 0x15; faces != 0; faces &= faces - 1) {
                    const auto face = static_cast<std::size_t>(std::countr_zero(faces));
                    const auto& c = cell::kFaceCorners[face];
                    const std::size_t up = test::isHigher(scalars, c[0], c[1]) ? 0 : 1;
                    const auto differ = [&](const std::vector<std::uint32_t>& side, std::size_t first) {
                        return side[at[c[first]]] != side[at[c[(first + 2) % 4]]];
                    };
                    const bool joins = differ(leads[0], up) || differ(leads[1], up + 1);
                    EXPECT_EQ((needless[static_cast<std::size_t>(x)] >> face & 1u) == 0, joins) << x << " " << face;
                    ++(joins ? others : needlessCount);
                }
            }
        }
    EXPECT_GT(needlessCount, 100);
    EXPECT_GT(others, 100);
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
