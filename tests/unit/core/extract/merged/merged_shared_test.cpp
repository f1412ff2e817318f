// Counts of an independent program on real volumes, where the folder with further test data is there.

#include <filesystem>
#include <map>
#include <sstream>

#include <gtest/gtest.h>

#include "core/extract/merged/merged_extraction.h"
#include "core/grid/volume_statistics.h"
#include "core/volume_io/volume_reader.h"
#include "tests/support/csv_rows.h"
#include "tests/support/result_matchers.h"

namespace isoslider::extract {
namespace {

namespace fs = std::filesystem;
const fs::path kShared = ISOSLIDER_SHARED_DIR;

struct Row {
    std::string volume, bound;
    double isovalue = 0.0;
    std::uint64_t triangles = 0, vertices = 0;
    LeafCounts leaves{};
};

std::vector<Row> readRows(const fs::path& path) {
    std::vector<Row> rows;
    test::forEachCsvRow(path, [&](std::istringstream& columns) {
        Row row;
        std::int64_t euler = 0, components = 0;
        columns >> row.volume >> row.isovalue >> row.bound >> row.triangles >> row.vertices >> euler >> components;
        for (auto& leaves : row.leaves)
            columns >> leaves;
        rows.push_back(row);
    });
    return rows;
}

MergeBound boundOf(const std::string& text, double range) {
    const auto amount = [&](std::string_view prefix) { return std::stod(text.substr(prefix.size())); };
    if (text.starts_with("scalar_percent_"))
        return {MergeBound::Measure::Scalar, amount("scalar_percent_") / 100.0 * range};
    if (text.starts_with("distance_cells_"))
        return {MergeBound::Measure::Distance, amount("distance_cells_")};
    return {};
}

TEST(MergedReference, HasTheLeavesAndVerticesOfAnIndependentProgram) {
    const fs::path list = kShared / "reference" / "lod" / "leaves.csv";
    if (!fs::exists(list))
        GTEST_SKIP() << "needs " << list;
    std::map<std::string, std::shared_ptr<const ScalarGrid>> grids;
    int rows = 0;
    for (const Row& row : readRows(list)) {
        const fs::path path = kShared / "data" / "mhd" / (row.volume + ".mhd");
        if (!fs::exists(path))
            continue; // made by a formula
        auto& grid = grids[row.volume];
        if (grid == nullptr) {
            const auto source = io::openVolume(path.string(), {}, {});
            ASSERT_THAT(source, test::IsOk());
            const auto read = io::readVolume(*source.value(), path.string(), {});
            ASSERT_THAT(read, test::IsOk());
            grid = read.value();
        }
        const auto statistics = computeStatistics(*grid, false);
        ASSERT_THAT(statistics, test::IsOk());
        LeafCounts leaves{};
        const auto mesh =
            extractMerged(*grid, row.isovalue, boundOf(row.bound, statistics.value().max - statistics.value().min),
                          kMaxMergeLevel, {}, &leaves);
        ASSERT_THAT(mesh, test::IsOk());
        // Cells exactly at the bound may fall to either side.
        constexpr double kHandful = 8.0;
        for (std::size_t n = 0; n < leaves.size(); ++n)
            EXPECT_NEAR(static_cast<double>(leaves[n]), static_cast<double>(row.leaves[n]), kHandful)
                << row.volume << " " << row.isovalue << " " << row.bound << ", level " << n;
        EXPECT_NEAR(static_cast<double>(mesh.value().edgeIds.size()), static_cast<double>(row.vertices), kHandful)
            << row.volume << " " << row.isovalue << " " << row.bound;
        ++rows;
    }
    EXPECT_GE(rows, 14);
}

} // namespace
} // namespace isoslider::extract
