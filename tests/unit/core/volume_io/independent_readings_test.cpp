#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <xxhash.h>

#include "core/grid/volume_statistics.h"
#include "core/volume_io/volume_contents.h"
#include "core/volume_io/volume_reader.h"
#include "tests/support/result_matchers.h"
#include "tests/support/test_paths.h"

// Real files against readings that other programs took of them: every table in tests/data/readings, made by
// the script of the same name in tests/support/readings.

namespace isoslider::io {
namespace {

const std::filesystem::path kData = std::filesystem::path(test::sharedFolder()) / "data";
const std::filesystem::path kReadings = std::filesystem::path(test::sourceFolder()) / "tests" / "data" / "readings";
constexpr const char* kColumns = "file,field,component,frame,nx,ny,nz,type,min,max,distinct,missing,xxh3";

struct Reading {
    std::string label;
    std::vector<std::string> cells; ///< in the order of kColumns; empty if its table cannot be read
};

void PrintTo(const Reading& reading, std::ostream* out) { *out << reading.label; } // NOLINT: GoogleTest's name

// A cell with a comma stands in double quotes, a quote in it twice.
std::vector<std::string> cellsOf(const std::string& line) {
    std::vector<std::string> cells(1);
    bool isQuoted = false;
    for (std::size_t i = 0; i < line.size(); ++i) {
        if (line[i] == '"' && isQuoted && line[i + 1 < line.size() ? i + 1 : i] == '"' && i + 1 < line.size())
            cells.back() += line[++i];
        else if (line[i] == '"')
            isQuoted = !isQuoted;
        else if (line[i] == ',' && !isQuoted)
            cells.emplace_back();
        else if (line[i] != '\r')
            cells.back() += line[i];
    }
    return cells;
}

std::vector<Reading> allReadings() {
    std::vector<std::filesystem::path> tables;
    std::error_code ignored;
    for (const auto& entry : std::filesystem::directory_iterator(kReadings, ignored))
        if (entry.path().extension() == ".csv")
            tables.push_back(entry.path());
    std::sort(tables.begin(), tables.end());
    std::vector<Reading> readings;
    for (const auto& table : tables) {
        std::ifstream file(table);
        std::string line;
        std::getline(file, line);
        const std::size_t columns = cellsOf(kColumns).size();
        if (cellsOf(line) != cellsOf(kColumns))
            readings.push_back({table.stem().string() + "_columns", {}});
        for (int number = 2; std::getline(file, line); ++number) {
            Reading reading{table.stem().string() + "_" + std::to_string(number) + "_", cellsOf(line)};
            reading.label += std::filesystem::path(reading.cells[0]).filename().string();
            if (reading.cells.size() != columns)
                reading.cells.clear();
            readings.push_back(std::move(reading));
        }
    }
    for (Reading& reading : readings)
        std::replace_if(
            reading.label.begin(), reading.label.end(),
            [](char c) { return !std::isalnum(static_cast<unsigned char>(c)); }, '_');
    return readings;
}

double number(const std::string& cell) {
    double value = -1.0;
    const auto end = std::from_chars(cell.data(), cell.data() + cell.size(), value).ptr;
    EXPECT_EQ(end, cell.data() + cell.size()) << cell;
    return value;
}

std::string xxh3(std::span<const std::byte> bytes) {
    char text[17];
    std::snprintf(text, sizeof text, "%016llx",
                  static_cast<unsigned long long>(XXH3_64bits(bytes.data(), bytes.size())));
    return text;
}

class IndependentReading : public testing::TestWithParam<Reading> {};

TEST_P(IndependentReading, IsThatOfOurReader) {
    const auto& cells = GetParam().cells;
    ASSERT_FALSE(cells.empty()) << "columns expected: " << kColumns;
    const auto path = kData / cells[0];
    if (!std::filesystem::exists(path))
        GTEST_SKIP() << "further test data is not here: " << path;
    ReadOptions options;
    options.field = cells[1];
    if (!cells[2].empty())
        options.component = cells[2] == "magnitude" ? kMagnitude : static_cast<int>(number(cells[2]));
    if (!cells[3].empty())
        options.frame = static_cast<std::int64_t>(number(cells[3]));
    const auto read = readVolume(path, options);
    ASSERT_THAT(read, test::IsOk());
    const ScalarGrid& grid = *read.value();
    for (std::size_t axis = 0; axis < 3; ++axis)
        EXPECT_EQ(grid.dims()[axis], static_cast<std::int64_t>(number(cells[4 + axis])));
    EXPECT_EQ(scalarTypeName(grid.type()), cells[7]);
    const auto statistics = computeStatistics(grid);
    ASSERT_THAT(statistics, test::IsOk());
    EXPECT_EQ(statistics.value().min, number(cells[8]));
    EXPECT_EQ(statistics.value().max, number(cells[9]));
    EXPECT_EQ(static_cast<double>(statistics.value().distinctValues), number(cells[10]));
    EXPECT_EQ(static_cast<double>(statistics.value().nanCount), number(cells[11]));
    EXPECT_EQ(xxh3(grid.bytes()), cells[12]);
}

INSTANTIATE_TEST_SUITE_P(Files, IndependentReading, testing::ValuesIn(allReadings()),
                         [](const auto& parameter) { return parameter.param.label; });

// Where samples lie: tests/data/readings/places. Files with several volumes lie where their first one does.
TEST(IndependentPlaces, AreThoseOfOurReaders) {
    if (!std::filesystem::exists(kData))
        GTEST_SKIP() << "further test data is not here: " << kData;
    for (const auto& table : std::filesystem::directory_iterator(kReadings / "places")) {
        std::ifstream file(table.path());
        std::string line;
        std::getline(file, line);
        while (std::getline(file, line)) {
            SCOPED_TRACE(line);
            const auto cells = cellsOf(line);
            ASSERT_EQ(cells.size(), 13u);
            const auto contents = listVolumes(kData / cells[0]);
            ASSERT_THAT(contents, test::IsOk());
            ReadOptions options;
            const VolumeField& field = contents.value().fields[0];
            if (field.components > 1)
                options.component = 0;
            if (field.frames > 1)
                options.frame = 0;
            const auto source = openVolume(kData / cells[0], options);
            ASSERT_THAT(source, test::IsOk());
            const GridGeometry& geometry = source.value()->info().geometry;
            const glm::dmat4 world = geometry.indexToWorld();
            for (int row = 0; row < 3; ++row)
                for (int column = 0; column < 4; ++column)
                    EXPECT_NEAR(world[column][row], number(cells[static_cast<std::size_t>(1 + 4 * row + column)]),
                                1e-5 * geometry.spacing[std::min(column, 2)]);
        }
    }
}

TEST(IndependentReadings, AreThere) { EXPECT_FALSE(allReadings().empty()) << kReadings; }

} // namespace
} // namespace isoslider::io
