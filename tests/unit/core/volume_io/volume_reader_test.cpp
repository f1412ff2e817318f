#include "core/volume_io/volume_reader.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/result_matchers.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/core/volume_io/volume_bytes.h"

namespace isoslider::io {
namespace {

using test::replaced;
using test::TemporaryFolder;

struct GoodFile {
    const char* label;
    const char* file;
    std::string bytes;
    const char* format;
    bool flipsXy = false; ///< NIfTI's world is right-anterior-superior, ITK's left-posterior-superior
};

void PrintTo(const GoodFile& good, std::ostream* out) { *out << good.label; } // NOLINT: GoogleTest's name

class GoodVolume : public testing::TestWithParam<GoodFile> {};

// Every file holds 0..23 as i16 in 4 x 3 x 2 points, spacing 1 2 3, origin 10 20 30.
TEST_P(GoodVolume, IsReadWholeAndBySlabs) {
    const GoodFile& good = GetParam();
    const TemporaryFolder folder;
    const auto path = folder.write(good.file, good.bytes);
    folder.write("data.raw", test::ramp<std::int16_t>(24));
    folder.write("slice07.raw", test::ramp<std::int16_t>(24).substr(0, 24));
    folder.write("slice08.raw", test::ramp<std::int16_t>(24).substr(24));
    testing::internal::CaptureStderr();
    const auto grid = readVolume(path);
    auto source = openVolume(path);
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
    ASSERT_THAT(grid, test::IsOk());
    ASSERT_THAT(source, test::IsOk());
    EXPECT_EQ(grid.value()->dims(), (GridDims{4, 3, 2}));
    ASSERT_EQ(grid.value()->type(), ScalarType::I16);
    const auto values = grid.value()->values<std::int16_t>();
    for (std::size_t i = 0; i < values.size(); ++i)
        EXPECT_EQ(values[i], static_cast<std::int16_t>(i));
    const VolumeInfo& info = source.value()->info();
    EXPECT_EQ(info.format, good.format);
    EXPECT_EQ(info.geometry, grid.value()->geometry());
    EXPECT_EQ(info.geometry.spacing, glm::dvec3(1, 2, 3));
    EXPECT_EQ(info.geometry.origin, glm::dvec3(10, 20, 30));
    const double sign = good.flipsXy ? -1 : 1;
    EXPECT_EQ(info.geometry.direction, glm::dmat3(sign, 0, 0, 0, sign, 0, 0, 0, 1));
    // Second plane first: streams have to go back.
    std::vector<std::byte> plane(24);
    for (const std::int64_t z : {1, 0, 1}) {
        ASSERT_THAT(source.value()->readSlab(z, z + 1, plane), test::IsOk());
        EXPECT_EQ(std::to_integer<int>(plane[0]), z * 12);
        EXPECT_EQ(std::to_integer<int>(plane[22]), z * 12 + 11);
    }
}

std::string mhaPacked() {
    return replaced(test::mhaHeader(), "CompressedData = False", "CompressedData = True") +
           test::packed(test::ramp<std::int16_t>(24), 15);
}
std::string mhaBigEndian() { return replaced(test::mhaHeader(), "MSB = False", "MSB = True") + test::bigEndian16(24); }
std::string nrrdGzip(const std::string& body) {
    return replaced(test::nrrdHeader(), "encoding: raw", "encoding: gzip") + "\n" + body;
}
std::string twoMembers() {
    const std::string samples = test::ramp<std::int16_t>(24);
    return test::gzipped(samples.substr(0, 20)) + test::gzipped(samples.substr(20));
}
std::string withCarriageReturns(const std::string& header) {
    std::string out;
    for (const char c : header)
        out += c == '\n' ? std::string(" \t\r\n") : std::string(1, c);
    return out;
}
std::string niftiOfFourDimensions() { return test::niftiWith<std::int16_t>(40, 4); }
std::string vtkWithOthers() {
    return test::vtkHeader("BINARY") + "VECTORS v float\n" + std::string(24 * 12, '\0') +
           "\nMETADATA\nINFORMATION 0\n\nFIELD FieldData 2\nt 3 24 double\n" + std::string(24 * 24, '\1') +
           "\ns 1 24 short\n" + test::bigEndian16(24) + "\n";
}

const std::vector<GoodFile>& goodFiles() {
    static const std::vector<GoodFile> files = {
        {"mha", "a.mha", test::mha(), "MetaImage"},
        {"mhd", "a.mhd", test::mhaHeader("data.raw"), "MetaImage"},
        {"mha_packed", "a.mha", mhaPacked(), "MetaImage"},
        {"mha_big_endian", "a.mha", mhaBigEndian(), "MetaImage"},
        {"mhd_capital_suffix", "A.MHD", test::mhaHeader("data.raw"), "MetaImage"},
        {"mha_longer", "a.mha", test::mha() + "\n", "MetaImage"},
        {"nrrd", "a.nrrd", test::nrrd(), "NRRD"},
        {"nhdr", "a.nhdr", test::nrrdHeader() + "data file: ./data.raw\n", "NRRD"},
        {"nhdr_list", "a.nhdr", test::nrrdHeader() + "data file: LIST\nslice07.raw\nslice08.raw\n", "NRRD"},
        {"nhdr_pattern", "a.nhdr", test::nrrdHeader() + "data file: slice%02d.raw 7 8 1\n", "NRRD"},
        {"nrrd_gzip", "a.nrrd", nrrdGzip(test::gzipped(test::ramp<std::int16_t>(24))), "NRRD"},
        {"B040_nrrd_two_members", "a.nrrd", nrrdGzip(twoMembers()), "NRRD"},
        {"B048_nrrd_crlf", "a.nrrd", withCarriageReturns(test::nrrdHeader()) + "\r\n" + test::ramp<std::int16_t>(24),
         "NRRD"},
        {"B048_nrrd_byte_order_mark", "a.nrrd", "\xef\xbb\xbf" + test::nrrd(), "NRRD"},
        {"nrrd_byte_skip", "a.nrrd", test::nrrdHeader() + "byte skip: -1\n\nsomething" + test::ramp<std::int16_t>(24),
         "NRRD"},
        {"nii", "a.nii", test::nifti(), "NIfTI", true},
        {"nii_gz", "a.nii.gz", test::gzipped(test::nifti()), "NIfTI", true},
        {"nii_four_dimensions", "a.nii", niftiOfFourDimensions(), "NIfTI", true},
        {"vti", "a.vti", test::vti(), "VTK image"},
        {"vti_appended", "a.vti", test::vtiAppended("0", 48), "VTK image"},
        {"vtk_binary", "a.vtk", test::vtkBinary(), "VTK image"},
        {"vtk_text", "a.vtk", test::vtkText(), "VTK image"},
        {"vtk_with_others", "a.vtk", vtkWithOthers(), "VTK image"},
        {"name_with_percent_and_newline", "%s%n \n.mha", test::mha(), "MetaImage"},
    };
    return files;
}

INSTANTIATE_TEST_SUITE_P(Formats, GoodVolume, testing::ValuesIn(goodFiles()),
                         [](const auto& parameter) { return std::string(parameter.param.label); });

TEST(VolumeReader, ReadsRawOfEveryTypeAndByteOrder) {
    const TemporaryFolder folder;
    const auto path = folder.write("a.raw", "skip" + test::bigEndian16(24));
    ReadOptions options;
    options.raw = RawLayout{{4, 3, 2}, ScalarType::U16, {1, 1, 1}, 4, true};
    const auto grid = readVolume(path, options);
    ASSERT_THAT(grid, test::IsOk());
    EXPECT_EQ(grid.value()->values<std::uint16_t>()[23], 23);
    for (const ScalarType type : kAllScalarTypes) {
        options.raw = RawLayout{{1, 2, 2}, type};
        EXPECT_THAT(readVolume(folder.write("b.raw", std::string(4 * scalarTypeSizeBytes(type), '\0')), options),
                    test::IsOk());
    }
}

// Whole numbers and halves as floats are next to zero in the wrong byte order, all of them, and so smooth.
TEST(VolumeReader, DoubtsTheByteOrderOnlyWhereTheOtherOneHasUsualNumbers) {
    const TemporaryFolder folder;
    constexpr int kSide = 16;
    const auto notesOn = [&](auto valueAt, ScalarType type, bool isBigEndian, bool isToldSo) {
        using Sample = decltype(valueAt(0));
        std::string bytes;
        for (int i = 0; i < kSide * kSide * kSide; ++i) {
            auto sample = std::bit_cast<std::array<char, sizeof(Sample)>>(valueAt(i));
            if (isBigEndian != (std::endian::native == std::endian::big))
                std::reverse(sample.begin(), sample.end());
            bytes.append(sample.begin(), sample.end());
        }
        ReadOptions options;
        options.raw = RawLayout{{kSide, kSide, kSide}, type, {1, 1, 1}, 0, isToldSo};
        const auto source = openVolume(folder.write("a.raw", bytes), options);
        EXPECT_THAT(source, test::IsOk());
        return source.value()->info().notes.size();
    };
    const auto waveAt = [](int i) { return std::sin(0.05f * static_cast<float>(i)); };
    const auto wholeAt = [&](int i) { return std::round(1000.0f * waveAt(i)); };
    const auto maskAt = [&](int i) { return waveAt(i) > 0.3f ? 1.0 : 0.0; };
    const auto doubleAt = [&](int i) { return static_cast<double>(waveAt(i)); };
    const auto shortAt = [&](int i) { return static_cast<std::int16_t>(1000.0f * waveAt(i)); };
    for (const bool isBigEndian : {false, true}) {
        SCOPED_TRACE(isBigEndian);
        EXPECT_EQ(notesOn(waveAt, ScalarType::F32, isBigEndian, isBigEndian), 0u);
        EXPECT_EQ(notesOn(wholeAt, ScalarType::F32, isBigEndian, isBigEndian), 0u);
        EXPECT_EQ(notesOn(maskAt, ScalarType::F64, isBigEndian, isBigEndian), 0u);
        EXPECT_EQ(notesOn(doubleAt, ScalarType::F64, isBigEndian, isBigEndian), 0u);
        EXPECT_EQ(notesOn(shortAt, ScalarType::I16, isBigEndian, isBigEndian), 0u);
        EXPECT_EQ(notesOn(waveAt, ScalarType::F32, isBigEndian, !isBigEndian), 1u);
        EXPECT_EQ(notesOn(wholeAt, ScalarType::F32, isBigEndian, !isBigEndian), 1u);
        EXPECT_EQ(notesOn(doubleAt, ScalarType::F64, isBigEndian, !isBigEndian), 1u);
        EXPECT_EQ(notesOn(shortAt, ScalarType::I16, isBigEndian, !isBigEndian), 1u);
    }
}

TEST(VolumeReader, KeepsNegativeZeroAndMissingValues) {
    const TemporaryFolder folder;
    const float values[4] = {-0.0f, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
                             1e-45f};
    std::string bytes(sizeof values, '\0');
    std::memcpy(bytes.data(), values, sizeof values);
    const std::string header =
        replaced(replaced(test::mhaHeader(), "DimSize = 4 3 2", "DimSize = 2 2 1"), "MET_SHORT", "MET_FLOAT");
    const auto grid = readVolume(folder.write("a.mha", header + bytes));
    ASSERT_THAT(grid, test::IsOk());
    const auto read = grid.value()->values<float>();
    EXPECT_TRUE(std::signbit(read[0]));
    EXPECT_TRUE(std::isnan(read[1]));
    EXPECT_TRUE(std::isinf(read[2]));
    EXPECT_EQ(read[3], 1e-45f);
}

TEST(VolumeReader, WidensIntegersThatHaveNoTypeHere) {
    const TemporaryFolder folder;
    const std::string header = replaced(test::mhaHeader(), "DimSize = 4 3 2", "DimSize = 1 1 2");
    std::string wide(8, '\0');
    test::put<std::uint32_t>(wide, 0, 4'000'000'000u);
    const auto unsigned32 = readVolume(folder.write("a.mha", replaced(header, "MET_SHORT", "MET_UINT") + wide));
    ASSERT_THAT(unsigned32, test::IsOk());
    EXPECT_EQ(unsigned32.value()->type(), ScalarType::F64);
    EXPECT_EQ(unsigned32.value()->values<double>()[0], 4e9);
    std::string wider(16, '\0');
    test::put<std::int64_t>(wider, 0, std::int64_t{1} << 53);
    const std::string header64 = replaced(header, "MET_SHORT", "MET_LONG_LONG");
    EXPECT_THAT(readVolume(folder.write("b.mha", header64 + wider)), test::IsOk());
    test::put<std::int64_t>(wider, 8, (std::int64_t{1} << 53) + 1);
    EXPECT_THAT(readVolume(folder.write("b.mha", header64 + wider)), test::HasError(ErrorCode::InvalidArgument));
}

TEST(VolumeReader, AppliesNiftiSlope) {
    const TemporaryFolder folder;
    std::string bytes = test::niftiWith<float>(112, 0.5f);
    test::put<float>(bytes, 116, -1.0f);
    const auto grid = readVolume(folder.write("a.nii", bytes));
    ASSERT_THAT(grid, test::IsOk());
    ASSERT_EQ(grid.value()->type(), ScalarType::F32);
    EXPECT_EQ(grid.value()->values<float>()[23], 10.5f);
    for (const float slope : {0.0f, std::numeric_limits<float>::quiet_NaN()}) {
        const auto plain = readVolume(folder.write("a.nii", test::niftiWith<float>(112, slope)));
        ASSERT_THAT(plain, test::IsOk());
        EXPECT_EQ(plain.value()->type(), ScalarType::I16);
    }
}

TEST(VolumeReader, B063_FallsBackWhereNiftiSaysNothingOfSpace) {
    const TemporaryFolder folder;
    std::string bytes = test::niftiWith<std::int16_t>(254, 0);
    test::put<float>(bytes, 84, 0.0f); // pixdim[2]
    auto source = openVolume(folder.write("a.nii", bytes));
    ASSERT_THAT(source, test::IsOk());
    EXPECT_EQ(source.value()->info().geometry.spacing, glm::dvec3(1, 1, 3));
    EXPECT_THAT(source.value()->info().notes,
                testing::UnorderedElementsAre(testing::HasSubstr("sform"), testing::HasSubstr("pixdim")));
    test::put<float>(bytes, 84, std::numeric_limits<float>::quiet_NaN());
    source = openVolume(folder.write("a.nii", bytes));
    ASSERT_THAT(source, test::IsOk());
    EXPECT_EQ(source.value()->info().geometry.spacing, glm::dvec3(1, 1, 3));
}

TEST(VolumeReader, B047_KeepsLeftHandedDirections) {
    const TemporaryFolder folder;
    const auto grid = readVolume(folder.write("a.nrrd", replaced(test::nrrd(), "(0,2,0)", "(0,-2,0)")));
    ASSERT_THAT(grid, test::IsOk());
    EXPECT_TRUE(grid.value()->geometry().isLeftHanded());
    EXPECT_EQ(grid.value()->geometry().spacing, glm::dvec3(1, 2, 3));
}

TEST(VolumeReader, ChoosesTheFieldAskedFor) {
    const TemporaryFolder folder;
    const auto path = folder.write("a.vtk", vtkWithOthers());
    ReadOptions options;
    options.field = "s";
    EXPECT_THAT(readVolume(path, options), test::IsOk());
    options.field = "v";
    EXPECT_THAT(readVolume(path, options), test::HasError(ErrorCode::InvalidArgument));
    options.field = "none";
    EXPECT_THAT(readVolume(path, options), test::HasError(ErrorCode::InvalidArgument));
}

TEST(VolumeReader, StopsAndReports) {
    const TemporaryFolder folder;
    const auto path = folder.write("a.mha", test::mha());
    std::stop_source stop;
    double last = 0.0;
    JobControl job{stop.get_token(), [&](double fraction, std::string_view) { last = fraction; }};
    EXPECT_THAT(readVolume(path, {}, job), test::IsOk());
    EXPECT_EQ(last, 1.0);
    stop.request_stop();
    EXPECT_TRUE(readVolume(path, {}, job).isCancelled());
}

} // namespace
} // namespace isoslider::io
