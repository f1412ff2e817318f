#include <cmath>
#include <limits>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/volume_io/volume_reader.h"
#include "tests/support/result_matchers.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/core/volume_io/volume_bytes.h"

namespace isoslider::io {
namespace {

std::string header(const std::string& encoding, const std::string& type) {
    return "# vtk DataFile Version 3.0\ntitle\n" + encoding +
           "\nDATASET STRUCTURED_POINTS\nDIMENSIONS 2 1 1\n"
           "ORIGIN -1.5 0.1 1e3\nASPECT_RATIO 0.25 1 3\nPOINT_DATA 2\nSCALARS s " +
           type + "\nLOOKUP_TABLE default\n";
}

class VtkLegacyReader : public testing::Test {
protected:
    Result<std::shared_ptr<const ScalarGrid>> read(const std::string& bytes) {
        testing::internal::CaptureStderr();
        auto grid = readVolume(folder.write("a.vtk", bytes));
        EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
        return grid;
    }

    /// Both values survive, as big-endian bytes and as text.
    template <class T>
    void expectRead(const std::string& type, ScalarType memory, T first, T second) {
        std::string samples;
        for (const T value : {first, second}) {
            std::string bytes(sizeof(T), '\0');
            test::put(bytes, 0, value);
            samples.append(bytes.rbegin(), bytes.rend());
        }
        std::ostringstream text;
        text.precision(std::numeric_limits<T>::max_digits10);
        text << +first << "\t" << +second;
        for (const std::string& file : {header("BINARY", type) + samples, header("ASCII", type) + text.str()}) {
            const auto grid = read(file);
            ASSERT_THAT(grid, test::IsOk()) << type;
            EXPECT_EQ(grid.value()->type(), memory) << type;
            EXPECT_EQ(grid.value()->valueAt(0, 0, 0), static_cast<double>(first)) << type;
            EXPECT_EQ(grid.value()->valueAt(1, 0, 0), static_cast<double>(second)) << type;
        }
    }
    template <class T>
    void expectLimits(const std::string& type, ScalarType memory) {
        expectRead<T>(type, memory, std::numeric_limits<T>::lowest(), std::numeric_limits<T>::max());
    }
    test::TemporaryFolder folder;
};

TEST_F(VtkLegacyReader, ReadsTheLimitsOfEveryType) {
    expectLimits<std::uint8_t>("unsigned_char", ScalarType::U8);
    expectLimits<std::int8_t>("char", ScalarType::I8);
    expectLimits<std::uint16_t>("unsigned_short", ScalarType::U16);
    expectLimits<std::int16_t>("short 1", ScalarType::I16);
    expectLimits<std::uint32_t>("unsigned_int", ScalarType::F64);
    expectLimits<std::int32_t>("int", ScalarType::I32);
    expectLimits<std::int32_t>("vtkIdType", ScalarType::I32);
    expectLimits<float>("float", ScalarType::F32);
    expectLimits<double>("double", ScalarType::F64);
    expectRead<float>("float", ScalarType::F32, 0.1f, 16777215.0f);
}

TEST_F(VtkLegacyReader, WidensIntegersOf64BitsWhileTheyAreExact) {
    const std::int64_t most = std::int64_t{1} << 53;
    for (const char* type : {"long", "vtktypeint64"})
        expectRead<std::int64_t>(type, ScalarType::F64, -most, most);
    for (const char* type : {"unsigned_long", "vtktypeuint64"})
        expectRead<std::uint64_t>(type, ScalarType::F64, 0, static_cast<std::uint64_t>(most));
    EXPECT_THAT(read(header("ASCII", "long") + "1 9007199254740993"), test::HasError(ErrorCode::InvalidArgument));
}

TEST_F(VtkLegacyReader, KeepsMissingValuesOfBinaryFiles) {
    const auto grid = read(header("BINARY", "float") + std::string("\x7f\xc0\0\0\x3f\x80\0\0", 8));
    ASSERT_THAT(grid, test::IsOk());
    EXPECT_TRUE(std::isnan(grid.value()->valueAt(0, 0, 0)));
    EXPECT_EQ(grid.value()->valueAt(1, 0, 0), 1.0);
}

TEST_F(VtkLegacyReader, TakesPlaceAndSpacingFromTheHeader) {
    const auto grid = read(header("ASCII", "float") + "1 2");
    ASSERT_THAT(grid, test::IsOk());
    EXPECT_EQ(grid.value()->geometry().origin, glm::dvec3(-1.5, 0.1, 1e3));
    EXPECT_EQ(grid.value()->geometry().spacing, glm::dvec3(0.25, 1, 3));
}

TEST_F(VtkLegacyReader, PassesNothingElseOfTheFileOn) {
    // Behind the wanted array, in words that would make VTK allocate 100 GB.
    const auto grid = read(header("ASCII", "short") + "1 2\nCELL_DATA 99999999999\nSCALARS t float 1000\n");
    ASSERT_THAT(grid, test::IsOk());
    EXPECT_EQ(grid.value()->valueAt(1, 0, 0), 2.0);
}

TEST_F(VtkLegacyReader, RefusesEveryShorterFile) {
    const std::string whole = test::vtkBinary();
    for (std::size_t size = 1; size + 1 < whole.size(); ++size)
        ASSERT_FALSE(read(whole.substr(0, size)).isOk()) << size;
}

} // namespace
} // namespace isoslider::io
