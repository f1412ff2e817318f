#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <chrono>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/volume_io/volume_reader.h"
#include "tests/support/result_matchers.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/core/volume_io/volume_bytes.h"

namespace isoslider::io {
namespace {

using test::replaced;
using enum ErrorCode;

struct BadFile {
    const char* label;
    const char* file;
    std::string bytes;
    ErrorCode code;
    const char* says; ///< part of the message: the field, or what was expected
    std::string companion = {}; ///< bytes of "data.raw" beside it
};

void PrintTo(const BadFile& bad, std::ostream* out) { *out << bad.label; } // NOLINT: GoogleTest's name

std::uint64_t peakRssBytes() {
    rusage usage{};
    ::getrusage(RUSAGE_SELF, &usage);
    return static_cast<std::uint64_t>(usage.ru_maxrss) << 10;
}

class BadVolume : public testing::TestWithParam<BadFile> {};

TEST_P(BadVolume, IsRefusedSoonWithOneClearLine) {
    const BadFile& bad = GetParam();
    ASSERT_THAT(bad.bytes, testing::Not(testing::HasSubstr("TEST ERROR")));
    const test::TemporaryFolder folder;
    const auto path = folder.write(bad.file, bad.bytes);
    if (!bad.companion.empty())
        folder.write("data.raw", bad.companion);
    const std::uint64_t rssBefore = peakRssBytes();
    const auto begin = std::chrono::steady_clock::now();
    testing::internal::CaptureStderr();
    const auto grid = readVolume(path);
    const std::string printed = testing::internal::GetCapturedStderr();
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - begin;
    ASSERT_THAT(grid, test::HasError(bad.code));
    EXPECT_THAT(grid.error().line(), testing::HasSubstr(bad.says));
    EXPECT_THAT(grid.error().line(), testing::Not(testing::HasSubstr("\n")));
    EXPECT_THAT(grid.error().line(), testing::HasSubstr(folder.path().string()));
    EXPECT_EQ(printed, "");
    EXPECT_LT(elapsed.count(), 1.0);
    EXPECT_LT(peakRssBytes() - rssBefore, std::uint64_t{64} << 20);
}

std::string withMhaLine(const std::string& from, const std::string& to) { return replaced(test::mha(), from, to); }
std::string withNrrdLine(const std::string& from, const std::string& to) { return replaced(test::nrrd(), from, to); }
std::string withVti(const std::string& from, const std::string& to) { return replaced(test::vti(), from, to); }
std::string withVtk(const std::string& from, const std::string& to) { return replaced(test::vtkBinary(), from, to); }
std::string repeated(const std::string& text, int times) {
    std::string all;
    for (int i = 0; i < times; ++i)
        all += text;
    return all;
}
std::string shorter(std::string bytes) { return bytes.substr(0, bytes.size() - 1); }
std::string cat(std::initializer_list<std::string> parts) {
    std::string all;
    for (const auto& part : parts)
        all += part;
    return all;
}

const float kNan = std::numeric_limits<float>::quiet_NaN();
const char* const kCompressed = "CompressedData = True";
const char* const kPlain = "CompressedData = False";

std::string mhaPacked(const std::string& size, const std::string& packedSamples) {
    const std::string sizeLine = size.empty() ? "" : "\nCompressedDataSize = " + size;
    return replaced(test::mhaHeader(), kPlain, kCompressed + sizeLine) + packedSamples;
}
std::string nrrdGzip(const std::string& body) {
    return replaced(test::nrrdHeader(), "encoding: raw", "encoding: gzip") + "\n" + body;
}
std::string detachedNrrd(const std::string& dataFile) { return test::nrrdHeader() + "data file: " + dataFile + "\n"; }

std::string badChecksum() {
    std::string body = test::gzipped(test::ramp<std::int16_t>(24));
    body[body.size() - 6] = static_cast<char>(body[body.size() - 6] ^ 1);
    return body;
}

std::string deepXml() {
    std::string text = "<VTKFile type=\"ImageData\">";
    for (int i = 0; i < 100'000; ++i)
        text += "<a>";
    return text;
}

std::string niftiExtension(std::int32_t size) {
    std::string bytes = test::niftiHeader();
    bytes[348] = 1;
    test::put<float>(bytes, 108, 368);
    std::string extension(16, '\0');
    test::put(extension, 0, size);
    return bytes + extension + test::ramp<std::int16_t>(24);
}

std::string niftiSeries() {
    std::string bytes = test::niftiWith<std::int16_t>(40, 4);
    test::put<std::int16_t>(bytes, 48, 2);
    return bytes + test::ramp<std::int16_t>(24);
}

const std::vector<BadFile>& metaImages() {
    static const std::vector<BadFile> files = {
        {"mha_short_by_one", "a.mha", shorter(test::mha()), Corruption, "48"},
        {"mha_asks_17_GB", "a.mha", "NDims = 3\nDimSize = 2048 2048 2048\nElementType = MET_SHORT\nElementDataFile = LOCAL\n", Corruption, "17179869184"},
        {"mha_product_overflow", "a.mha", withMhaLine("DimSize = 4 3 2", "DimSize = 1048576 1048576 1048576"), InvalidArgument, "DimSize"},
        {"mha_extent_overflow", "a.mha", withMhaLine("DimSize = 4 3 2", "DimSize = 4 3 99999999999999999999"), InvalidArgument, "DimSize"},
        {"mha_zero_extent", "a.mha", withMhaLine("DimSize = 4 3 2", "DimSize = 4 0 2"), InvalidArgument, "DimSize"},
        {"mha_negative_extent", "a.mha", withMhaLine("DimSize = 4 3 2", "DimSize = 4 -3 2"), InvalidArgument, "DimSize"},
        {"mha_11_dimensions", "a.mha", withMhaLine("NDims = 3", "NDims = 11"), InvalidArgument, "NDims"},
        {"mha_0_dimensions", "a.mha", withMhaLine("NDims = 3", "NDims = 0"), InvalidArgument, "NDims"},
        {"mha_list_too_long", "a.mha", withMhaLine("ElementSpacing = 1 2 3", "ElementSpacing = 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20"), InvalidArgument, "ElementSpacing"},
        {"mha_list_too_short", "a.mha", withMhaLine("ElementSpacing = 1 2 3", "ElementSpacing = 1 2"), InvalidArgument, "ElementSpacing"},
        {"mha_zero_spacing", "a.mha", withMhaLine("ElementSpacing = 1 2 3", "ElementSpacing = 1 0 3"), InvalidArgument, "pacing"},
        {"mha_nan_spacing", "a.mha", withMhaLine("ElementSpacing = 1 2 3", "ElementSpacing = 1 nan 3"), InvalidArgument, "pacing"},
        {"mha_flat_directions", "a.mha", withMhaLine("1 0 0 0 1 0 0 0 1", "1 0 0 1 0 0 0 0 1"), InvalidArgument, ""},
        {"mha_type_string", "a.mha", withMhaLine("MET_SHORT", "MET_STRING"), InvalidArgument, "ElementType"},
        {"mha_million_channels", "a.mha", withMhaLine("NDims", "ElementNumberOfChannels = 1000000\nNDims"), InvalidArgument, "ElementNumberOfChannels"},
        {"mha_header_size_minus_2", "a.mha", withMhaLine("NDims", "HeaderSize = -2\nNDims"), InvalidArgument, "HeaderSize"},
        {"mha_header_size_minus_1_short", "a.mhd", cat({"HeaderSize = -1\n", test::mhaHeader("data.raw")}), Corruption, "48", "short"},
        {"mha_field_twice", "a.mha", withMhaLine("NDims = 3", "NDims = 3\nNDims = 3"), InvalidArgument, "NDims"},
        {"mha_text_samples", "a.mha", withMhaLine("BinaryData = True", "BinaryData = False"), InvalidArgument, "BinaryData"},
        {"mha_not_text", "a.mha", std::string(5000, '\1'), InvalidArgument, "MetaImage"},
        {"mha_prose", "a.mhd", "Dear reader,\nthis is a letter.\n", InvalidArgument, "MetaImage"},
        {"mhd_outside", "a.mhd", test::mhaHeader("../x.raw"), InvalidArgument, "ElementDataFile"},
        {"mhd_absolute", "a.mhd", test::mhaHeader("/etc/passwd"), InvalidArgument, "ElementDataFile"},
        {"mhd_missing_data", "a.mhd", test::mhaHeader("none.raw"), NotFound, "none.raw"},
        {"mhd_list", "a.mhd", test::mhaHeader("LIST -1"), InvalidArgument, "ElementDataFile"},
        {"mhd_pattern", "a.mhd", test::mhaHeader("%s%n%s"), InvalidArgument, "ElementDataFile"},
        {"mhd_short_data", "a.mhd", test::mhaHeader("data.raw"), Corruption, "47", std::string(47, 'x')},
        {"mha_packed_size_negative", "a.mha", mhaPacked("-1", test::packed(test::ramp<std::int16_t>(24), 15)), InvalidArgument, "CompressedDataSize"},
        {"mha_packed_size_beyond", "a.mha", mhaPacked("1000000", test::packed(test::ramp<std::int16_t>(24), 15)), Corruption, "CompressedDataSize"},
        {"mha_unpacks_to_more", "a.mha", mhaPacked("", test::packed(test::ramp<std::int16_t>(25), 15)), Corruption, "more than"},
        {"mha_unpacks_to_less", "a.mha", mhaPacked("", test::packed(test::ramp<std::int16_t>(23), 15)), Corruption, "46"},
        {"mha_packed_garbage", "a.mha", mhaPacked("", std::string(64, 'z')), Corruption, "compressed"},
    };
    return files;
}

const std::vector<BadFile>& nrrds() {
    static const std::vector<BadFile> files = {
        {"nrrd_magic", "a.nrrd", withNrrdLine("NRRD0004", "NRRD0009"), InvalidArgument, "NRRD000"},
        {"nrrd_dimension_17", "a.nrrd", withNrrdLine("dimension: 3", "dimension: 17"), InvalidArgument, "dimension"},
        {"nrrd_dimension_text", "a.nrrd", withNrrdLine("dimension: 3", "dimension: 3abc"), InvalidArgument, "dimension"},
        {"nrrd_two_sizes", "a.nrrd", withNrrdLine("sizes: 4 3 2", "sizes: 4 3"), InvalidArgument, "sizes"},
        {"nrrd_sizes_twice", "a.nrrd", withNrrdLine("sizes: 4 3 2", "sizes: 4 3 2\nsizes: 4 3 3"), InvalidArgument, "sizes"},
        {"nrrd_size_overflow", "a.nrrd", withNrrdLine("sizes: 4 3 2", "sizes: 4 3 99999999999999999999"), InvalidArgument, "sizes"},
        {"nrrd_endless_header", "a.nrrd", cat({"NRRD0004\n", std::string(2'000'000, 'x')}), InvalidArgument, "NRRD"},
        {"nrrd_no_blank_line", "a.nrrd", test::nrrdHeader(), InvalidArgument, "data file"},
        {"nrrd_outside", "a.nhdr", detachedNrrd("../../etc/passwd"), InvalidArgument, "data file"},
        {"nrrd_missing", "a.nhdr", detachedNrrd("none.raw"), NotFound, "none.raw"},
        {"nrrd_list_missing", "a.nhdr", detachedNrrd("LIST\nnone1.raw\nnone2.raw"), NotFound, "none1.raw"},
        {"nrrd_pattern_range", "a.nhdr", detachedNrrd("slice%03d.raw 1 999999999 1"), InvalidArgument, "data file"},
        {"nrrd_pattern_printf", "a.nhdr", detachedNrrd("%s%n%s 1 2 1"), InvalidArgument, "data file"},
        {"nrrd_byte_skip", "a.nrrd", withNrrdLine("kinds", "byte skip: -2\nkinds"), InvalidArgument, "byte skip"},
        {"nrrd_byte_skip_far", "a.nrrd", withNrrdLine("kinds", "byte skip: 1000000000000\nkinds"), InvalidArgument, "byte skip"},
        {"nrrd_line_skip_far", "a.nrrd", withNrrdLine("kinds", "line skip: 1000000000000\nkinds"), InvalidArgument, "line skip"},
        {"nrrd_encoding_hex", "a.nrrd", withNrrdLine("encoding: raw", "encoding: hex"), InvalidArgument, "hex"},
        {"nrrd_short", "a.nrrd", shorter(test::nrrd()), Corruption, "48"},
        {"nrrd_bomb", "a.nrrd", nrrdGzip(test::gzipped(std::string(100'000'000, '\0'))), Corruption, "more than"},
        {"nrrd_gzip_cut", "a.nrrd", nrrdGzip(shorter(test::gzipped(test::ramp<std::int16_t>(24)))), Corruption, "early"},
        {"nrrd_gzip_checksum", "a.nrrd", nrrdGzip(badChecksum()), Corruption, "damaged"},
        {"nrrd_gzip_asks_too_much", "a.nrrd", replaced(nrrdGzip("xyz"), "sizes: 4 3 2", "sizes: 4096 4096 4096"), Corruption, "cannot hold"},
        {"nrrd_zero_direction", "a.nrrd", withNrrdLine("(0,2,0)", "(0,0,0)"), InvalidArgument, ""},
        {"nrrd_same_direction", "a.nrrd", withNrrdLine("(0,2,0)", "(2,0,0)"), InvalidArgument, ""},
        {"nrrd_none_direction", "a.nrrd", withNrrdLine("(0,2,0)", "none"), InvalidArgument, "space directions"},
        {"nrrd_nan_spacing", "a.nrrd", replaced(withNrrdLine("space: left-posterior-superior\n", ""), "space directions: (1,0,0) (0,2,0) (0,0,3)", "spacings: 1 nan 3"), InvalidArgument, "spacings"},
        {"nrrd_type", "a.nrrd", withNrrdLine("type: short", "type: block"), InvalidArgument, "type"},
        {"nrrd_no_endian", "a.nrrd", withNrrdLine("endian: little\n", ""), InvalidArgument, "endian"},
        {"nrrd_four_dimensions", "a.nrrd", replaced(withNrrdLine("dimension: 3", "dimension: 4"), "sizes: 4 3 2", "sizes: 4 3 1 2"), InvalidArgument, "4 dimensions"},
    };
    return files;
}

const std::vector<BadFile>& niftis() {
    static const std::vector<BadFile> files = {
        {"nifti_sizeof_hdr", "a.nii", test::niftiWith<std::int32_t>(0, 347), InvalidArgument, "sizeof_hdr"},
        {"nifti_2", "a.nii", test::niftiWith<std::int32_t>(0, 540), UnsupportedVersion, "NIfTI-2"},
        {"nifti_dim0_200", "a.nii", test::niftiWith<std::int16_t>(40, 200), InvalidArgument, "dim[0]"},
        {"nifti_dim0_negative", "a.nii", test::niftiWith<std::int16_t>(40, -5), InvalidArgument, "dim[0]"},
        {"nifti_dim1_negative", "a.nii", test::niftiWith<std::int16_t>(42, -1), InvalidArgument, "dim"},
        {"nifti_asks_18_GB", "a.nii", test::niftiWith<std::int64_t>(42, 0x0bb8'0bb8'0bb8), Corruption, "54000000000"},
        {"nifti_offset_nan", "a.nii", test::niftiWith<float>(108, kNan), InvalidArgument, "vox_offset"},
        {"nifti_offset_huge", "a.nii", test::niftiWith<float>(108, 1e30f), InvalidArgument, "vox_offset"},
        {"nifti_offset_zero", "a.nii", test::niftiWith<float>(108, 0), InvalidArgument, "vox_offset"},
        {"nifti_offset_negative", "a.nii", test::niftiWith<float>(108, -352), InvalidArgument, "vox_offset"},
        {"nifti_bitpix", "a.nii", test::niftiWith<std::int16_t>(72, 8), InvalidArgument, "bitpix"},
        {"nifti_rgb", "a.nii", test::niftiWith<std::int16_t>(70, 128), InvalidArgument, "datatype"},
        {"nifti_complex", "a.nii", test::niftiWith<std::int16_t>(70, 32), InvalidArgument, "datatype"},
        {"nifti_short", "a.nii", shorter(test::nifti()), Corruption, "48"},
        {"nifti_header_only", "a.nii", test::nifti().substr(0, 100), InvalidArgument, "348"},
        {"nifti_series", "a.nii", niftiSeries(), InvalidArgument, "4 dimensions"},
        {"nifti_extension_size", "a.nii", niftiExtension(15), InvalidArgument, "extension"},
        {"nifti_extension_beyond", "a.nii", niftiExtension(1600), InvalidArgument, "extension"},
        {"nifti_gz_is_not", "a.nii.gz", test::nifti(), Corruption, "compressed"},
        {"nifti_gz_cut", "a.nii.gz", shorter(test::gzipped(test::nifti())), Corruption, "early"},
        {"nifti_gz_longer", "a.nii.gz", test::gzipped(test::nifti() + "x"), Corruption, "more than"},
        {"nifti_pair_without_img", "a.hdr", replaced(test::nifti(), "n+1", "ni1"), NotFound, "a.img"},
    };
    return files;
}

/// Appended zlib data; the numbers are those that head it: blocks, their size, the last one's, packed sizes.
std::string vtiPacked(std::initializer_list<std::uint32_t> heading) {
    std::string bytes;
    for (const std::uint32_t number : heading) {
        bytes.resize(bytes.size() + 4);
        test::put(bytes, bytes.size() - 4, number);
    }
    std::string text = replaced(test::vtiAppended("0", 48), " byte_order", " compressor=\"vtkZLibDataCompressor\" byte_order");
    const auto begin = text.find("\n_") + 2;
    return text.replace(begin, 4, bytes);
}

std::string laughs() {
    std::string text = "<?xml version=\"1.0\"?><!DOCTYPE lolz [<!ENTITY lol \"lol\">";
    for (char c = 'a'; c < 'k'; ++c)
        text += std::string("<!ENTITY lol") + c + " \"" + repeated(c == 'a' ? "&lol;" : std::string("&lol") + static_cast<char>(c - 1) + ";", 10) + "\">";
    return text + "]><VTKFile type=\"ImageData\">&lolj;</VTKFile>";
}

const std::vector<BadFile>& vtks() {
    static const std::vector<BadFile> files = {
        {"B068_vtk_three_lines", "a.vtk", "# vtk DataFile Version 3.0\ntitle\nASCII\n", InvalidArgument, "DATASET"},
        {"B068_vtk_one_line", "a.vtk", "# vtk DataFile Version 3.0", InvalidArgument, "encoding"},
        {"B068_vtk_two_lines", "a.vtk", "# vtk DataFile Version 3.0\ntitle", InvalidArgument, "encoding"},
        {"B069_vtk_coordinates", "a.vtk", replaced(test::vtkRectilinear(), "Y_COORDINATES 2", "Y_COORDINATES 1"), InvalidArgument, ""},
        {"B069_vtk_points", "a.vtk", replaced(test::vtkCells(), "POINT_DATA 5", "POINT_DATA 6"), InvalidArgument, "POINT_DATA"},
        {"B069_vtk_count", "a.vtk", withVtk("POINT_DATA 24", "POINT_DATA 25"), InvalidArgument, "POINT_DATA"},
        {"B070_vtk_components", "a.vtk", withVtk("SCALARS s short", "SCALARS s short 1000000"), InvalidArgument, "components"},
        {"B070_vtk_color", "a.vtk", withVtk("SCALARS s short\nLOOKUP_TABLE default", "COLOR_SCALARS s -1"), InvalidArgument, "components"},
        {"vtk_short", "a.vtk", shorter(shorter(test::vtkBinary())), Corruption, "early"},
        {"vtk_text_number", "a.vtk", replaced(test::vtkText(), " 7 ", " abc "), InvalidArgument, "sample 7"},
        {"vtk_text_range", "a.vtk", replaced(test::vtkText(), " 7 ", " 99999 "), InvalidArgument, "sample 7"},
        {"vtk_text_nan", "a.vtk", replaced(replaced(test::vtkText(), "SCALARS s short", "SCALARS s float"), " 7 ", " nan "), InvalidArgument, "sample 7"},
        {"vtk_text_negative", "a.vtk", replaced(replaced(test::vtkText(), "SCALARS s short", "SCALARS s unsigned_int"), " 7 ", " -7 "), InvalidArgument, "sample 7"},
        {"vtk_text_char_range", "a.vtk", replaced(replaced(test::vtkText(), "SCALARS s short", "SCALARS s char"), " 7 ", " 128 "), InvalidArgument, "sample 7"},
        {"vtk_text_float_range", "a.vtk", replaced(replaced(test::vtkText(), "SCALARS s short", "SCALARS s float"), " 7 ", " 1e39 "), InvalidArgument, "sample 7"},
        {"vtk_text_endless_word", "a.vtk", replaced(test::vtkText(), " 7 ", " " + std::string(100'000, '0') + "7 "), InvalidArgument, "sample 7"},
        {"vtk_text_short", "a.vtk", replaced(test::vtkText(), " 21 22 23", " 21 22"), InvalidArgument, "sample 23"},
        {"vtk_endless_header", "a.vtk", withVtk("SPACING 1 2 3\n", repeated("SPACING 1 2 3\n", 100'000)), InvalidArgument, "header"},
        {"vtk_million_in_samples", "a.vtk", withVtk("LOOKUP_TABLE default\n", "LOOKUP_TABLE default\nSCALARS t float 100000000\n").substr(0, 200), Corruption, "early"},
        {"B074_vtk_cells", "a.vtk", withVtk("POINT_DATA 24", "CELL_DATA 6"), InvalidArgument, "cells"},
        {"vtk_huge", "a.vtk", replaced(withVtk("DIMENSIONS 4 3 2", "DIMENSIONS 4000 3000 2000"), "POINT_DATA 24", "POINT_DATA 24000000000"), Corruption, "early"},
        {"B071_vti_reversed", "a.vti", withVti("0 3 0 2 0 1\" Origin", "3 0 0 2 0 1\" Origin"), InvalidArgument, "Piece"},
        {"B071_vti_int_max", "a.vti", replaced(withVti("0 3 0 2 0 1\" Origin", "0 2147483647 0 2 0 1\" Origin"), "Extent=\"0 3 0 2 0 1\">", "Extent=\"0 2147483647 0 2 0 1\">"), InvalidArgument, "WholeExtent"},
        {"vti_huge", "a.vti", replaced(withVti("0 3 0 2 0 1\" Origin", "0 3000 0 2000 0 1000\" Origin"), "Extent=\"0 3 0 2 0 1\">", "Extent=\"0 3000 0 2000 0 1000\">"), Corruption, "data"},
        {"B071_vti_piece", "a.vti", withVti("Piece Extent=\"0 3 0 2 0 1\"", "Piece Extent=\"0 3 0 2 0 0\""), InvalidArgument, "Piece"},
        {"B072_vti_offset", "a.vti", test::vtiAppended("1000000", 48), Corruption, "offset"},
        {"B072_vti_block_bytes", "a.vti", test::vtiAppended("0", 0xffffffffu), Corruption, "block"},
        {"B072_vti_blocks", "a.vti", replaced(test::vtiAppended("0", 0xffffffffu), " byte_order", " compressor=\"vtkZLibDataCompressor\" byte_order"), Corruption, "blocks"},
        {"B072_vti_encoding", "a.vti", replaced(test::vtiAppended("0", 48), "encoding=\"raw\"", "encoding=\"rav\""), InvalidArgument, "encoding"},
        {"B072_vti_format", "a.vti", withVti("format=\"ascii\"", "format=\"askii\""), InvalidArgument, "format"},
        {"B072_vti_block_of_none", "a.vti", vtiPacked({1, 0, 0, 8}), Corruption, "data block"},
        {"B072_vti_2_to_the_32_blocks", "a.vti", vtiPacked({0xffffffffu, 48, 0, 8}), Corruption, "blocks"},
        {"B072_vti_blocks_of_size_0", "a.vti", vtiPacked({1, 0, 48, 8}), Corruption, "block"},
        {"B072_vti_no_mark", "a.vti", replaced(test::vtiAppended("0", 48), "\n_", "5_"), Corruption, "offset"},
        {"B072_vti_packed_beyond", "a.vti", vtiPacked({1, 48, 0, 1'000'000}), Corruption, "beyond"},
        {"B073_vti_laughs", "a.vti", laughs(), InvalidArgument, "DOCTYPE"},
        {"B073_vtu_laughs", "a.vtu", laughs(), InvalidArgument, "DOCTYPE"},
        {"B073_vti_doctype", "a.vti", replaced(test::vti(), "<VTKFile", "<!DOCTYPE a [<!ENTITY b \"c\">]><VTKFile"), InvalidArgument, "DOCTYPE"},
        {"B073_vti_deep", "a.vti", deepXml(), InvalidArgument, "deeper"},
        {"B073_vti_base64", "a.vti", replaced(withVti("format=\"ascii\"", "format=\"binary\""), "0 1 2 3", "???? !!!! $$$$ )))) "), Corruption, "base64"},
        {"B073_vti_base64_later", "a.vti", replaced(withVti("format=\"ascii\"", "format=\"binary\""), "0 1 2 3", "MAAAAA!!!! $$$$ )))) "), Corruption, ""},
        {"vti_short_text", "a.vti", withVti(" 20 21 22 23", ""), Corruption, "VTK"},
        {"B074_vti_cells", "a.vti", replaced(replaced(test::vti(), "<PointData", "<CellData"), "</PointData", "</CellData"), InvalidArgument, "cells"},
        {"vti_components", "a.vti", withVti("Name=\"s\"", "Name=\"s\" NumberOfComponents=\"3\""), InvalidArgument, "component"},
        {"vti_not_xml", "a.vti", "hello", InvalidArgument, "XML"},
        {"vti_cut", "a.vti", test::vti().substr(0, 300), InvalidArgument, "XML"},
        {"vtk_polydata", "a.vtk", withVtk("STRUCTURED_POINTS", "POLYDATA"), InvalidArgument, "POLYDATA"},
        {"vtk_cells_beyond", "a.vtk", replaced(test::vtkCells(), "4 0 1 2 3", "4 0 1 2 9"), Corruption, "point 9 of 5"},
        {"vtk_cells_negative", "a.vtk", replaced(test::vtkCells(), "4 0 1 2 3", "4 0 1 2 -3"), Corruption, "Cells"},
        {"vtk_cells_short", "a.vtk", replaced(test::vtkCells(), "4 0 1 2 3\n4 1 2 3 4", "3 0 1 2 5 1 2 3 4 0"), Corruption, "its type 4"},
        {"vtk_cells_too_many", "a.vtk", replaced(test::vtkCells(), "CELLS 2 10", "CELLS 2 1000000000000"), Corruption, "early"},
        {"vtk_cells_of_none", "a.vtk", replaced(test::vtkCells(), "10 10", "5 5"), InvalidArgument, "volume"},
        {"vtk_cells_flat", "a.vtk", replaced(test::vtkCells(), "10 10", "9 9"), InvalidArgument, "volume"},
        {"vtk_points_nan", "a.vtk", replaced(test::vtkCells(), "0 0 0", "0 nan 0"), InvalidArgument, "points: number 1"},
        {"vtu_huge", "a.vtu", replaced(test::vtu(), "NumberOfPoints=\"5\"", "NumberOfPoints=\"500000000000\""), Corruption, "data"},
        {"vtu_no_cells", "a.vtu", replaced(test::vtu(), "NumberOfCells=\"2\"", "NumberOfCells=\"0\""), InvalidArgument, "NumberOfCells"},
        {"vtu_too_many_cells", "a.vtu", replaced(test::vtu(), "NumberOfCells=\"2\"", "NumberOfCells=\"9000000000000000\""), InvalidArgument, "NumberOfCells"},
        {"vtu_cells_beyond", "a.vtu", replaced(test::vtu(), "0 1 2 3 1", "0 1 2 9 1"), Corruption, "point 9 of 5"},
        {"vtu_offsets", "a.vtu", replaced(test::vtu(), "4 8", "4 3"), Corruption, ""},
        {"vtu_offsets_beyond", "a.vtu", replaced(test::vtu(), "4 8", "4 8000000000"), OutOfSpace, "memory"},
        {"vtp", "a.vtu", replaced(test::vtu(), "type=\"UnstructuredGrid\"", "type=\"PolyData\""), InvalidArgument, "PolyData"},
        {"plot3d_size", "xyz.bin", std::string(1000, '\0'), NotFound, "q.bin"},
        {"unknown_suffix", "a.txt", "hello", InvalidArgument, "expected .mhd"},
        {"empty", "a.mha", "", InvalidArgument, "empty"},
    };
    return files;
}

const auto kLabel = [](const auto& parameter) { return std::string(parameter.param.label); };
INSTANTIATE_TEST_SUITE_P(MetaImage, BadVolume, testing::ValuesIn(metaImages()), kLabel);
INSTANTIATE_TEST_SUITE_P(Nrrd, BadVolume, testing::ValuesIn(nrrds()), kLabel);
INSTANTIATE_TEST_SUITE_P(Nifti, BadVolume, testing::ValuesIn(niftis()), kLabel);
INSTANTIATE_TEST_SUITE_P(Vtk, BadVolume, testing::ValuesIn(vtks()), kLabel);

TEST(BadPath, IsRefused) {
    const test::TemporaryFolder folder;
    EXPECT_THAT(readVolume(folder / "none.mha"), test::HasError(NotFound));
    std::filesystem::create_directory(folder / "folder.mha");
    EXPECT_THAT(readVolume(folder / "folder.mha"), test::HasError(InvalidArgument));
    ASSERT_EQ(::mkfifo((folder / "pipe.nrrd").c_str(), 0600), 0);
    EXPECT_THAT(readVolume(folder / "pipe.nrrd"), test::HasError(InvalidArgument));
    EXPECT_THAT(readVolume("/dev/zero"), test::HasError(InvalidArgument));
    EXPECT_THAT(readVolume(folder / std::string(4096, 'x')), test::HasError(IoError));
}

TEST(BadPath, OfADataFileThroughALinkIsRefused) {
    const test::TemporaryFolder outside, folder;
    outside.write("data.raw", test::ramp<std::int16_t>(24));
    std::filesystem::create_symlink(outside / "data.raw", folder / "data.raw");
    EXPECT_THAT(readVolume(folder.write("a.mhd", test::mhaHeader("data.raw"))), test::HasError(InvalidArgument));
}

class BadRaw : public testing::Test {
protected:
    Result<std::shared_ptr<const ScalarGrid>> read(std::uint64_t fileBytes, GridDims dims, ScalarType type = ScalarType::U8) {
        ReadOptions options;
        options.raw = RawLayout{dims, type};
        options.allowsTrailing = allowsTrailing;
        return readVolume(folder.write("a.raw", std::string(fileBytes, 'x')), options);
    }
    test::TemporaryFolder folder;
    bool allowsTrailing = false;
};

TEST_F(BadRaw, SizesAreRefused) {
    const auto shortFile = read(23, {4, 3, 2});
    ASSERT_THAT(shortFile, test::HasError(Corruption));
    EXPECT_THAT(shortFile.error().line(), testing::AllOf(testing::HasSubstr("23"), testing::HasSubstr("24")));
    EXPECT_THAT(read(25, {4, 3, 2}), test::HasError(InvalidArgument));
    EXPECT_THAT(read(0, {4, 3, 2}), test::HasError(Corruption));
    EXPECT_THAT(read(24, {0, 10, 10}), test::HasError(InvalidArgument));
    EXPECT_THAT(read(24, {-1, 64, 64}), test::HasError(InvalidArgument));
    EXPECT_THAT(read(24, {65536, 65537, 1}), test::HasError(Corruption));
    EXPECT_THAT(read(24, {1 << 21, 1 << 21, 1 << 21}), test::HasError(InvalidArgument));
    EXPECT_THAT(read(24, {std::int64_t{1} << 32, std::int64_t{1} << 32, 1}), test::HasError(InvalidArgument));
    allowsTrailing = true;
    EXPECT_THAT(read(25, {4, 3, 2}), test::IsOk());
}

TEST_F(BadRaw, SmallestSizesAreAccepted) {
    for (const GridDims dims : {GridDims{1, 1, 1}, {1, 64, 64}, {64, 64, 1}, {2, 2, 2}})
        EXPECT_THAT(read(static_cast<std::uint64_t>(pointCount(dims)), dims), test::IsOk());
}

TEST_F(BadRaw, FileCutWhileOpenIsAnError) {
    const auto path = folder.write("a.raw", std::string(1000, 'x'));
    ReadOptions options;
    options.raw = RawLayout{{10, 10, 10}};
    auto source = openVolume(path, options);
    ASSERT_THAT(source, test::IsOk());
    std::filesystem::resize_file(path, 500);
    std::vector<std::byte> out(1000);
    EXPECT_THAT(source.value()->readSlab(0, 10, out), test::HasError(Corruption));
}

} // namespace
} // namespace isoslider::io
