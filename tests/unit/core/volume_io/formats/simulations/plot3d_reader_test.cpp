#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/volume_io/volume_contents.h"
#include "core/volume_io/volume_reader.h"
#include "tests/support/result_matchers.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/core/volume_io/volume_bytes.h"

namespace isoslider::io {
namespace {

constexpr GridDims kDims{8, 7, 6};

/// One way to write a pair of PLOT3D files.
struct Way {
    bool isBigEndian = true, hasMarks = false, hasCount = false, isDouble = false, hasBlanking = false,
         isPadded = false;
};

class Writer {
public:
    explicit Writer(const Way& way) : way_(way) {}

    std::string integers(const std::vector<std::int32_t>& values) const {
        std::string out;
        for (const auto value : values)
            out += ordered(value);
        return out;
    }
    std::string reals(const std::vector<double>& values) const {
        std::string out;
        for (const double value : values)
            out += way_.isDouble ? ordered(value) : ordered(static_cast<float>(value));
        return out;
    }
    std::string record(const std::string& bytes) const {
        const std::string mark = way_.hasMarks ? integers({static_cast<std::int32_t>(bytes.size())}) : "";
        return mark + bytes + mark;
    }
    std::string start(const GridDims& dims) const {
        std::vector<std::int32_t> sizes;
        for (const auto extent : dims)
            sizes.push_back(static_cast<std::int32_t>(extent));
        return (way_.hasCount ? record(integers({1})) : "") + record(integers(sizes));
    }
    std::string padded(std::string bytes) const {
        if (way_.isPadded)
            bytes.resize((bytes.size() + 511) / 512 * 512);
        return bytes;
    }

private:
    template <class T>
    std::string ordered(T value) const {
        std::string bytes(sizeof(T), '\0');
        test::put(bytes, 0, value);
        return way_.isBigEndian ? std::string(bytes.rbegin(), bytes.rend()) : bytes;
    }
    Way way_;
};

/// Point (i, j, k) lies at (2i, 3j, k), or, stretched, at (2i, 3j, k^2); blanked or not, it counts.
std::string gridFile(const Way& way, const GridDims& dims = kDims, double firstX = 0.0, bool isStretched = false) {
    std::vector<double> xyz[3];
    for (int k = 0; k < dims[2]; ++k)
        for (int j = 0; j < dims[1]; ++j)
            for (int i = 0; i < dims[0]; ++i) {
                xyz[0].push_back(xyz[0].empty() ? firstX : 2.0 * i);
                xyz[1].push_back(3.0 * j);
                xyz[2].push_back(isStretched ? k * k : k);
            }
    const Writer write(way);
    std::string values = write.reals(xyz[0]) + write.reals(xyz[1]) + write.reals(xyz[2]);
    if (way.hasBlanking)
        values += write.integers(std::vector<std::int32_t>(xyz[0].size(), 0));
    return write.padded(write.start(dims) + write.record(values));
}

/// Field f is 1000 f + the point's number.
std::string solutionFile(const Way& way, const GridDims& dims = kDims) {
    std::vector<double> values;
    for (int field = 0; field < 5; ++field)
        for (std::int64_t point = 0; point < pointCount(dims); ++point)
            values.push_back(1000.0 * field + static_cast<double>(point));
    const Writer write(way);
    return write.padded(write.start(dims) + write.record(write.reals({0.5, 1, 2, 3})) +
                        write.record(write.reals(values)));
}

class Plot3dReader : public testing::Test {
protected:
    Result<std::shared_ptr<const ScalarGrid>> read(const std::string& grid, const std::string& solution,
                                                   const std::string& field = {}) {
        ReadOptions options;
        options.field = field;
        options.resampleDims = kDims;
        const auto path = folder.write("axyz.bin", grid);
        folder.write("aq.bin", solution);
        testing::internal::CaptureStderr();
        auto out = readVolume(path, options);
        EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
        return out;
    }
    void expectRefusal(const std::string& grid, const std::string& solution, const std::string& says) {
        const auto out = read(grid, solution);
        ASSERT_THAT(out, test::HasError(ErrorCode::InvalidArgument));
        EXPECT_THAT(out.error().line(), testing::HasSubstr(says));
    }
    test::TemporaryFolder folder;
};

TEST_F(Plot3dReader, FindsEveryLayout) {
    for (unsigned bits = 0; bits < 64; ++bits) {
        const auto has = [bits](unsigned bit) { return (bits >> bit & 1) != 0; };
        const Way way{has(0), has(1), has(2), has(3), has(4), has(5)};
        const auto grid = read(gridFile(way), solutionFile(way));
        ASSERT_THAT(grid, test::IsOk()) << bits;
        EXPECT_EQ(grid.value()->geometry().spacing, glm::dvec3(2, 3, 1)) << bits;
        EXPECT_EQ(grid.value()->type(), way.isDouble ? ScalarType::F64 : ScalarType::F32) << bits;
        for (std::int64_t i = 0; i < pointCount(kDims); ++i)
            ASSERT_EQ(grid.value()->valueAt(i % kDims[0], i / kDims[0] % kDims[1], i / kDims[0] / kDims[1]),
                      static_cast<double>(i))
                << bits;
    }
}

TEST_F(Plot3dReader, ReadsEveryField) {
    const char* const names[] = {"Density", "x momentum", "momentum y", "Z Momentum", "energy"};
    for (int field = 0; field < 5; ++field) {
        const auto grid = read(gridFile({}), solutionFile({}), names[field]);
        ASSERT_THAT(grid, test::IsOk());
        EXPECT_NEAR(grid.value()->valueAt(1, 0, 0), 1000.0 * field + 1, 1e-3);
    }
    EXPECT_THAT(read(gridFile({}), solutionFile({}), "pressure"), test::HasError(ErrorCode::InvalidArgument));
}

TEST_F(Plot3dReader, RefusesEveryShorterFile) {
    const Way marked{true, true, true};
    for (const Way& way : {Way{}, marked}) {
        const std::string grid = gridFile(way), solution = solutionFile(way);
        for (std::size_t size = 1; size < grid.size(); size += size < 48 ? 5 : 997)
            expectRefusal(grid.substr(0, size), solution, "is not a PLOT3D grid");
        for (std::size_t size = 1; size < solution.size(); size += size < 48 ? 5 : 997)
            expectRefusal(grid, solution.substr(0, size), "is not a PLOT3D solution");
    }
}

TEST_F(Plot3dReader, RefusesMarksThatContradictTheirRecords) {
    const Way way{true, true};
    std::string solution = solutionFile(way);
    solution[3] = 20; // VTK would take it for one of OVERFLOW's files, with counts of its own
    expectRefusal(gridFile(way), solution, "is not a PLOT3D solution");
    std::string grid = gridFile(way);
    grid.back() = static_cast<char>(grid.back() ^ 1);
    expectRefusal(grid, solutionFile(way), "is not a PLOT3D grid");
}

TEST_F(Plot3dReader, RefusesPairsThatDisagree) {
    expectRefusal(gridFile({}), solutionFile({}, {7, 8, 6}), "dims");
    expectRefusal(gridFile({}), solutionFile({.isBigEndian = false}), "layout");
    expectRefusal(gridFile({}), solutionFile({.isDouble = true}), "layout");
    expectRefusal(gridFile({.hasMarks = true}), solutionFile({}), "layout");
    expectRefusal(gridFile({}), solutionFile({.hasCount = true}), "layout");
}

TEST_F(Plot3dReader, RefusesPointsThatAreNowhere) {
    expectRefusal(gridFile({}, kDims, std::numeric_limits<double>::quiet_NaN()), solutionFile({}), "point 0");
    expectRefusal(gridFile({}, kDims, std::numeric_limits<double>::infinity()), solutionFile({}), "point 0");
}

TEST_F(Plot3dReader, RefusesSizesBeyondTheFile) {
    const Writer write(Way{});
    for (const std::int32_t extent : {-1, 0, 1, 100'000, 100'001, std::numeric_limits<std::int32_t>::max()}) {
        std::string grid = gridFile({});
        grid.replace(0, 4, write.integers({extent}));
        expectRefusal(grid, solutionFile({}), "is not a PLOT3D grid");
    }
    const std::int32_t most = 100'000;
    expectRefusal(write.integers({most, most, most}), solutionFile({}), "is not a PLOT3D grid");
}

TEST_F(Plot3dReader, ListsItsFields) {
    folder.write("axyz.bin", gridFile({.isDouble = true}, kDims, 0.0, true));
    const auto contents = listVolumes(folder.write("aq.bin", solutionFile({.isDouble = true})));
    ASSERT_THAT(contents, test::IsOk());
    ASSERT_EQ(contents.value().fields.size(), 5u);
    EXPECT_EQ(contents.value().fields[1].name, "x momentum");
    EXPECT_EQ(contents.value().fields[0].typeName, "float64");
    EXPECT_TRUE(contents.value().fields[0].isResampled);
    EXPECT_FALSE(contents.value().needsChoice());
}

TEST_F(Plot3dReader, TellsHowWellTheGridIsKept) {
    folder.write("axyz.bin", gridFile({}, kDims, 0.0, true));
    ReadOptions options;
    options.resampleDims = kDims;
    const auto source = openVolume(folder.write("aq.bin", solutionFile({})), options);
    ASSERT_THAT(source, test::IsOk());
    EXPECT_FALSE(source.value()->info().resampling.has_value());
    std::vector<float> plane(static_cast<std::size_t>(kDims[0] * kDims[1]));
    ASSERT_THAT(source.value()->readSlab(0, 1, std::as_writable_bytes(std::span(plane))), test::IsOk());
    ASSERT_TRUE(source.value()->info().resampling.has_value());
    EXPECT_EQ(source.value()->info().resampling->comparedPoints, pointCount(kDims));
    EXPECT_GT(source.value()->info().resampling->maxDifference, 0.0);
}

TEST_F(Plot3dReader, TakesAUniformGridAsItIs) {
    folder.write("axyz.bin", gridFile({.isDouble = true}));
    const auto path = folder.write("aq.bin", solutionFile({.isDouble = true}));
    const auto listed = listVolumes(path);
    ASSERT_THAT(listed, test::IsOk());
    EXPECT_FALSE(listed.value().fields[0].isResampled);
    EXPECT_EQ(listed.value().fields[0].dims, kDims);
    const auto source = openVolume(path);
    ASSERT_THAT(source, test::IsOk());
    const VolumeInfo& info = source.value()->info();
    EXPECT_EQ(info.geometry.dims, kDims);
    EXPECT_EQ(info.geometry.spacing, glm::dvec3(2, 3, 1));
    EXPECT_EQ(info.type, ScalarType::F64);
    ASSERT_THAT(source.value()->prepare({}), test::IsOk());
    EXPECT_FALSE(source.value()->info().resampling.has_value());
    const auto grid = readVolume(path);
    ASSERT_THAT(grid, test::IsOk());
    EXPECT_EQ(grid.value()->valueAt(1, 2, 3), static_cast<double>(1 + kDims[0] * (2 + kDims[1] * 3)));
}

} // namespace
} // namespace isoslider::io
