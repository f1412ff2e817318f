// Counts at every isovalue against an oracle that sweeps slabs and knows no union-find, no case table and no events.

#include "core/topology/topology_analysis.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <random>

#include <gtest/gtest.h>

#include "tests/support/result_matchers.h"
#include "tests/support/slab_oracle.h"
#include "tests/support/topology_grids.h"

namespace isoslider::topology {
namespace {

using test::HasError;
using test::IsOk;

TopologyCurve curveOf(const test::TopologyGrid& grid, const AnalysisOptions& options = {}) {
    auto curve = analyseTopology(planesOf(*grid.grid), options);
    EXPECT_THAT(curve, IsOk());
    return curve.isOk() ? std::move(curve).value() : TopologyCurve();
}

void expectSameEvents(const TopologyCurve& a, const TopologyCurve& b) {
    const std::vector<TopologyEvent> all = a.events(), others = b.events();
    ASSERT_EQ(all.size(), others.size());
    for (std::size_t i = 0; i < all.size(); ++i) {
        const TopologyEvent &one = all[i], &other = others[i];
        ASSERT_EQ(one.isovalue, other.isovalue);
        ASSERT_EQ(one.kind, other.kind);
        ASSERT_EQ(one.below, other.below);
        ASSERT_EQ(one.above, other.above);
        ASSERT_EQ(one.pieces, other.pieces);
        ASSERT_EQ(one.persistence, other.persistence);
    }
}
void expectSamePlaces(const TopologyCurve& a, const TopologyCurve& b) {
    const std::vector<TopologyEvent> all = a.events(), others = b.events();
    for (std::size_t i = 0; i < all.size(); ++i)
        ASSERT_EQ(all[i].position, others[i].position) << all[i].isovalue;
}

void expectCounts(const test::TopologyGrid& grid, const TopologyCurve& curve, double isovalue) {
    const test::GridTopology expected = test::sweepGrid(grid.scalars, grid.dims, isovalue);
    const SurfaceCounts found = curve.countsAt(isovalue);
    ASSERT_EQ(found.euler, expected.euler) << grid.description << " at " << isovalue;
    ASSERT_EQ(found.components, expected.components) << grid.description << " at " << isovalue;
    ASSERT_EQ(found.loops, expected.loops) << grid.description << " at " << isovalue;
    ASSERT_EQ((2 * found.components - found.loops - found.euler) % 2, 0);
}

// Equal samples and saddles by the hundred: which of them an event is shown at does not depend on the parts either.
TEST(TopologyOfTies, IsTheSameInAnyParts) {
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
        std::mt19937 random(static_cast<unsigned>(seed));
        std::vector<double> samples(17 * 15 * 19);
        for (double& sample : samples)
            sample = static_cast<double>(random() % (seed < 4 ? 4 : 40));
        const test::TopologyGrid grid = test::makeTopologyGrid(samples, {17, 15, 19}, "ties");
        const TopologyCurve whole = curveOf(grid);
        for (const std::int64_t planes : {2, 3, 8})
            for (const std::int64_t rows : {1, 4, 100}) {
                AnalysisOptions parts;
                parts.planesAtOnce = planes;
                parts.rowsAtOnce = rows;
                const TopologyCurve curve = curveOf(grid, parts);
                expectSameEvents(curve, whole);
                expectSamePlaces(curve, whole);
            }
    }
}

// Rows of equal samples are passed over; of the other grid, the same turned round, no row is equal throughout.
TEST(TopologyOfFlatParts, IsThatOfTheSameGridWithoutFlatRows) {
    constexpr std::int64_t kSide = 14;
    for (unsigned seed = 1; seed <= 8; ++seed) {
        std::mt19937 random(seed);
        std::vector<double> samples(kSide * kSide * kSide, 3.0), turned = samples;
        const auto at = [](std::int64_t x, std::int64_t y, std::int64_t z) {
            return static_cast<std::size_t>(x + kSide * (y + kSide * z));
        };
        for (std::int64_t y = 0; y < kSide; ++y)
            for (std::int64_t z = 0; z < kSide; ++z)
                samples[at(0, y, z)] = static_cast<double>(random() % 6);
        for (unsigned i = 0; i < 3 * seed; ++i)
            samples[at(random() % kSide, random() % kSide, kSide / 2 + random() % 3)] =
                seed % 3 == 0 && i % 4 == 0 ? std::numeric_limits<double>::quiet_NaN()
                                            : static_cast<double>(random() % 6);
        for (std::int64_t z = 0; z < kSide; ++z)
            for (std::int64_t y = 0; y < kSide; ++y)
                for (std::int64_t x = 0; x < kSide; ++x)
                    turned[at(z, y, x)] = samples[at(x, y, z)];
        const test::TopologyGrid varied = test::makeTopologyGrid(samples, {kSide, kSide, kSide}, "varied rows"),
                                 flat = test::makeTopologyGrid(turned, {kSide, kSide, kSide}, "flat rows");
        const TopologyCurve expected = curveOf(varied);
        ASSERT_FALSE(expected.events().empty());
        for (const std::int64_t planes : {3, 5, 100})
            for (const std::int64_t rows : {1, 3, 100}) {
                AnalysisOptions parts;
                parts.planesAtOnce = planes;
                parts.rowsAtOnce = rows;
                expectSameEvents(curveOf(flat, parts), expected);
                if (HasFatalFailure())
                    return;
            }
        for (const double isovalue : {0.5, 1.5, 2.5, 3.0, 3.5, 4.5})
            if (seed % 3 != 0)
                expectCounts(flat, expected, isovalue);
    }
}

class EveryKindOfGrid : public testing::TestWithParam<int> {};

TEST_P(EveryKindOfGrid, HasTheCountsOfTheOracleAtAndBetweenAllEvents) {
    const auto kind = static_cast<test::GridKind>(GetParam());
    std::size_t saddles = 0;
    for (std::uint64_t seed = 1; seed <= 12; ++seed) {
        test::Random random(seed * 100 + static_cast<std::uint64_t>(GetParam()));
        const test::TopologyGrid grid = test::randomTopologyGrid(kind, 2, 6, random);
        AnalysisOptions thin;
        thin.planesAtOnce = 3; // layers of one or two cells
        thin.rowsAtOnce = 1 + static_cast<std::int64_t>(seed % 3);
        thin.boundaryPointsAtOnce = 5;
        const TopologyCurve curve = curveOf(grid, thin);
        expectSameEvents(curve, curveOf(grid));
        expectSamePlaces(curve, curveOf(grid));
        std::vector<double> isovalues;
        double last = -std::numeric_limits<double>::infinity();
        for (const TopologyEvent& event : curve.events()) {
            ASSERT_GT(event.isovalue, last) << "ascending, one for each isovalue";
            ASSERT_FALSE(event.below == event.above && event.pieces == PieceChanges());
            if (std::isfinite(last)) {
                ASSERT_EQ(curve.countsAt(event.isovalue), event.below);
            }
            last = event.isovalue;
            saddles += event.kind != EventKind::Vertex;
            isovalues.push_back(event.isovalue);
            isovalues.push_back(std::nextafter(event.isovalue, std::numeric_limits<double>::infinity()));
        }
        // Also where nothing is said to happen: samples, and somewhere between.
        for (std::size_t i = 0; i < grid.scalars.size(); i += 7)
            isovalues.push_back(grid.scalars[i]);
        const std::size_t known = isovalues.size();
        for (std::size_t i = 1; i < known; i += 1 + known / 20)
            isovalues.push_back(0.5 * isovalues[i - 1] + 0.5 * isovalues[i]);
        std::shuffle(isovalues.begin(), isovalues.end(), random);
        isovalues.resize(std::min<std::size_t>(isovalues.size(), 150));
        for (const double isovalue : isovalues) {
            expectCounts(grid, curve, isovalue);
            if (HasFatalFailure())
                return;
        }
    }
    if (kind == test::GridKind::Open || kind == test::GridKind::Checkerboard) {
        EXPECT_GT(saddles, 50u);
    }
}

INSTANTIATE_TEST_SUITE_P(Kinds, EveryKindOfGrid, testing::Range(0, test::kGridKinds), [](const auto& kind) {
    std::string name = test::gridKindName(static_cast<test::GridKind>(kind.param));
    std::replace_if(
        name.begin(), name.end(), [](char c) { return std::isalnum(static_cast<unsigned char>(c)) == 0; }, '_');
    return name;
});

template <class Field>
TopologyCurve curveOfField(const std::array<std::int64_t, 3>& dims, const Field& field) {
    GridGeometry geometry;
    geometry.dims = {dims[0], dims[1], dims[2]};
    std::vector<float> samples;
    for (std::int64_t z = 0; z < dims[2]; ++z)
        for (std::int64_t y = 0; y < dims[1]; ++y)
            for (std::int64_t x = 0; x < dims[0]; ++x)
                samples.push_back(
                    static_cast<float>(field(static_cast<double>(x), static_cast<double>(y), static_cast<double>(z))));
    const auto grid = ScalarGrid::fromValues<float>(geometry, ScalarType::F32, samples);
    const auto curve = analyseTopology(planesOf(grid));
    EXPECT_THAT(curve, IsOk());
    return curve.isOk() ? curve.value() : TopologyCurve();
}

TEST(TopologyCurve, KnowsShapesThatEverybodyKnows) {
    const auto sphere = curveOfField(
        {21, 21, 21}, [](double x, double y, double z) { return 10.0 - std::hypot(x - 10.1, y - 9.9, z - 10.2); });
    EXPECT_EQ(sphere.countsAt(5.0), (SurfaceCounts{1, 2, 0, 0}));
    const auto torus = curveOfField({41, 41, 21}, [](double x, double y, double z) {
        return 6.0 - std::hypot(std::hypot(x - 20.1, y - 19.8) - 12.0, z - 10.2);
    });
    EXPECT_EQ(torus.countsAt(2.0), (SurfaceCounts{1, 0, 0, 0}));
    EXPECT_EQ(torus.countsAt(2.0).handles(), 1);
    const auto shell = curveOfField({31, 31, 31}, [](double x, double y, double z) {
        return 4.0 - std::abs(std::hypot(x - 15.1, y - 14.9, z - 15.2) - 9.0);
    });
    EXPECT_EQ(shell.countsAt(1.0), (SurfaceCounts{2, 4, 0, 1})) << "the inner sphere encloses a void";
    const auto plane = curveOfField({9, 9, 9}, [](double x, double, double) { return x; });
    EXPECT_EQ(plane.countsAt(3.5), (SurfaceCounts{1, 1, 1, 0}));
    EXPECT_EQ(plane.events().size(), 2u) << "comes at 0, goes at 8";
    EXPECT_EQ(plane.countsAt(9.0), SurfaceCounts());
    EXPECT_EQ(plane.countsAt(0.0), SurfaceCounts());
}

TEST(TopologyCurve, FindsWhereEightSpheresJoin) {
    const auto curve = curveOfField({41, 41, 41}, [](double x, double y, double z) {
        const auto wave = [](double t) { return std::cos(2.0 * 3.14159265358979 * (t - 10.0) / 20.0); };
        return wave(x) + wave(y) + wave(z);
    });
    EXPECT_EQ(curve.countsAt(2.0).components, 8);
    EXPECT_EQ(curve.countsAt(2.0).euler, 16);
    // Neighbours join at cos 0 + cos 0 + cos pi = 1, all at once.
    EXPECT_EQ(curve.countsAt(0.99).components, 1);
    EXPECT_EQ(curve.countsAt(0.99).handles(), 5);
}

// ---- where events of analytic fields are

double distanceTo(const TopologyEvent& event, const std::array<double, 3>& place) {
    return std::hypot(event.position[0] - place[0], event.position[1] - place[1], event.position[2] - place[2]);
}

// The only event near an isovalue at which a count changes.
template <class Change>
TopologyEvent onlyEventNear(const TopologyCurve& curve, double isovalue, double tolerance, const Change& change) {
    TopologyEvent found;
    int count = 0;
    for (const TopologyEvent& event : curve.events())
        if (std::abs(event.isovalue - isovalue) < tolerance && change(event)) {
            found = event;
            ++count;
        }
    EXPECT_EQ(count, 1) << "near " << isovalue;
    return found;
}
bool changesTunnels(const TopologyEvent& event) { return event.below.handles() != event.above.handles(); }

TEST(EventPlaces, OfASphereAreItsCentreAndWhereItMeetsTheBox) {
    const std::array<double, 3> centre{10.15, 9.9, 11.2};
    const auto curve = curveOfField({21, 21, 23}, [&](double x, double y, double z) {
        return 10.0 - std::hypot(x - centre[0], y - centre[1], z - centre[2]);
    });
    const TopologyEvent last = curve.events().back();
    EXPECT_NEAR(last.isovalue, 10.0 - std::hypot(0.15, 0.1, 0.2), 1e-5) << "of the nearest grid point";
    EXPECT_EQ(last.kind, EventKind::Vertex);
    EXPECT_EQ(last.position, (std::array<float, 3>{10, 10, 11}));
    EXPECT_EQ(last.below, (SurfaceCounts{1, 2, 0, 0}));
    // It meets the sides y = 0, x = 20, x = 0, y = 20 one after the other: there loops come as the isovalue falls.
    const std::array<std::pair<double, std::array<double, 3>>, 4> sides{
        {{10 - 9.85, {20, 10, 11}}, {10 - 9.9, {10, 0, 11}}, {10 - 10.15, {0, 10, 11}}, {10 - 10.1, {10, 20, 11}}}};
    for (const auto& [isovalue, place] : sides) {
        double nearest = 1e9;
        for (const TopologyEvent& event : curve.events())
            if (std::abs(event.isovalue - isovalue) < 0.02 && event.below.loops != event.above.loops)
                nearest = std::min(nearest, distanceTo(event, place));
        EXPECT_LE(nearest, 1.0) << place[0] << ' ' << place[1];
    }
    EXPECT_EQ(curve.countsAt(0.2).loops, 0);
    EXPECT_EQ(curve.countsAt(0.0).loops, 2);
    EXPECT_EQ(curve.countsAt(-0.2).loops, 4);
}

// The hole of a ring closes in its middle, where all of the ring is equally far away.
TEST(EventPlaces, OfRingsAreTheMiddlesOfTheirHoles) {
    const auto torus = curveOfField({61, 61, 31}, [](double x, double y, double z) {
        return 6.0 - std::hypot(std::hypot(x - 30.1, y - 29.8) - 12.0, z - 15.2);
    });
    const TopologyEvent& closing = onlyEventNear(torus, -6.0, 0.5, changesTunnels);
    EXPECT_EQ(closing.below.handles(), 0);
    EXPECT_EQ(closing.above.handles(), 1);
    EXPECT_LT(distanceTo(closing, {30.1, 29.8, 15.2}), 1.2);
    const auto ring = [](double x, double y, double z, double centre) {
        return std::hypot(std::hypot(x - centre, y - 25.01) - 10.0, z - 15.02);
    };
    const auto two = curveOfField({85, 51, 31}, [&](double x, double y, double z) {
        return 4.0 - std::min(ring(x, y, z, 25.02), 1.1 * ring(x, y, z, 59.03));
    });
    EXPECT_EQ(two.countsAt(1.5).handles(), 2);
    EXPECT_LT(distanceTo(onlyEventNear(two, -6.0, 0.1, changesTunnels), {25.02, 25.01, 15.02}), 1.2);
    EXPECT_LT(distanceTo(onlyEventNear(two, -7.0, 0.1, changesTunnels), {59.03, 25.01, 15.02}), 1.2);
}

TEST(EventPlaces, OfEightSpheresAreBetweenTwoOfThem) {
    const auto curve = curveOfField({41, 41, 41}, [](double x, double y, double z) {
        const auto wave = [](double t, double centre) { return std::cos(0.31415926535897932 * (t - centre)); };
        return wave(x, 10.13) + 1.04 * wave(y, 10.21) + 1.09 * wave(z, 9.87); // so pairs along each axis join apart
    });
    // Along an axis of amplitude a neighbours join at the sum of the others less a.
    const std::array<std::pair<double, std::size_t>, 3> axes{{{1.13, 0}, {1.05, 1}, {0.95, 2}}};
    std::size_t found = 0;
    for (const TopologyEvent& event : curve.events()) {
        if (event.isovalue < 0.8 || event.isovalue > 1.3 || event.below.components == event.above.components)
            continue;
        ++found;
        const auto axis = std::min_element(axes.begin(), axes.end(), [&](const auto& a, const auto& b) {
            return std::abs(event.isovalue - a.first) < std::abs(event.isovalue - b.first);
        });
        EXPECT_NEAR(event.isovalue, axis->first, 0.03);
        EXPECT_NEAR(event.position[axis->second], 20.0, 1.0) << event.isovalue;
        for (std::size_t other = 0; other < 3; ++other)
            if (other != axis->second) {
                EXPECT_LT(std::min(std::abs(event.position[other] - 10.0F), std::abs(event.position[other] - 30.0F)),
                          1.1F);
            }
    }
    EXPECT_GE(found, 3u);
    EXPECT_EQ(curve.countsAt(1.25).components, 8);
    EXPECT_EQ(curve.countsAt(1.09).components, 4);
    EXPECT_EQ(curve.countsAt(1.0).components, 2);
    EXPECT_EQ(curve.countsAt(0.9).components, 1);
}

// It has its greatest value 3/2 where all three products are 1/2, and necks between such places at the root of 2.
TEST(EventPlaces, OfAGyroidAreItsCriticalPoints) {
    constexpr double kTurn = 2.0 * 3.14159265358979, kPeriod = 44.0;
    const auto gyroid = [](double x, double y, double z) {
        return std::sin(x) * std::cos(y) + std::sin(y) * std::cos(z) + std::sin(z) * std::cos(x);
    };
    const auto curve = curveOfField({45, 45, 45}, [&](double x, double y, double z) {
        return gyroid(kTurn * x / kPeriod, kTurn * y / kPeriod, kTurn * z / kPeriod);
    });
    std::vector<std::array<double, 3>> tops;
    for (int i = 0; i <= 8; ++i)
        for (int k = 0; k <= 8; ++k)
            for (int l = 0; l <= 8; ++l)
                if (gyroid(kTurn * i / 8, kTurn * k / 8, kTurn * l / 8) > 1.499)
                    tops.push_back({kPeriod * i / 8, kPeriod * k / 8, kPeriod * l / 8});
    ASSERT_GE(tops.size(), 4u);
    EXPECT_EQ(curve.countsAt(1.45).components, static_cast<std::int64_t>(tops.size()));
    int deaths = 0, splits = 0;
    for (const TopologyEvent& event : curve.events()) {
        if (event.isovalue < 1.36 || event.persistence < 0.03)
            continue;
        const double x = kTurn * event.position[0] / kPeriod, y = kTurn * event.position[1] / kPeriod,
                     z = kTurn * event.position[2] / kPeriod;
        // The gradient vanishes at the place, but for the steps of the grid.
        const double gradient = std::hypot(std::cos(x) * std::cos(y) - std::sin(z) * std::sin(x),
                                           std::cos(y) * std::cos(z) - std::sin(x) * std::sin(y),
                                           std::cos(z) * std::cos(x) - std::sin(y) * std::sin(z));
        EXPECT_LT(gradient, 0.2) << event.isovalue;
        EXPECT_NEAR(gyroid(x, y, z), event.isovalue, 0.03);
        if (event.pieces.deaths > 0) {
            ++deaths;
            EXPECT_NEAR(event.isovalue, 1.5, 0.01);
            double nearest = 1e9;
            for (const auto& top : tops)
                nearest = std::min(nearest, distanceTo(event, top));
            EXPECT_LT(nearest, 1.0);
        } else if (event.pieces.splits > 0) {
            ++splits;
            EXPECT_NEAR(event.isovalue, std::sqrt(2.0), 0.02);
        }
    }
    EXPECT_GT(deaths, 0);
    EXPECT_GT(splits, 0);
}

// Three hills and two valleys between them, on a plateau of 0.
TEST(TopologyCurve, PairsHillsWithThePassesWhereTheyJoinHigherOnes) {
    const auto curve = curveOfField({31, 7, 7}, [](double x, double y, double z) {
        if (y != 3.0 || z != 3.0)
            return 0.0;
        const std::array<std::pair<double, double>, 5> shape{{{5, 10}, {10, 3}, {15, 7}, {20, 4}, {25, 5}}};
        for (std::size_t i = 1; i < shape.size(); ++i)
            if (x >= shape[i - 1].first && x <= shape[i].first)
                return shape[i - 1].second + (x - shape[i - 1].first) / (shape[i].first - shape[i - 1].first) *
                                                 (shape[i].second - shape[i - 1].second);
        return 0.0;
    });
    std::map<double, double> persistence;
    for (const TopologyEvent& event : curve.events())
        if (event.below.components != event.above.components)
            persistence[event.isovalue] = event.persistence;
    const std::map<double, double> expected{{0, 10}, {3, 4}, {4, 1}, {5, 1}, {7, 4}, {10, 10}};
    EXPECT_EQ(persistence, expected);
    EXPECT_EQ(curve.countsAt(4.5).components, 3);
    EXPECT_EQ(curve.countsAt(3.5).components, 2);
}

// Layers of long rows are thin ones, of short rows thick, with many strips or one.
TEST(TopologyCurve, IsTheSameWhicheverWayALongVolumeLies) {
    const std::array<std::int64_t, 3> sizes{15'000, 3, 3};
    std::vector<double> scalars(static_cast<std::size_t>(sizes[0] * sizes[1] * sizes[2]));
    std::iota(scalars.begin(), scalars.end(), 0.0); // no ties
    std::shuffle(scalars.begin(), scalars.end(), std::mt19937(1));
    const auto turned = [&](const std::array<std::size_t, 3>& axes) { // which of the sizes x, y and z have
        const std::array<std::int64_t, 3> steps{1, sizes[0], sizes[0] * sizes[1]};
        std::vector<double> samples;
        for (std::int64_t z = 0; z < sizes[axes[2]]; ++z)
            for (std::int64_t y = 0; y < sizes[axes[1]]; ++y)
                for (std::int64_t x = 0; x < sizes[axes[0]]; ++x)
                    samples.push_back(scalars[static_cast<std::size_t>(x * steps[axes[0]] + y * steps[axes[1]] +
                                                                       z * steps[axes[2]])]);
        return curveOf(test::makeTopologyGrid(samples, {sizes[axes[0]], sizes[axes[1]], sizes[axes[2]]}, "long"));
    };
    const TopologyCurve along = turned({0, 1, 2});
    EXPECT_GT(along.eventCount(), scalars.size() / 2);
    expectSameEvents(along, turned({1, 0, 2}));
    expectSameEvents(along, turned({2, 1, 0}));
}

TEST(TopologyCurve, IsEmptyWithoutCellsAndRefusesMissingValues) {
    EXPECT_TRUE(curveOfField({9, 9, 1}, [](double x, double, double) { return x; }).events().empty());
    EXPECT_TRUE(curveOfField({3, 3, 3}, [](double, double, double) { return 1.0; }).events().empty());
    GridGeometry geometry;
    geometry.dims = {2, 2, 2};
    const std::vector<float> samples{0, 1, 2, 3, 4, 5, 6, std::nanf("")};
    const auto grid = ScalarGrid::fromValues<float>(geometry, ScalarType::F32, samples);
    EXPECT_THAT(analyseTopology(planesOf(grid)), IsOk());
}

} // namespace
} // namespace isoslider::topology
