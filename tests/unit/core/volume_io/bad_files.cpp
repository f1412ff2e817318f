#include "tests/unit/core/volume_io/bad_files.h"

#include <limits>

#include "tests/unit/core/volume_io/volume_bytes.h"

namespace isoslider::test {
namespace {

using enum ErrorCode;

std::string withMhaLine(const std::string& from, const std::string& to) { return replaced(mha(), from, to); }
std::string withNrrdLine(const std::string& from, const std::string& to) { return replaced(nrrd(), from, to); }
std::string withVti(const std::string& from, const std::string& to) { return replaced(vti(), from, to); }
std::string withVtk(const std::string& from, const std::string& to) { return replaced(vtkBinary(), from, to); }
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
    return replaced(mhaHeader(), kPlain, kCompressed + sizeLine) + packedSamples;
}
std::string nrrdGzip(const std::string& body) {
    return replaced(nrrdHeader(), "encoding: raw", "encoding: gzip") + "\n" + body;
}

std::string nrrdEncoded(const std::string& encoding, const std::string& body) {
    return replaced(nrrdHeader(), "encoding: raw", "encoding: " + encoding) + "\n" + body;
}
// Blanks make the file long enough for its samples: the numbers themselves decide.
std::string nrrdText(const std::string& numbers) { return nrrdEncoded("ascii", numbers + std::string(60, ' ')); }
std::string nrrdSpacings(const std::string& spacings) {
    std::string text = replaced(nrrd(), "space: left-posterior-superior\n", "");
    text = replaced(text, "space origin: (10,20,30)\n", "");
    return replaced(text, "space directions: (1,0,0) (0,2,0) (0,0,3)", "spacings: " + spacings);
}
std::string nrrdOfFour() {
    std::string text = replaced(nrrdSpacings("1 1 1 1"), "dimension: 3", "dimension: 4");
    return replaced(replaced(text, "sizes: 4 3 2", "sizes: 4 3 1 2"), "kinds: domain domain domain\n", "");
}
std::string mhaText(const std::string& numbers) {
    return replaced(mhaHeader(), "BinaryData = True", "BinaryData = False") + numbers;
}

std::string badChecksum() {
    std::string body = gzipped(ramp<std::int16_t>(24));
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
    std::string bytes = niftiHeader();
    bytes[348] = 1;
    put<float>(bytes, 108, 368);
    std::string extension(16, '\0');
    put(extension, 0, size);
    return bytes + extension + ramp<std::int16_t>(24);
}

// The second extension's size is 0: a chain that never ends.
std::string niftiExtensionCycle() {
    std::string bytes = niftiHeader();
    bytes[348] = 1;
    put<float>(bytes, 108, 384);
    std::string extensions(32, '\0');
    put<std::int32_t>(extensions, 0, 16);
    return bytes + extensions + ramp<std::int16_t>(24);
}

} // namespace

std::string detachedNrrd(const std::string& dataFile) { return nrrdHeader() + "data file: " + dataFile + "\n"; }

const std::vector<BadFile>& badMetaImages() {
    static const std::vector<BadFile> files = {
        {"mha_short_by_one", "a.mha", shorter(mha()), Corruption, "48"},
        {"B057_mha_asks_17_GB", "a.mha",
         "NDims = 3\nDimSize = 2048 2048 2048\nElementType = MET_SHORT\nElementDataFile = LOCAL\n", Corruption,
         "17179869184"},
        {"mha_product_overflow", "a.mha", withMhaLine("DimSize = 4 3 2", "DimSize = 1048576 1048576 1048576"),
         InvalidArgument, "DimSize"},
        {"mha_extent_overflow", "a.mha", withMhaLine("DimSize = 4 3 2", "DimSize = 4 3 99999999999999999999"),
         InvalidArgument, "DimSize"},
        {"mha_zero_extent", "a.mha", withMhaLine("DimSize = 4 3 2", "DimSize = 4 0 2"), InvalidArgument, "DimSize"},
        {"mha_negative_extent", "a.mha", withMhaLine("DimSize = 4 3 2", "DimSize = 4 -3 2"), InvalidArgument,
         "DimSize"},
        {"B051_mha_11_dimensions", "a.mha", withMhaLine("NDims = 3", "NDims = 11"), InvalidArgument, "NDims"},
        {"B051_mha_0_dimensions", "a.mha", withMhaLine("NDims = 3", "NDims = 0"), InvalidArgument, "NDims"},
        {"B055_mha_list_too_long", "a.mha",
         withMhaLine("ElementSpacing = 1 2 3", "ElementSpacing = 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20"),
         InvalidArgument, "ElementSpacing"},
        {"B055_mha_list_too_short", "a.mha", withMhaLine("ElementSpacing = 1 2 3", "ElementSpacing = 1 2"),
         InvalidArgument, "ElementSpacing"},
        {"mha_zero_spacing", "a.mha", withMhaLine("ElementSpacing = 1 2 3", "ElementSpacing = 1 0 3"), InvalidArgument,
         "pacing"},
        {"mha_nan_spacing", "a.mha", withMhaLine("ElementSpacing = 1 2 3", "ElementSpacing = 1 nan 3"), InvalidArgument,
         "pacing"},
        {"mha_flat_directions", "a.mha", withMhaLine("1 0 0 0 1 0 0 0 1", "1 0 0 1 0 0 0 0 1"), InvalidArgument, ""},
        {"B056_mha_type_string", "a.mha", withMhaLine("MET_SHORT", "MET_STRING"), InvalidArgument, "ElementType"},
        {"B056_mha_million_channels", "a.mha", withMhaLine("NDims", "ElementNumberOfChannels = 1000000\nNDims"),
         InvalidArgument, "ElementNumberOfChannels"},
        {"B052_mha_header_size_minus_2", "a.mha", withMhaLine("NDims", "HeaderSize = -2\nNDims"), InvalidArgument,
         "HeaderSize"},
        {"B052_mha_header_size_minus_1_short", "a.mhd", cat({"HeaderSize = -1\n", mhaHeader("data.raw")}), Corruption,
         "48", "short"},
        {"mha_field_twice", "a.mha", withMhaLine("NDims = 3", "NDims = 3\nNDims = 3"), InvalidArgument, "NDims"},
        {"B049_mhd_list_minus_1", "a.mhd", mhaHeader("LIST -1") + "data.raw\n", InvalidArgument, "ElementDataFile"},
        {"B049_mhd_list_of_volumes", "a.mhd", mhaHeader("LIST 3") + "data.raw\n", InvalidArgument, "ElementDataFile",
         "x"},
        {"mhd_list_count", "a.mhd", mhaHeader("LIST") + "data.raw\n", InvalidArgument, "2 files expected, found 1",
         "x"},
        {"mhd_list_missing", "a.mhd", mhaHeader("LIST") + "data.raw\nnone.raw\n", InvalidArgument, "none.raw",
         std::string(24, 'x')},
        {"mhd_list_short", "a.mhd", mhaHeader("LIST") + "data.raw\ndata.raw\n", Corruption, "24", std::string(23, 'x')},
        {"mhd_list_outside", "a.mhd", mhaHeader("LIST") + "data.raw\n../b.raw\n", InvalidArgument, "outside", "x"},
        {"mhd_list_long", "a.mhd", mhaHeader("LIST") + repeated("a\n", 100'000), InvalidArgument, "65536"},
        {"mhd_list_endless", "a.mhd", mhaHeader("LIST") + repeated(std::string(50, 'x') + "\n", 30'000),
         InvalidArgument, "first MiB"},
        {"mhd_itself", "a.mhd", mhaHeader("a.mhd"), InvalidArgument, "the header itself"},
        {"mhd_pattern_range", "a.mhd", mhaHeader("s%03d.raw 1 999999999 1"), InvalidArgument, "ElementDataFile"},
        {"mhd_pattern_count", "a.mhd", mhaHeader("s%d.raw 1 3 1"), InvalidArgument, "2 files expected, found 3"},
        {"B050_mhd_no_data_file", "a.mhd", replaced(mhaHeader(), "ElementDataFile = LOCAL\n", ""), InvalidArgument,
         "ElementDataFile"},
        {"B050_mhd_empty_data_file", "a.mhd", mhaHeader(""), InvalidArgument, "ElementDataFile"},
        {"B050_mhd_local_without_data", "a.mhd", mhaHeader(), Corruption, "48"},
        {"B055_mha_spacing_30", "a.mha", withMhaLine("ElementSpacing = 1 2 3", "ElementSpacing =" + repeated(" 1", 30)),
         InvalidArgument, "ElementSpacing"},
        {"B056_mha_type_unknown", "a.mha", withMhaLine("MET_SHORT", "MET_THING"), InvalidArgument, "ElementType"},
        {"B056_mha_no_channels", "a.mha", withMhaLine("NDims", "ElementNumberOfChannels = 0\nNDims"), InvalidArgument,
         "ElementNumberOfChannels"},
        {"mha_channels_short", "a.mha", withMhaLine("NDims", "ElementNumberOfChannels = 3\nNDims"), Corruption, "144"},
        {"mha_text_word", "a.mha", mhaText("1 2 x" + std::string(60, ' ')), InvalidArgument, "sample 2: 'x'"},
        {"mha_text_short", "a.mha", mhaText("1 2 3"), Corruption, "cannot hold"},
        {"mha_not_text", "a.mha", std::string(5000, '\1'), InvalidArgument, "MetaImage"},
        {"mha_prose", "a.mhd", "Dear reader,\nthis is a letter.\n", InvalidArgument, "MetaImage"},
        {"B050_mhd_outside", "a.mhd", mhaHeader("../x.raw"), InvalidArgument, "ElementDataFile"},
        {"mhd_absolute", "a.mhd", mhaHeader("/etc/passwd"), InvalidArgument, "ElementDataFile"},
        {"B050_mhd_missing_data", "a.mhd", mhaHeader("none.raw"), InvalidArgument, "none.raw"},
        {"B049_mhd_list", "a.mhd", mhaHeader("LIST -1"), InvalidArgument, "ElementDataFile"},
        {"mhd_pattern", "a.mhd", mhaHeader("%s%n%s"), InvalidArgument, "ElementDataFile"},
        {"mhd_short_data", "a.mhd", mhaHeader("data.raw"), Corruption, "47", std::string(47, 'x')},
        {"B054_mha_packed_size_negative", "a.mha", mhaPacked("-1", packed(ramp<std::int16_t>(24), 15)), InvalidArgument,
         "CompressedDataSize"},
        {"B054_mha_packed_size_beyond", "a.mha", mhaPacked("1000000", packed(ramp<std::int16_t>(24), 15)), Corruption,
         "CompressedDataSize"},
        {"B053_mha_unpacks_to_more", "a.mha", mhaPacked("", packed(ramp<std::int16_t>(25), 15)), Corruption,
         "more than"},
        {"B053_mha_unpacks_to_less", "a.mha", mhaPacked("", packed(ramp<std::int16_t>(23), 15)), Corruption, "46"},
        {"B053_mha_packed_garbage", "a.mha", mhaPacked("", std::string(64, 'z')), Corruption, "compressed"},
    };
    return files;
}

const std::vector<BadFile>& badNrrds() {
    static const std::vector<BadFile> files = {
        {"B027_nrrd_magic", "a.nrrd", withNrrdLine("NRRD0004", "NRRD0009"), InvalidArgument, "NRRD000"},
        {"B028_nrrd_dimension_17", "a.nrrd", withNrrdLine("dimension: 3", "dimension: 17"), InvalidArgument,
         "dimension"},
        {"B028_nrrd_dimension_text", "a.nrrd", withNrrdLine("dimension: 3", "dimension: 3abc"), InvalidArgument,
         "dimension"},
        {"B029_nrrd_two_sizes", "a.nrrd", withNrrdLine("sizes: 4 3 2", "sizes: 4 3"), InvalidArgument, "sizes"},
        {"B030_nrrd_sizes_twice", "a.nrrd", withNrrdLine("sizes: 4 3 2", "sizes: 4 3 2\nsizes: 4 3 3"), InvalidArgument,
         "sizes"},
        {"B031_nrrd_size_overflow", "a.nrrd", withNrrdLine("sizes: 4 3 2", "sizes: 4 3 99999999999999999999"),
         InvalidArgument, "sizes"},
        {"B032_nrrd_endless_header", "a.nrrd", cat({"NRRD0004\n", std::string(2'000'000, 'x')}), InvalidArgument,
         "NRRD"},
        {"B032_nrrd_no_blank_line", "a.nrrd", nrrdHeader(), InvalidArgument, "data file"},
        {"B032_nrrd_samples_instead_of_a_blank_line", "a.nrrd", nrrdHeader() + std::string(48, 'x'), InvalidArgument,
         ""},
        {"B033_nrrd_outside", "a.nhdr", detachedNrrd("../../etc/passwd"), InvalidArgument, "data file"},
        {"B035_nrrd_missing", "a.nhdr", detachedNrrd("none.raw"), InvalidArgument, "none.raw"},
        {"B035_nrrd_list_missing", "a.nhdr", detachedNrrd("LIST\nnone1.raw\nnone2.raw"), InvalidArgument, "none1.raw"},
        {"B036_nrrd_pattern_range", "a.nhdr", detachedNrrd("slice%03d.raw 1 999999999 1"), InvalidArgument,
         "data file"},
        {"B037_nrrd_pattern_printf", "a.nhdr", detachedNrrd("%s%n%s 1 2 1"), InvalidArgument, "data file"},
        {"B038_nrrd_byte_skip", "a.nrrd", withNrrdLine("kinds", "byte skip: -2\nkinds"), InvalidArgument, "byte skip"},
        {"B038_nrrd_byte_skip_far", "a.nrrd", withNrrdLine("kinds", "byte skip: 1000000000000\nkinds"), InvalidArgument,
         "byte skip"},
        {"B038_nrrd_line_skip_far", "a.nrrd", withNrrdLine("kinds", "line skip: 1000000000000\nkinds"), InvalidArgument,
         "line skip"},
        {"B027_nrrd_magic_text", "a.nrrd", withNrrdLine("NRRD0004", "NRRDabcd"), InvalidArgument, "NRRD000"},
        {"B028_nrrd_dimension_0", "a.nrrd", withNrrdLine("dimension: 3", "dimension: 0"), InvalidArgument, "dimension"},
        {"B028_nrrd_dimension_negative", "a.nrrd", withNrrdLine("dimension: 3", "dimension: -3"), InvalidArgument,
         "dimension"},
        {"B029_nrrd_four_sizes", "a.nrrd", withNrrdLine("sizes: 4 3 2", "sizes: 4 3 2 1"), InvalidArgument, "sizes"},
        {"B033_nrrd_far_outside", "a.nhdr", detachedNrrd("../../../../etc/passwd"), InvalidArgument,
         "outside the folder"},
        {"B033_nrrd_absolute", "a.nhdr", detachedNrrd("/etc/passwd"), InvalidArgument, "data file"},
        {"B035_nrrd_list_itself", "a.nhdr", detachedNrrd("LIST\na.nhdr\na.nhdr"), InvalidArgument, "the header itself"},
        {"B035_nrrd_list_long", "a.nhdr", detachedNrrd("LIST\n" + repeated("a\n", 100'000)), InvalidArgument, "65536"},
        {"B035_nrrd_list_huge", "a.nhdr", detachedNrrd("LIST\n" + repeated("a\n", 1'000'000)), InvalidArgument,
         "65536"},
        {"B037_nrrd_pattern_alone", "a.nhdr", detachedNrrd("%s%n%s"), InvalidArgument, "data file"},
        {"B038_nrrd_line_skip_negative", "a.nrrd", withNrrdLine("kinds", "line skip: -1\nkinds"), InvalidArgument,
         "line skip"},
        {"B038_nrrd_byte_skip_beyond", "a.nrrd", withNrrdLine("kinds", "byte skip: 49\nkinds"), InvalidArgument,
         "byte skip"},
        {"B042_nrrd_encoding", "a.nrrd", withNrrdLine("encoding: raw", "encoding: zrl"), InvalidArgument,
         "encoding: 'zrl'"},
        {"B043_nrrd_text_range", "a.nrrd", nrrdText("5 99999 7 8"), InvalidArgument,
         "sample 1: '99999' is not a number of type int16"},
        {"B043_nrrd_text_word", "a.nrrd", nrrdText("5 6 abc 8"), InvalidArgument, "sample 2: 'abc'"},
        {"B043_nrrd_text_fraction", "a.nrrd", nrrdText("5 6 7.5 8"), InvalidArgument, "sample 2: '7.5'"},
        {"nrrd_text_short", "a.nrrd", nrrdText("5 6 7"), Corruption, "6 bytes, 48 expected"},
        {"nrrd_text_none", "a.nrrd", nrrdEncoded("ascii", "5 6 7"), Corruption, "cannot hold"},
        {"nrrd_text_more", "a.nrrd", nrrdText(repeated("1 ", 25)), Corruption, "more than"},
        {"nrrd_hex_digit", "a.nrrd", nrrdEncoded("hex", std::string(95, '0') + "g"), InvalidArgument,
         "'g' is not a hexadecimal digit"},
        {"nrrd_hex_odd", "a.nrrd", nrrdEncoded("hex", std::string(95, '0') + " "), Corruption, "within a byte"},
        {"nrrd_hex_short", "a.nrrd", nrrdEncoded("hex", std::string(94, '0')), Corruption, "cannot hold"},
        {"nrrd_bzip2_is_not", "a.nrrd", nrrdEncoded("bzip2", std::string(48, 'x')), Corruption, "not bzip2"},
        {"nrrd_bzip2_cut", "a.nrrd", nrrdEncoded("bzip2", shorter(bzipped(ramp<std::int16_t>(24)))), Corruption,
         "early"},
        {"nrrd_bzip2_asks_much", "a.nrrd",
         replaced(nrrdEncoded("bzip2", bzipped(ramp<std::int16_t>(24))), "sizes: 4 3 2", "sizes: 4096 4096 512"),
         Corruption, "48 bytes"},
        {"B044_nrrd_zero_spacing", "a.nrrd", nrrdSpacings("1 0 3"), InvalidArgument, "spacings"},
        {"B044_nrrd_negative_spacing", "a.nrrd", nrrdSpacings("1 -1 3"), InvalidArgument, "spacings"},
        {"B044_nrrd_infinite_spacing", "a.nrrd", nrrdSpacings("1 inf 3"), InvalidArgument, "spacings"},
        {"B045_nrrd_nan_direction", "a.nrrd", withNrrdLine("(0,2,0)", "(0,nan,0)"), InvalidArgument,
         "space directions"},
        {"B045_nrrd_short_direction", "a.nrrd", withNrrdLine("(0,2,0)", "(1,0)"), InvalidArgument, "space directions"},
        {"B046_nrrd_none_of_vectors", "a.nrrd",
         replaced(withNrrdLine("(0,2,0)", "none"), "domain domain domain", "domain 3-vector domain"), InvalidArgument,
         "3 components (x, y, z)"},
        {"nrrd_two_directions_of_three", "a.nrrd",
         replaced(withNrrdLine("(0,2,0)", "(0,2)"), "sizes: 4 3 2", "sizes: 4 6 1"), InvalidArgument, ""},
        {"nrrd_kinds_count", "a.nrrd", withNrrdLine("domain domain domain", "domain domain"), InvalidArgument, "kinds"},
        {"nrrd_four_dimensions", "a.nrrd", nrrdOfFour(), InvalidArgument, "--frame 0 to 1"},
        {"nrrd_list_dimension", "a.nhdr", detachedNrrd("LIST 9\nnone.raw"), InvalidArgument, "data file"},
        {"nrrd_list_count", "a.nhdr", detachedNrrd("LIST 1\nnone.raw"), InvalidArgument, "6 files of 1 dimensions"},
        {"nrrd_gzip_ends_early", "a.nrrd",
         replaced(nrrdGzip(gzipped("ab") + std::string(1'100'000, 'x')), "sizes: 4 3 2", "sizes: 4096 4096 32"),
         Corruption, "unpacks to 2 bytes"},
        {"nrrd_bzip2_asks_a_large_plane", "a.nrrd",
         replaced(nrrdEncoded("bzip2", bzipped("ab")), "sizes: 4 3 2", "sizes: 32768 8192 2"), Corruption,
         "unpacks to 2 bytes"},
        {"nrrd_gzip_asks_a_large_plane", "a.nrrd",
         replaced(nrrdGzip(gzipped("ab") + std::string(1'100'000, 'x')), "sizes: 4 3 2", "sizes: 32768 16384 1"),
         Corruption, "unpacks to 2 bytes"},
        {"nrrd_components_ask_much", "a.nrrd",
         replaced(replaced(withNrrdLine("domain domain domain", "vector domain domain"), "(1,0,0)", "none"),
                  "sizes: 4 3 2", "sizes: 1000000 1000 2"),
         Corruption, "4000000000"},
        {"nrrd_short", "a.nrrd", shorter(nrrd()), Corruption, "48"},
        {"B039_nrrd_bomb", "a.nrrd",
         replaced(nrrdGzip(gzippedRepeats(std::string(std::size_t{1} << 24, '\0'), 64)), "sizes: 4 3 2",
                  "sizes: 8 8 8"),
         Corruption, "more than"},
        {"B039_nrrd_bomb_of_members", "a.nrrd",
         nrrdGzip(repeated(gzippedRepeats(std::string(std::size_t{1} << 20, '\0'), 4), 256)), Corruption, "more than"},
        {"B040_nrrd_gzip_cut", "a.nrrd", nrrdGzip(shorter(gzipped(ramp<std::int16_t>(24)))), Corruption, "early"},
        {"B040_nrrd_gzip_checksum", "a.nrrd", nrrdGzip(badChecksum()), Corruption, "damaged"},
        {"nrrd_gzip_asks_too_much", "a.nrrd", replaced(nrrdGzip("xyz"), "sizes: 4 3 2", "sizes: 4096 4096 4096"),
         Corruption, "cannot hold"},
        {"B045_nrrd_zero_direction", "a.nrrd", withNrrdLine("(0,2,0)", "(0,0,0)"), InvalidArgument, "space directions"},
        {"B045_nrrd_same_direction", "a.nrrd", withNrrdLine("(0,2,0)", "(2,0,0)"), InvalidArgument, "space directions"},
        {"B046_nrrd_none_direction", "a.nrrd", withNrrdLine("(0,2,0)", "none"), InvalidArgument, "--component 0 to 2"},
        {"B044_nrrd_nan_spacing", "a.nrrd", nrrdSpacings("1 nan 3"), InvalidArgument, "spacings"},
        {"nrrd_type", "a.nrrd", withNrrdLine("type: short", "type: block"), InvalidArgument, "type"},
        {"nrrd_no_endian", "a.nrrd", withNrrdLine("endian: little\n", ""), InvalidArgument, "endian"},
    };
    return files;
}

const std::vector<BadFile>& badNiftis() {
    static const std::vector<BadFile> files = {
        {"B058_nifti_sizeof_hdr", "a.nii", niftiWith<std::int32_t>(0, 347), InvalidArgument, "sizeof_hdr"},
        {"B058_nifti_sizeof_hdr_big_endian", "a.nii", niftiWith<std::uint32_t>(0, 0x5b010000), InvalidArgument,
         "sizeof_hdr"}, // 347
        {"B058_nifti_sizeof_hdr_2_big_endian", "a.nii", niftiWith<std::uint32_t>(0, 0x1b020000), InvalidArgument,
         "sizeof_hdr"}, // 539
        {"B058_nifti_sizeof_hdr_0", "a.nii", niftiWith<std::int32_t>(0, 0), InvalidArgument, "sizeof_hdr"},
        {"B058_nifti_sizeof_hdr_negative", "a.nii", niftiWith<std::int32_t>(0, -348), InvalidArgument, "sizeof_hdr"},
        {"B059_nifti_dim0_200", "a.nii", niftiWith<std::int16_t>(40, 200), InvalidArgument, "dim[0]"},
        {"B059_nifti_dim0_negative", "a.nii", niftiWith<std::int16_t>(40, -5), InvalidArgument, "dim[0]"},
        {"B060_nifti_dim1_negative", "a.nii", niftiWith<std::int16_t>(42, -1), InvalidArgument, "dim"},
        {"B060_nifti_asks_18_GB", "a.nii", niftiWith<std::int64_t>(42, 0x0bb8'0bb8'0bb8), Corruption, "54000000000"},
        {"B061_nifti_offset_nan", "a.nii", niftiWith<float>(108, kNan), InvalidArgument, "vox_offset"},
        {"B061_nifti_offset_infinite", "a.nii", niftiWith<float>(108, std::numeric_limits<float>::infinity()),
         InvalidArgument, "vox_offset"},
        {"B061_nifti_offset_huge", "a.nii", niftiWith<float>(108, 1e30f), InvalidArgument, "vox_offset"},
        {"B061_nifti_offset_zero", "a.nii", niftiWith<float>(108, 0), InvalidArgument, "vox_offset"},
        {"B061_nifti_offset_negative", "a.nii", niftiWith<float>(108, -352), InvalidArgument, "vox_offset"},
        {"B064_nifti_bitpix", "a.nii", niftiWith<std::int16_t>(72, 8), InvalidArgument, "bitpix"},
        {"B059_nifti_dim0_0", "a.nii", niftiWith<std::int16_t>(40, 0), InvalidArgument, "dim[0]"},
        {"B060_nifti_dim1_0", "a.nii", niftiWith<std::int16_t>(42, 0), InvalidArgument, "dim"},
        {"B064_nifti_float128", "a.nii", niftiWith<std::int32_t>(70, 1536 + (128 << 16)), InvalidArgument, "float128"},
        {"B064_nifti_rgb24", "a.nii", niftiWith<std::int32_t>(70, 128 + (24 << 16)) + std::string(24, 'x'),
         InvalidArgument, "--component"},
        {"B065_nifti_extension_cycle", "a.nii", niftiExtensionCycle(), InvalidArgument, "extension"},
        {"nifti_short", "a.nii", shorter(nifti()), Corruption, "48"},
        {"nifti_header_only", "a.nii", nifti().substr(0, 100), InvalidArgument, "348"},
        {"B065_nifti_extension_size", "a.nii", niftiExtension(15), InvalidArgument, "extension"},
        {"B065_nifti_extension_negative", "a.nii", niftiExtension(-16), InvalidArgument, "extension"},
        {"B065_nifti_extension_of_2_GiB", "a.nii", niftiExtension(0x7ffffff0), InvalidArgument, "extension"},
        {"B065_nifti_extension_beyond", "a.nii", niftiExtension(1600), InvalidArgument, "extension"},
        {"B066_nifti_gz_is_not", "a.nii.gz", nifti(), Corruption, "compressed"},
        {"nifti_gz_cut", "a.nii.gz", shorter(gzipped(nifti())), Corruption, "early"},
        {"nifti_gz_longer", "a.nii.gz", gzipped(nifti() + "x"), Corruption, "more than"},
        {"B066_nifti_pair_without_img", "a.hdr", replaced(nifti(), "n+1", "ni1"), InvalidArgument, "a.img"},
    };
    return files;
}

namespace {

/// Appended zlib data; the numbers are those that head it: blocks, their size, the last one's, packed sizes.
std::string vtiPacked(std::initializer_list<std::uint32_t> heading) {
    std::string bytes;
    for (const std::uint32_t number : heading) {
        bytes.resize(bytes.size() + 4);
        put(bytes, bytes.size() - 4, number);
    }
    std::string text =
        replaced(vtiAppended("0", 48), " byte_order", " compressor=\"vtkZLibDataCompressor\" byte_order");
    const auto begin = text.find("\n_") + 2;
    return text.replace(begin, 4, bytes);
}

std::string laughs() {
    std::string text = "<?xml version=\"1.0\"?><!DOCTYPE lolz [<!ENTITY lol \"lol\">";
    for (char c = 'a'; c < 'k'; ++c)
        text += std::string("<!ENTITY lol") + c + " \"" +
                repeated(c == 'a' ? "&lol;" : std::string("&lol") + static_cast<char>(c - 1) + ";", 10) + "\">";
    return text + "]><VTKFile type=\"ImageData\">&lolj;</VTKFile>";
}

} // namespace

const std::vector<BadFile>& badVtks() {
    static const std::vector<BadFile> files = {
        {"B068_vtk_three_lines", "a.vtk", "# vtk DataFile Version 3.0\ntitle\nASCII\n", InvalidArgument, "DATASET"},
        {"B068_vtk_one_line", "a.vtk", "# vtk DataFile Version 3.0", InvalidArgument, "encoding"},
        {"B068_vtk_two_lines", "a.vtk", "# vtk DataFile Version 3.0\ntitle", InvalidArgument, "encoding"},
        {"B069_vtk_coordinates", "a.vtk", replaced(vtkRectilinear(), "Y_COORDINATES 2", "Y_COORDINATES 1"),
         InvalidArgument, "COORDINATES"},
        {"B069_vtk_points", "a.vtk", replaced(vtkCells(), "POINT_DATA 5", "POINT_DATA 6"), InvalidArgument,
         "POINT_DATA"},
        {"B069_vtk_count_less", "a.vtk", withVtk("POINT_DATA 24", "POINT_DATA 23"), InvalidArgument, "POINT_DATA"},
        {"B069_vtk_count_overflow", "a.vtk", withVtk("POINT_DATA 24", "POINT_DATA 18446744073709551640"),
         InvalidArgument, "POINT_DATA"},
        {"B069_vtk_count", "a.vtk", withVtk("POINT_DATA 24", "POINT_DATA 25"), InvalidArgument, "POINT_DATA"},
        {"B070_vtk_components", "a.vtk", withVtk("SCALARS s short", "SCALARS s short 1000000"), InvalidArgument,
         "components"},
        {"B070_vtk_color", "a.vtk", withVtk("SCALARS s short\nLOOKUP_TABLE default", "COLOR_SCALARS s -1"),
         InvalidArgument, "components"},
        {"vtk_short", "a.vtk", shorter(shorter(vtkBinary())), Corruption, "early"},
        {"vtk_text_number", "a.vtk", replaced(vtkText(), " 7 ", " abc "), InvalidArgument, "sample 7"},
        {"vtk_text_range", "a.vtk", replaced(vtkText(), " 7 ", " 99999 "), InvalidArgument, "sample 7"},
        {"vtk_text_nan", "a.vtk", replaced(replaced(vtkText(), "SCALARS s short", "SCALARS s float"), " 7 ", " nan "),
         InvalidArgument, "sample 7"},
        {"vtk_text_negative", "a.vtk",
         replaced(replaced(vtkText(), "SCALARS s short", "SCALARS s unsigned_int"), " 7 ", " -7 "), InvalidArgument,
         "sample 7"},
        {"vtk_text_char_range", "a.vtk",
         replaced(replaced(vtkText(), "SCALARS s short", "SCALARS s char"), " 7 ", " 128 "), InvalidArgument,
         "sample 7"},
        {"vtk_text_float_range", "a.vtk",
         replaced(replaced(vtkText(), "SCALARS s short", "SCALARS s float"), " 7 ", " 1e39 "), InvalidArgument,
         "sample 7"},
        {"vtk_text_endless_word", "a.vtk", replaced(vtkText(), " 7 ", " " + std::string(100'000, '0') + "7 "),
         InvalidArgument, "sample 7"},
        {"vtk_text_short", "a.vtk", replaced(vtkText(), " 21 22 23", " 21 22"), InvalidArgument, "sample 23"},
        {"vtk_endless_header", "a.vtk", withVtk("SPACING 1 2 3\n", repeated("SPACING 1 2 3\n", 100'000)),
         InvalidArgument, "header"},
        {"vtk_million_in_samples", "a.vtk",
         withVtk("LOOKUP_TABLE default\n", "LOOKUP_TABLE default\nSCALARS t float 100000000\n").substr(0, 200),
         Corruption, "early"},
        {"B074_vtk_cells", "a.vtk", withVtk("POINT_DATA 24", "CELL_DATA 6"), InvalidArgument,
         "convert them to point data"},
        {"vtk_huge", "a.vtk",
         replaced(withVtk("DIMENSIONS 4 3 2", "DIMENSIONS 4000 3000 2000"), "POINT_DATA 24", "POINT_DATA 24000000000"),
         Corruption, "early"},
        {"B071_vti_reversed", "a.vti", withVti("0 3 0 2 0 1\" Origin", "3 0 0 2 0 1\" Origin"), InvalidArgument,
         "Piece"},
        {"B071_vti_both_reversed", "a.vti",
         replaced(withVti("0 3 0 2 0 1\" Origin", "3 0 0 2 0 1\" Origin"), "Extent=\"0 3 0 2 0 1\">",
                  "Extent=\"3 0 0 2 0 1\">"),
         InvalidArgument, "WholeExtent"},
        {"B071_vti_int_min", "a.vti",
         replaced(withVti("0 3 0 2 0 1\" Origin", "-2147483648 2147483647 0 2 0 1\" Origin"), "Extent=\"0 3 0 2 0 1\">",
                  "Extent=\"-2147483648 2147483647 0 2 0 1\">"),
         InvalidArgument, "WholeExtent"},
        {"B071_vti_int_max", "a.vti",
         replaced(withVti("0 3 0 2 0 1\" Origin", "0 2147483647 0 2 0 1\" Origin"), "Extent=\"0 3 0 2 0 1\">",
                  "Extent=\"0 2147483647 0 2 0 1\">"),
         InvalidArgument, "WholeExtent"},
        {"vti_huge", "a.vti",
         replaced(withVti("0 3 0 2 0 1\" Origin", "0 3000 0 2000 0 1000\" Origin"), "Extent=\"0 3 0 2 0 1\">",
                  "Extent=\"0 3000 0 2000 0 1000\">"),
         Corruption, "data"},
        {"B071_vti_piece", "a.vti", withVti("Piece Extent=\"0 3 0 2 0 1\"", "Piece Extent=\"0 3 0 2 0 0\""),
         InvalidArgument, "Piece"},
        {"B072_vti_offset", "a.vti", vtiAppended("1000000", 48), Corruption, "offset"},
        {"B072_vti_block_bytes", "a.vti", vtiAppended("0", 0xffffffffu), Corruption, "block"},
        {"B072_vti_blocks", "a.vti",
         replaced(vtiAppended("0", 0xffffffffu), " byte_order", " compressor=\"vtkZLibDataCompressor\" byte_order"),
         Corruption, "blocks"},
        {"B072_vti_encoding", "a.vti", replaced(vtiAppended("0", 48), "encoding=\"raw\"", "encoding=\"rav\""),
         InvalidArgument, "encoding"},
        {"B072_vti_format", "a.vti", withVti("format=\"ascii\"", "format=\"askii\""), InvalidArgument, "format"},
        {"B072_vti_block_of_none", "a.vti", vtiPacked({1, 0, 0, 8}), Corruption, "data block"},
        {"B072_vti_2_to_the_32_blocks", "a.vti", vtiPacked({0xffffffffu, 48, 0, 8}), Corruption, "blocks"},
        {"B072_vti_blocks_of_size_0", "a.vti", vtiPacked({1, 0, 48, 8}), Corruption, "block"},
        {"B072_vti_no_mark", "a.vti", replaced(vtiAppended("0", 48), "\n_", "5_"), Corruption, "offset"},
        {"B072_vti_packed_beyond", "a.vti", vtiPacked({1, 48, 0, 1'000'000}), Corruption, "beyond"},
        {"B073_vti_laughs", "a.vti", laughs(), InvalidArgument, "DOCTYPE"},
        {"B073_vtu_laughs", "a.vtu", laughs(), InvalidArgument, "DOCTYPE"},
        {"B073_vti_doctype", "a.vti", replaced(vti(), "<VTKFile", "<!DOCTYPE a [<!ENTITY b \"c\">]><VTKFile"),
         InvalidArgument, "DOCTYPE"},
        {"B073_vti_deep", "a.vti", deepXml(), InvalidArgument, "deeper"},
        {"B073_vti_base64", "a.vti",
         replaced(withVti("format=\"ascii\"", "format=\"binary\""), "0 1 2 3", "???? !!!! $$$$ )))) "), Corruption,
         "base64"},
        {"B073_vti_base64_later", "a.vti",
         replaced(withVti("format=\"ascii\"", "format=\"binary\""), "0 1 2 3", "MAAAAA!!!! $$$$ )))) "), Corruption,
         "base64"},
        {"vti_short_text", "a.vti", withVti(" 20 21 22 23", ""), Corruption, "VTK"},
        {"B074_vti_cells", "a.vti", replaced(replaced(vti(), "<PointData", "<CellData"), "</PointData", "</CellData"),
         InvalidArgument, "point data"},
        {"vti_components", "a.vti", withVti("Name=\"s\"", "Name=\"s\" NumberOfComponents=\"3\""), InvalidArgument,
         "component"},
        {"vti_not_xml", "a.vti", "hello", InvalidArgument, "XML"},
        {"vti_cut", "a.vti", vti().substr(0, 300), InvalidArgument, "XML"},
        {"vtk_polydata", "a.vtk", withVtk("STRUCTURED_POINTS", "POLYDATA"), InvalidArgument, "POLYDATA"},
        {"vtk_cells_beyond", "a.vtk", replaced(vtkCells(), "4 0 1 2 3", "4 0 1 2 9"), Corruption, "point 9 of 5"},
        {"vtk_cells_negative", "a.vtk", replaced(vtkCells(), "4 0 1 2 3", "4 0 1 2 -3"), Corruption, "Cells"},
        {"vtk_cells_short", "a.vtk", replaced(vtkCells(), "4 0 1 2 3\n4 1 2 3 4", "3 0 1 2 5 1 2 3 4 0"), Corruption,
         "its type 4"},
        {"vtk_cells_too_many", "a.vtk", replaced(vtkCells(), "CELLS 2 10", "CELLS 2 1000000000000"), Corruption,
         "early"},
        {"vtk_cells_of_none", "a.vtk", replaced(vtkCells(), "10 10", "5 5"), InvalidArgument, "volume"},
        {"vtk_cells_flat", "a.vtk", replaced(vtkCells(), "10 10", "9 9"), InvalidArgument, "volume"},
        {"vtk_points_nan", "a.vtk", replaced(vtkCells(), "0 0 0", "0 nan 0"), InvalidArgument, "points: number 1"},
        {"vtu_huge", "a.vtu", replaced(vtu(), "NumberOfPoints=\"5\"", "NumberOfPoints=\"500000000000\""), Corruption,
         "data"},
        {"vtu_no_cells", "a.vtu", replaced(vtu(), "NumberOfCells=\"2\"", "NumberOfCells=\"0\""), InvalidArgument,
         "NumberOfCells"},
        {"vtu_too_many_cells", "a.vtu", replaced(vtu(), "NumberOfCells=\"2\"", "NumberOfCells=\"9000000000000000\""),
         InvalidArgument, "NumberOfCells"},
        {"vtu_cells_beyond", "a.vtu", replaced(vtu(), "0 1 2 3 1", "0 1 2 9 1"), Corruption, "point 9 of 5"},
        {"vtu_offsets", "a.vtu", replaced(vtu(), "4 8", "4 3"), Corruption, ""},
        {"vtu_offsets_beyond", "a.vtu", replaced(vtu(), "4 8", "4 8000000000"), Corruption, "corner 8000000000 of 8"},
        {"vtu_offsets_negative", "a.vtu", replaced(vtu(), "4 8", "-4 8"), Corruption, "offsets"},
        {"vtu_offsets_words", "a.vtu", replaced(vtu(), "4 8", "4 eight"), Corruption, "offsets: whole numbers"},
        {"vtu_corner_negative", "a.vtu", replaced(vtu(), "0 1 2 3 1", "0 1 2 -3 1"), Corruption,
         "corner 3 is point -3 of 5"},
        {"vtp", "a.vtu", replaced(vtu(), "type=\"UnstructuredGrid\"", "type=\"PolyData\""), InvalidArgument,
         "PolyData"},
        {"plot3d_size", "xyz.bin", std::string(1000, '\0'), NotFound, "q.bin"},
        {"unknown_suffix", "a.txt", "hello", InvalidArgument, "of no volume format"},
        {"empty", "a.mha", "", InvalidArgument, "empty"},
    };
    return files;
}

namespace {

std::string mrc(std::int32_t sections) {
    std::string bytes(1024, '\0');
    const std::int32_t words[4] = {2048, 2048, sections, 2};
    std::memcpy(bytes.data(), words, sizeof words);
    std::memcpy(bytes.data() + 208, "MAP DD", 6);
    return bytes;
}
std::string cube(const std::string& points) {
    return "a\nb\n0 0 0 0\n" + points + " 1 0 0\n" + points + " 0 1 0\n" + points + " 0 0 1\n";
}

} // namespace

const std::vector<BadFile>& badMaps() {
    static const std::vector<BadFile> files = {
        {"mrc_asks_17_GB", "a.mrc", mrc(1024), Corruption, "17179869184"},
        {"mrc_gz_asks_17_GB", "a.mrc.gz", gzipped(mrc(1024)), Corruption, "cannot hold"},
        {"mrc_gz_ends_early", "a.mrc.gz", gzipped(mrc(64)) + std::string(1'100'000, 'x'), Corruption, "1024 bytes"},
        {"mrc_not_a_map", "a.map", std::string(2000, '\1'), InvalidArgument, "nx"},
        {"cube_asks_8_GB", "a.cube", cube("1000"), Corruption, "cannot hold"},
        {"cube_gz_ends_early", "a.cube.gz", gzipped(cube("1000")) + std::string(2'000'000, 'x'), Corruption,
         "1000000000 expected"},
        {"cube_of_blanks", "a.cube", cube("200") + std::string(16'000'000, ' '), Corruption, "8000000 expected"},
        {"cube_not_one", "a.cub", "hello", Corruption, "title"},
    };
    return files;
}

} // namespace isoslider::test
