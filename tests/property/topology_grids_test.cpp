// Whole grids have the trilinear interpolant's topology, afresh and after sliding, at every isovalue.

#include <algorithm>
#include <cmath>
#include <numeric>
#include <sstream>

#include <gtest/gtest.h>

#include "core/extract/full_extraction.h"
#include "tests/property/topology_law.h"
#include "tests/support/temporary_folder.h"

namespace isoslider::test {
namespace {

std::string at(const TopologyGrid& grid, double isovalue) {
    std::ostringstream text;
    text.precision(17);
    text << grid.description << " at isovalue " << isovalue;
    return text.str();
}

std::string testName(const testing::TestParamInfo<GridKind>& info) {
    std::string name = gridKindName(info.param);
    std::replace(name.begin(), name.end(), ' ', '_');
    return name;
}

const auto kAllKinds =
    testing::Values(GridKind::Open, GridKind::TinyIntegers, GridKind::SmallIntegers, GridKind::Closed,
                    GridKind::Saddles, GridKind::Checkerboard, GridKind::PlusMinusOne, GridKind::Plane,
                    GridKind::NearTies, GridKind::Doubles, GridKind::Extreme);

class TopologyGrids : public testing::TestWithParam<GridKind> {
protected:
    // Exact answers on scalars of any size take their time.
    static int share(int count) { return GetParam() == GridKind::Extreme ? count / 10 : count; }
    Random random_{4000 + static_cast<unsigned>(GetParam())};
};

TEST_P(TopologyGrids, HaveTheInterpolantsSurface) {
    std::int64_t tunnels = 0;
    for (int i = 0; i < share(500); ++i) {
        const TopologyGrid grid = randomTopologyGrid(GetParam(), 5, 9, random_);
        for (const double isovalue : {0.0, topologyIsovalue(grid, random_), topologyIsovalue(grid, random_)})
            ASSERT_EQ(freshFault(grid, isovalue), "") << at(grid, isovalue) << ", grid " << i;
        tunnels += sweepGrid(grid.scalars, grid.dims, 0.0).tunnels;
    }
    RecordProperty("tunnels", static_cast<int>(tunnels));
}

TEST_P(TopologyGrids, HaveTheInterpolantsSurfaceWhereTheyAreThin) {
    for (int i = 0; i < share(300); ++i) {
        const TopologyGrid grid = randomTopologyGrid(GetParam(), 2, 3, random_);
        for (const double isovalue : {0.0, topologyIsovalue(grid, random_), topologyIsovalue(grid, random_)})
            ASSERT_EQ(freshFault(grid, isovalue), "") << at(grid, isovalue) << ", grid " << i;
    }
}

// From below everything and from above everything, then at random; a stop at a saddle is the usual one.
TEST_P(TopologyGrids, AreTheSameAfterSliding) {
    const TemporaryFolder folder;
    const int judgedStops = GetParam() == GridKind::Extreme ? 40 : 4; // the judge is slow there, the slide is not
    std::int64_t patched = 0;
    for (int i = 0; i < 20; ++i) {
        const TopologyGrid grid = randomTopologyGrid(GetParam(), 2, i % 2 == 0 ? 6 : 14, random_);
        TopologyWalker walker(grid, folder / "a.isx", static_cast<int>(pickInt(random_, 1, 5)),
                              0.1 + pickUnit(random_));
        ASSERT_EQ(walker.fault(), "");
        const double target = topologyIsovalue(grid, random_);
        for (const double isovalue : {grid.min() - 1.0, target, grid.max() + 1.0, target})
            ASSERT_EQ(walker.slideFault(isovalue, true), "") << at(grid, isovalue) << ", grid " << i;
        for (int stop = 0; stop < 40; ++stop) {
            const double isovalue = walker.nextIsovalue(random_);
            ASSERT_EQ(walker.slideFault(isovalue, stop % judgedStops == 3), "")
                << at(grid, isovalue) << ", grid " << i << ", stop " << stop;
        }
        patched += walker.patchedMoves();
    }
    RecordProperty("patchedMoves", static_cast<int>(patched));
}

INSTANTIATE_TEST_SUITE_P(Kinds, TopologyGrids, kAllKinds, testName);

// The judge must be able to say no: a surface that is damaged, or of another isovalue.
TEST(TopologyLaw, FindsWhatIsWrongWithASurface) {
    Random random(3001);
    for (int i = 0; i < 20; ++i) {
        const TopologyGrid grid = randomTopologyGrid(GridKind::Saddles, 5, 6, random);
        const extract::SurfaceMesh mesh = extract::extractFull(*grid.grid, 0.0).value();
        ASSERT_EQ(surfaceFault(mesh, grid), "");
        ASSERT_GT(mesh.triangleCount(), 10u);
        extract::SurfaceMesh damaged = mesh;
        damaged.triangles.resize(mesh.triangles.size() - 3);
        EXPECT_NE(surfaceFault(damaged, grid), "") << "a triangle less";
        damaged = mesh;
        damaged.triangles.insert(damaged.triangles.end(), mesh.triangles.begin(), mesh.triangles.begin() + 3);
        EXPECT_NE(surfaceFault(damaged, grid), "") << "a triangle twice";
        damaged = mesh;
        std::swap(damaged.triangles[0], damaged.triangles[1]);
        EXPECT_NE(surfaceFault(damaged, grid), "") << "a triangle turned";
        damaged = mesh;
        damaged.triangles[0] = damaged.triangles[1];
        EXPECT_NE(surfaceFault(damaged, grid), "") << "a vertex twice";
        damaged = mesh;
        damaged.positions[0].x = std::nanf("");
        EXPECT_NE(surfaceFault(damaged, grid), "") << "a place that is none";
    }
}

// No sample lies between two stops beside a body saddle: only the inside of a cell distinguishes them.
TEST(TopologyLaw, TellsTheSurfacesOnBothSidesOfABodySaddle) {
    Random random(3002);
    int found = 0;
    for (int i = 0; i < 200; ++i) {
        const TopologyGrid grid = randomTopologyGrid(GridKind::Saddles, 3, 3, random);
        for (const double saddle : bodySaddleValues(grid.cell(0, 0, 0))) {
            const GridTopology below = sweepGrid(grid.scalars, grid.dims, saddle - 1e-9);
            const GridTopology above = sweepGrid(grid.scalars, grid.dims, saddle + 1e-9);
            if (below == above || below.activeEdges != above.activeEdges)
                continue;
            ++found;
            const extract::SurfaceMesh mesh = extract::extractFull(*grid.grid, saddle - 1e-9).value();
            EXPECT_EQ(surfaceFault(mesh, grid, below), "");
            EXPECT_NE(surfaceFault(mesh, grid, above), "");
        }
    }
    EXPECT_GT(found, 10);
}

class TiedGrids : public testing::TestWithParam<GridKind> {};

// Every isovalue that is a sample, and every one half way to the next.
TEST_P(TiedGrids, HaveTheSurfaceOfTheLimitFromBelow) {
    Random random(5000 + static_cast<unsigned>(GetParam()));
    for (int i = 0; i < 40; ++i) {
        const TopologyGrid grid = randomTopologyGrid(GetParam(), 3, 6, random);
        std::vector<double> values = grid.scalars;
        std::sort(values.begin(), values.end());
        values.erase(std::unique(values.begin(), values.end()), values.end());
        for (std::size_t k = 0; k < values.size(); ++k) {
            ASSERT_EQ(freshFault(grid, values[k]), "") << at(grid, values[k]) << ", grid " << i;
            const double between = k > 0 ? std::midpoint(values[k - 1], values[k]) : values[k] - 1.0;
            ASSERT_EQ(freshFault(grid, between), "") << at(grid, between) << ", grid " << i;
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Kinds, TiedGrids,
                         testing::Values(GridKind::TinyIntegers, GridKind::SmallIntegers, GridKind::PlusMinusOne,
                                         GridKind::Plane, GridKind::Saddles),
                         testName);

TEST(TiedGrids, HoldForCheckerboardsAndConstants) {
    const std::array<std::int64_t, 3> dims{6, 5, 7};
    for (const double amplitude : {0.0, 1.0, 127.0, 0.1, 1e-310, 1e300}) {
        std::vector<double> scalars;
        for (std::int64_t i = 0; i < 6 * 5 * 7; ++i)
            scalars.push_back((i % 6 + i / 6 % 5 + i / 30) % 2 == 0 ? amplitude : -amplitude);
        const TopologyGrid grid =
            makeTopologyGrid(std::move(scalars), dims, "checkerboard of " + std::to_string(amplitude));
        for (const double isovalue : {amplitude, -amplitude, 0.0, 0.5 * amplitude, 2.0 * amplitude})
            EXPECT_EQ(freshFault(grid, isovalue), "") << at(grid, isovalue);
    }
}

// Up and down through every saddle of a small grid: just below it, at it, just above.
TEST(SaddleWalk, KeepsBothCellsOfAFaceTogether) {
    Random random(6001);
    const TemporaryFolder folder;
    std::size_t moves = 0;
    for (int i = 0; i < 20; ++i) {
        const TopologyGrid grid = randomTopologyGrid(i % 2 == 0 ? GridKind::Saddles : GridKind::Doubles, 4, 5, random);
        std::vector<double> stops;
        for (std::int64_t z = 0; z + 1 < grid.dims[2]; ++z)
            for (std::int64_t y = 0; y + 1 < grid.dims[1]; ++y)
                for (std::int64_t x = 0; x + 1 < grid.dims[0]; ++x)
                    for (const auto& saddles :
                         {faceSaddleValues(grid.cell(x, y, z)), bodySaddleValues(grid.cell(x, y, z))})
                        for (const double saddle : saddles)
                            for (const double side : {-1e300, 1e300})
                                stops.insert(stops.end(), {saddle, std::nextafter(saddle, side)});
        std::sort(stops.begin(), stops.end());
        TopologyWalker walker(grid, folder / "a.isx", 3, 0.3);
        ASSERT_EQ(walker.fault(), "");
        for (std::size_t k = 0; k < stops.size(); ++k)
            ASSERT_EQ(walker.slideFault(stops[k], k % 8 == 0), "")
                << at(grid, stops[k]) << ", grid " << i << " upwards";
        for (auto stop = stops.rbegin(); stop != stops.rend(); ++stop)
            ASSERT_EQ(walker.slideFault(*stop, false), "") << at(grid, *stop) << ", grid " << i << " downwards";
        moves += 2 * stops.size();
    }
    RecordProperty("moves", static_cast<int>(moves));
    EXPECT_GT(moves, 5000u);
}

} // namespace
} // namespace isoslider::test
