// Merged cells on real volumes, where the folder with further test data is there: counts of an independent program, and
// what must stay as it is.

#include <filesystem>
#include <map>
#include <span>
#include <sstream>

#include <gtest/gtest.h>

#include "core/extract/full_extraction.h"
#include "core/extract/merged/merged_extraction.h"
#include "core/grid/volume_statistics.h"
#include "core/mesh/certificate.h"
#include "core/volume_io/volume_reader.h"
#include "tests/support/csv_rows.h"
#include "tests/support/result_matchers.h"
#include "tests/support/test_paths.h"

namespace isoslider::extract {
namespace {

namespace fs = std::filesystem;
const fs::path kShared = test::sharedFolder();

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

std::shared_ptr<const ScalarGrid> readGrid(const fs::path& path) {
    const auto source = io::openVolume(path.string(), {}, {});
    EXPECT_THAT(source, test::IsOk());
    const auto read = source.isOk() ? io::readVolume(*source.value(), path.string(), {}) : source.error();
    EXPECT_THAT(read, test::IsOk());
    return read.isOk() ? read.value() : nullptr;
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
        if (grid == nullptr)
            grid = readGrid(path);
        ASSERT_NE(grid, nullptr);
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

class MergedVolume : public testing::TestWithParam<const char*> {
protected:
    void SetUp() override {
        const fs::path path = kShared / "data" / GetParam();
        if (!fs::exists(path))
            GTEST_SKIP() << "needs " << path;
        grid_ = readGrid(path);
        ASSERT_NE(grid_, nullptr);
        const auto statistics = computeStatistics(*grid_, false);
        ASSERT_THAT(statistics, test::IsOk());
        min_ = statistics.value().min;
        max_ = statistics.value().max;
    }

    // At even steps through the range, samples' own values among them.
    void compare(int isovalues, std::span<const MergeError> errors) {
        std::uint64_t all = 0, merged = 0;
        for (int i = 0; i < isovalues && !HasFailure(); ++i) {
            const double isovalue = min_ + (max_ - min_) * (i + 1) / (isovalues + 1);
            const auto full = extractFull(*grid_, isovalue);
            ASSERT_THAT(full, test::IsOk());
            const auto expected = mesh::certify(full.value(), {"", std::nullopt, ""});
            for (const MergeError& error : errors) {
                SCOPED_TRACE(testing::Message() << isovalue << ", error " << error.amount);
                const auto mesh = extractMerged(*grid_, isovalue, extract::boundOf(error, min_, max_));
                ASSERT_THAT(mesh, test::IsOk());
                const auto found = mesh::certify(mesh.value(), {"", std::nullopt, ""});
                EXPECT_TRUE(mesh::isValid(found));
                EXPECT_EQ(found.openAt(mesh::OpenAt::Elsewhere).edges, 0u) << "a crack";
                EXPECT_EQ(found.report.components, expected.report.components);
                EXPECT_EQ(found.report.euler, expected.report.euler);
                EXPECT_EQ(found.report.boundaryLoops, expected.report.boundaryLoops);
                all += expected.report.triangles;
                merged += found.report.triangles;
            }
        }
        EXPECT_LT(merged, all);
        RecordProperty("triangles without merging", std::to_string(all));
        RecordProperty("triangles", std::to_string(merged));
    }

    std::shared_ptr<const ScalarGrid> grid_;
    double min_ = 0.0, max_ = 0.0;
};

TEST_P(MergedVolume, HasNoCrackAtAnyError) {
    using Measure = MergeBound::Measure;
    const MergeError errors[] = {{Measure::Scalar, 0.3},
                                 {Measure::Scalar, 1.5},
                                 {Measure::Distance, 0.1},
                                 {Measure::Distance, 0.25},
                                 {Measure::Distance, 1.0}};
    compare(50, errors);
}

TEST_P(MergedVolume, HasTheTopologyOfTheWholeSurface) {
    const MergeError errors[] = {{MergeBound::Measure::Distance, 0.5}};
    compare(200, errors);
}

INSTANTIATE_TEST_SUITE_P(Volumes, MergedVolume,
                         testing::Values("mha/nucleon.mha", "mha/fuel.mha", "mha/neghip.mha", "mha/silicium.mha",
                                         "vti/heart.vti"));

} // namespace
} // namespace isoslider::extract
