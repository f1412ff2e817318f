// The published grids of known topology, where the folder with further test data is there.

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <map>
#include <sstream>

#include <gtest/gtest.h>

#include "core/extract/full_extraction.h"
#include "core/mesh/mesh_checks.h"
#include "tests/property/topology_law.h"
#include "tests/support/csv_rows.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_paths.h"

namespace isoslider::test {
namespace {

std::filesystem::path listed(const char* name) {
    return std::filesystem::path(test::sharedFolder()) / "reference" / "topology" / name;
}

// Rows of a file of numbers, the line of names left out; words become NaN.
std::vector<std::vector<double>> readRows(const std::filesystem::path& path) {
    std::vector<std::vector<double>> rows;
    forEachCsvRow(path, [&](std::istringstream& columns) {
        std::vector<double>& row = rows.emplace_back();
        for (std::string word; columns >> word;) {
            char* end = nullptr;
            const double number = std::strtod(word.c_str(), &end);
            row.push_back(*end == '\0' ? number : std::nan(""));
        }
    });
    return rows;
}

// id, three dims, `skipped` further columns, values
TopologyGrid gridOfRow(const std::vector<double>& row, std::size_t skipped) {
    const std::array<std::int64_t, 3> dims{std::llround(row[1]), std::llround(row[2]), std::llround(row[3])};
    return makeTopologyGrid({row.begin() + 4 + static_cast<std::ptrdiff_t>(skipped), row.end()}, dims,
                            "grid " + std::to_string(std::llround(row[0])));
}

class ListedGrids : public testing::TestWithParam<const char*> {};

TEST_P(ListedGrids, HaveTheListedCounts) {
    if (!std::filesystem::exists(listed(GetParam())))
        GTEST_SKIP() << "further test data is not here: " << listed(GetParam());
    const TemporaryFolder folder;
    const auto rows = readRows(listed(GetParam()));
    ASSERT_GT(rows.size(), 100u);
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const TopologyGrid grid = gridOfRow(rows[i], 5);
        ASSERT_EQ(grid.scalars.size(), 125u);
        const GridTopology found = sweepGrid(grid.scalars, grid.dims, 0.0, static_cast<int>(i % 3));
        const GridTopology expected{std::llround(rows[i][5]), std::llround(rows[i][4]), std::llround(rows[i][6]),
                                    std::llround(rows[i][8]), found.tunnels};
        ASSERT_EQ(toString(found), toString(expected)) << grid.description;
        const auto fresh = extract::extractFull(*grid.grid, 0.0);
        ASSERT_TRUE(fresh.isOk());
        ASSERT_EQ(surfaceFault(fresh.value(), grid, expected), "") << grid.description;
        if (i % 25 != 0)
            continue;
        TopologyWalker walker(grid, folder / "a.isx", 3, 0.3);
        ASSERT_EQ(walker.fault(), "");
        for (const double isovalue : {grid.min(), 0.0, grid.max() + 1.0, 0.0})
            ASSERT_EQ(walker.slideFault(isovalue, true), "") << grid.description;
    }
}

INSTANTIATE_TEST_SUITE_P(Files, ListedGrids,
                         testing::Values("grids_open_5.csv", "grids_open_5_small.csv", "hard_grids_5.csv"));

// Columns of events_4.csv: grid, isovalue, kind, Euler number, components and loops below, the same above.
TEST(ListedEvents, ChangeTheCountsAsListed) {
    if (!std::filesystem::exists(listed("events_4.csv")))
        GTEST_SKIP() << "further test data is not here: " << listed("events_4.csv");
    std::map<std::int64_t, TopologyGrid> grids;
    for (const auto& row : readRows(listed("event_grids_4.csv")))
        grids.emplace(std::llround(row[0]), gridOfRow(row, 0));
    const auto events = readRows(listed("events_4.csv"));
    ASSERT_GT(events.size(), 6000u);
    for (const auto& event : events) {
        const TopologyGrid& grid = grids.at(std::llround(event[0]));
        // A saddle's value is listed to six decimals, a sample's exactly.
        const bool isAtSample = event[1] == std::round(event[1]);
        const double below = isAtSample ? event[1] : event[1] - 2e-6,
                     above = isAtSample ? std::nextafter(event[1], 1e9) : event[1] + 2e-6;
        for (const auto& [isovalue, first] : {std::pair(below, std::size_t{3}), std::pair(above, std::size_t{6})}) {
            GridTopology expected = sweepGrid(grid.scalars, grid.dims, isovalue);
            ASSERT_EQ(expected.euler, std::llround(event[first])) << grid.description << " at " << isovalue;
            ASSERT_EQ(expected.components, std::llround(event[first + 1]));
            ASSERT_EQ(expected.loops, std::llround(event[first + 2]));
            const auto fresh = extract::extractFull(*grid.grid, isovalue);
            ASSERT_TRUE(fresh.isOk());
            ASSERT_EQ(surfaceFault(fresh.value(), grid, expected), "") << grid.description << " at " << isovalue;
        }
    }
}

// Columns of a listed state: name (no number), signs, eight scalars, loops, components, Euler number.
struct CellRow {
    std::array<double, 8> scalars{};
    std::int64_t loops = 0, components = 0, euler = 0;
};

std::vector<CellRow> readCells(const std::filesystem::path& path) {
    std::vector<CellRow> cells;
    for (const std::vector<double>& row : readRows(path)) {
        CellRow& cell = cells.emplace_back();
        std::copy_n(row.begin() + 2, 8, cell.scalars.begin());
        cell.loops = std::llround(row[10]);
        cell.components = std::llround(row[11]);
        cell.euler = std::llround(row[12]);
    }
    return cells;
}

// A volume of one cell, each scalar times `scale` plus `shift`.
template <class Sample>
ScalarGrid cellGrid(ScalarType type, const CellRow& cell, double scale, double shift) {
    GridGeometry geometry;
    geometry.dims = {2, 2, 2};
    std::vector<Sample> samples;
    for (const double scalar : cell.scalars)
        samples.push_back(static_cast<Sample>(scalar * scale + shift));
    return ScalarGrid::fromValues<Sample>(geometry, type, samples);
}

template <class Sample>
void expectListed(ScalarType type, const CellRow& cell, double scale, double shift) {
    const auto surface = extract::extractFull(cellGrid<Sample>(type, cell, scale, shift), shift);
    ASSERT_TRUE(surface.isOk());
    const mesh::MeshReport report = mesh::checkMesh(surface.value());
    EXPECT_EQ(report.boundaryLoops, static_cast<std::uint64_t>(cell.loops));
    EXPECT_EQ(report.components, static_cast<std::uint64_t>(cell.components));
    EXPECT_EQ(report.euler, cell.euler);
    EXPECT_TRUE(report.isManifold && report.isOriented);
    EXPECT_EQ(report.degenerateTriangles + report.duplicateTriangles, 0u);
}

TEST(ListedCells, AreExtractedInEveryScalarType) {
    if (!std::filesystem::exists(listed("cell_states_768.csv")))
        GTEST_SKIP() << "further test data is not here: " << listed("cell_states_768.csv");
    const std::vector<CellRow> cells = readCells(listed("cell_states_768.csv"));
    ASSERT_EQ(cells.size(), 768u);
    for (std::size_t i = 0; i < cells.size() && !HasFailure(); ++i) {
        SCOPED_TRACE("state " + std::to_string(i));
        expectListed<std::uint8_t>(ScalarType::U8, cells[i], 1.0, 17.0);
        expectListed<std::int8_t>(ScalarType::I8, cells[i], 1.0, 0.0);
        expectListed<std::uint16_t>(ScalarType::U16, cells[i], 100.0, 1000.0);
        expectListed<std::int16_t>(ScalarType::I16, cells[i], 1000.0, -1000.0);
        expectListed<std::int32_t>(ScalarType::I32, cells[i], 1e6, -1000.0);
        for (const double scale : {1e-6, 1.0, 1e6}) {
            expectListed<float>(ScalarType::F32, cells[i], scale, 0.0);
            expectListed<double>(ScalarType::F64, cells[i], scale, 17.0);
        }
    }
}

} // namespace
} // namespace isoslider::test
