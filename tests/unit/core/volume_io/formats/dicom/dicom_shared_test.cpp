#include <algorithm>
#include <fstream>
#include <iomanip>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <xxhash.h>

#include "core/grid/volume_statistics.h"
#include "core/volume_io/volume_contents.h"
#include "core/volume_io/volume_reader.h"
#include "tests/support/process_runner.h"
#include "tests/support/result_matchers.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_paths.h"

// Real series against what pydicom reads of them: tests/data/dicom_series.csv, made by
// tests/support/readings/dicom.py. The series are packed, so they are not among the other readings.

namespace isoslider::io {
namespace {

namespace fs = std::filesystem;

const fs::path kData = fs::path(test::sharedFolder()) / "data";

/// The row of a file, cell by cell; empty without one.
std::vector<std::string> readingOf(const std::string& file) {
    std::ifstream table(fs::path(test::sourceFolder()) / "tests/data/dicom_series.csv");
    for (std::string line; std::getline(table, line);) {
        std::istringstream row(line);
        std::vector<std::string> cells;
        for (std::string cell; std::getline(row, cell, ',');)
            cells.push_back(cell);
        if (!cells.empty() && cells[0] == file)
            return cells;
    }
    return {};
}

struct Series {
    const char* archive;
    glm::dvec3 spacing, origin;
};

void PrintTo(const Series& series, std::ostream* out) { *out << series.archive; } // NOLINT: GoogleTest's name

class DicomSeries : public testing::TestWithParam<Series> {
protected:
    void SetUp() override {
        const fs::path archive = kData / GetParam().archive;
        if (!fs::exists(archive))
            GTEST_SKIP() << "further test data is not here: " << archive;
        const auto unpacked =
            test::runProcess("/usr/bin/tar", {"--zstd", "-xf", archive.string(), "-C", folder_.path().string()});
        if (unpacked.exitCode != 0)
            GTEST_SKIP() << "cannot unpack " << archive << ": " << unpacked.standardError;
    }

    test::TemporaryFolder folder_;
};

TEST_P(DicomSeries, HasTheSamplesThatPydicomReads) {
    const auto cells = readingOf(GetParam().archive);
    ASSERT_EQ(cells.size(), 13u);
    const auto grid = readVolume(folder_.path());
    ASSERT_THAT(grid, test::IsOk());
    const GridDims& dims = grid.value()->dims();
    for (std::size_t axis = 0; axis < 3; ++axis)
        EXPECT_EQ(std::to_string(dims[axis]), cells[4 + axis]);
    EXPECT_EQ(scalarTypeName(grid.value()->type()), cells[7]);
    const auto statistics = computeStatistics(*grid.value());
    ASSERT_THAT(statistics, test::IsOk());
    EXPECT_EQ(statistics.value().min, std::stod(cells[8]));
    EXPECT_EQ(statistics.value().max, std::stod(cells[9]));
    EXPECT_EQ(std::to_string(statistics.value().distinctValues), cells[10]);
    const auto bytes = grid.value()->bytes();
    std::ostringstream hash;
    hash << std::hex << std::setfill('0') << std::setw(16) << XXH3_64bits(bytes.data(), bytes.size());
    EXPECT_EQ(hash.str(), cells[12]);
    const GridGeometry& geometry = grid.value()->geometry();
    for (int axis = 0; axis < 3; ++axis) {
        EXPECT_NEAR(geometry.spacing[axis], GetParam().spacing[axis], 1e-6);
        EXPECT_NEAR(geometry.origin[axis], GetParam().origin[axis], 1e-6);
    }
    EXPECT_FALSE(geometry.isLeftHanded());
}

// The distance of two slices of the middle stays what it was, so exactly one is missing.
TEST_P(DicomSeries, WithoutOneSliceIsRefused) {
    std::vector<fs::path> files;
    for (const auto& entry : fs::recursive_directory_iterator(folder_.path()))
        if (entry.is_regular_file())
            files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    // Neither end: that would be a shorter volume.
    const auto before = listVolumes(folder_.path());
    ASSERT_THAT(before, test::IsOk());
    ASSERT_EQ(before.value().fields.size(), 1u);
    EXPECT_EQ(before.value().fields[0].problem, "");
    fs::remove(files[files.size() / 2]);
    const auto source = openVolume(folder_.path());
    ASSERT_THAT(source, test::HasError(ErrorCode::InvalidArgument));
    EXPECT_THAT(source.error().message, testing::HasSubstr("slices are missing: 1 between"));
}

INSTANTIATE_TEST_SUITE_P(Packed, DicomSeries,
                         testing::Values(Series{"dicom/philips_phantom_ct_S2020.tar.zst",
                                                {0.451171875, 0.451171875, 1.0},
                                                {-115.5, -1.85, 694.21}},
                                         Series{"dicom/studyforrest_t1w.tar.zst",
                                                {0.699987828731537, 0.666666686534882, 0.666666686534882},
                                                {-91.4495864331908, -160.06035870244, -142.505487236053}}));

} // namespace
} // namespace isoslider::io
