// What one file holds, packed as it may be.
#include <sys/resource.h>

#include <chrono>
#include <cmath>
#include <numeric>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <gdcmImageChangeTransferSyntax.h>
#include <gdcmImageReader.h>
#include <gdcmImageWriter.h>

#include "core/volume_io/volume_contents.h"
#include "core/volume_io/volume_reader.h"
#include "tests/support/result_matchers.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/core/volume_io/formats/dicom/dicom_bytes.h"

namespace isoslider::io {
namespace {

using test::DicomElements;
using test::dicomFile;
using test::dicomSlice;
using testing::Contains;
using testing::HasSubstr;
using enum ErrorCode;

std::vector<int> valuesOf(const ScalarGrid& grid) {
    return grid.visit([](auto values) { return std::vector<int>(values.begin(), values.end()); });
}

/// What dicomSlice has for samples.
std::vector<int> plainSamples() {
    std::vector<int> samples;
    for (int y = 0; y < 6; ++y)
        for (int x = 0; x < 8; ++x)
            samples.push_back(x + 10 * y);
    return samples;
}

Result<std::shared_ptr<const ScalarGrid>> readFile(const std::string& bytes, const ReadOptions& options = {},
                                                   const std::string& name = "slice.dcm") {
    const test::TemporaryFolder folder;
    return readVolume(folder.write(name, bytes), options);
}

std::string swappedPairs(std::string bytes) {
    for (std::size_t i = 0; i + 1 < bytes.size(); i += 2)
        std::swap(bytes[i], bytes[i + 1]);
    return bytes;
}

std::string plainBytes() {
    std::string bytes;
    for (const int sample : plainSamples())
        bytes += DicomElements::integer(static_cast<std::uint64_t>(sample), 2);
    return bytes;
}

TEST(DicomFile, IsReadInEveryNativeTransferSyntax) {
    auto swapped = dicomSlice(0, 1);
    swapped.text(0x7fe00010, "OW", swappedPairs(plainBytes()));
    const std::string files[] = {dicomFile(dicomSlice(0, 1), test::kExplicitLittle),
                                 dicomFile(dicomSlice(0, 1), test::kImplicitLittle),
                                 dicomFile(dicomSlice(0, 1), test::kDeflatedLittle),
                                 dicomFile(swapped, test::kExplicitBig),
                                 dicomSlice(0, 1).bytes(), // without preamble and meta information
                                 dicomSlice(0, 1).bytes(false),
                                 swapped.bytes(true, true)};
    for (const std::string& file : files)
        for (const char* name : {"slice.dcm", "SLICE"}) {
            const auto grid = readFile(file, {}, name);
            ASSERT_THAT(grid, test::IsOk()) << &file - files;
            EXPECT_EQ(valuesOf(*grid.value()), plainSamples()) << &file - files;
        }
}

std::string literally(const std::string& bytes) {
    std::string all;
    for (std::size_t i = 0; i < bytes.size(); i += 100) {
        const std::string part = bytes.substr(i, 100);
        all += static_cast<char>(part.size() - 1) + part;
    }
    return all;
}

std::string runLengthFrame(const std::vector<std::string>& segments) {
    std::string head = DicomElements::integer(segments.size(), 4), body;
    for (const std::string& segment : segments) {
        head += DicomElements::integer(64 + body.size(), 4);
        body += segment;
    }
    head.resize(64, '\0');
    return head + body + (body.size() % 2 != 0 ? std::string(1, '\0') : "");
}

std::string plainRunLength() {
    std::string low;
    for (const int sample : plainSamples())
        low += static_cast<char>(sample);
    return runLengthFrame({std::string("\xd1\x00", 2), literally(low)}); // 48 zeros in two bytes
}

// 64 MiB of zeros in an element nobody asks for, in 64 KiB.
TEST(DicomFile, DoesNotUnpackWhatNobodyAsksFor) {
    auto elements = dicomSlice(0, 1);
    elements.text(0x00091001, "UN", std::string(std::size_t{64} << 20, '\0'));
    const auto grid = readFile(dicomFile(elements, test::kDeflatedLittle));
    ASSERT_THAT(grid, test::HasError(Corruption));
}

TEST(DicomFile, UnpacksNoMoreThanReadingMayHold) {
    const test::TemporaryFolder folder;
    const auto path = folder.write("a.dcm", dicomFile(dicomSlice(0, 1), test::kDeflatedLittle));
    ReadOptions options;
    options.memoryBytes = 64;
    const auto refused = readVolume(path, options);
    ASSERT_THAT(refused, test::HasError(ErrorCode::OutOfSpace));
    EXPECT_THAT(refused.error().message, testing::HasSubstr("half of the memory budget"));
    options.memoryBytes = std::uint64_t{1} << 20;
    EXPECT_THAT(readVolume(path, options), test::IsOk());
}

TEST(DicomFile, UnpacksRunLengths) {
    const auto elements = test::encapsulated(dicomSlice(0, 1), test::dicomFragments({plainRunLength()}));
    const auto grid = readFile(dicomFile(elements, test::kRunLength));
    ASSERT_THAT(grid, test::IsOk());
    EXPECT_EQ(valuesOf(*grid.value()), plainSamples());
}

TEST(DicomFile, UnpacksWhatGdcmPacks) {
    const test::TemporaryFolder folder;
    const auto plain = folder.write("plain.dcm", dicomFile(dicomSlice(0, 1)));
    for (const auto syntax : {gdcm::TransferSyntax::JPEGLosslessProcess14_1, gdcm::TransferSyntax::JPEGLSLossless,
                              gdcm::TransferSyntax::JPEG2000Lossless, gdcm::TransferSyntax::RLELossless}) {
        gdcm::ImageReader reader;
        reader.SetFileName(plain.c_str());
        ASSERT_TRUE(reader.Read());
        gdcm::ImageChangeTransferSyntax change;
        change.SetTransferSyntax(syntax);
        change.SetInput(reader.GetImage());
        ASSERT_TRUE(change.Change());
        gdcm::ImageWriter writer;
        writer.SetFile(reader.GetFile());
        writer.SetImage(change.GetOutput());
        const auto packed = folder / "packed.dcm";
        writer.SetFileName(packed.c_str());
        ASSERT_TRUE(writer.Write());
        const auto grid = readVolume(packed);
        ASSERT_THAT(grid, test::IsOk()) << syntax;
        EXPECT_EQ(valuesOf(*grid.value()), plainSamples()) << syntax;
    }
}

TEST(DicomFile, KeepsTheStoredBitsOnly) {
    auto elements = dicomSlice(0, 1, [](int x, int) { return x % 2 == 0 ? 0x8fff : 0x7001; });
    elements.number(0x00280101, "US", 12).number(0x00280102, "US", 11);
    auto grid = readFile(dicomFile(elements));
    ASSERT_THAT(grid, test::IsOk());
    EXPECT_EQ(grid.value()->valueAt(0, 0, 0), -1); // the sign is in bit 11
    EXPECT_EQ(grid.value()->valueAt(1, 0, 0), 1);
    elements.number(0x00280103, "US", 0).number(0x00280102, "US", 15);
    grid = readFile(dicomFile(elements));
    ASSERT_THAT(grid, test::IsOk());
    EXPECT_EQ(grid.value()->valueAt(0, 0, 0), 0x8ff);
    EXPECT_EQ(grid.value()->valueAt(1, 0, 0), 0x700);
}

DicomElements colours(bool isPlanar) {
    std::string samples;
    for (int i = 0; i < 3 * 48; ++i)
        samples += static_cast<char>(isPlanar ? i / 48 * 50 + i % 48 : i % 3 * 50 + i / 3);
    auto elements = dicomSlice(0, 1);
    elements.number(0x00280002, "US", 3).text(0x00280004, "CS", "RGB").number(0x00280006, "US", isPlanar);
    elements.number(0x00280100, "US", 8).number(0x00280101, "US", 8).number(0x00280102, "US", 7);
    elements.number(0x00280103, "US", 0).text(0x7fe00010, "OB", samples);
    return elements;
}

TEST(DicomFile, GivesOneComponentOfColours) {
    EXPECT_THAT(readFile(dicomFile(colours(false))), test::HasError(InvalidArgument));
    for (const bool isPlanar : {false, true}) {
        ReadOptions options;
        options.component = 2;
        auto grid = readFile(dicomFile(colours(isPlanar)), options);
        ASSERT_THAT(grid, test::IsOk());
        EXPECT_EQ(grid.value()->valueAt(7, 0, 0), 107);
        options.component = kMagnitude;
        grid = readFile(dicomFile(colours(isPlanar)), options);
        ASSERT_THAT(grid, test::IsOk());
        EXPECT_EQ(grid.value()->type(), ScalarType::F32);
        EXPECT_NEAR(grid.value()->valueAt(7, 0, 0), std::sqrt(7 * 7 + 57 * 57 + 107 * 107), 1e-4);
    }
}

DicomElements positionGroup(double z) {
    DicomElements place;
    place.text(0x00200032, "DS", "10\\20\\" + std::to_string(z));
    DicomElements group;
    group.sequence(0x00209113, {place});
    return group;
}

TEST(DicomFile, SortsTheFramesOfAnEnhancedImage) {
    auto elements = dicomSlice(0, 1);
    elements.without(0x00200032).without(0x00200037).without(0x00280030).without(0x00180050);
    DicomElements directions, measures, transformation, shared;
    directions.text(0x00200037, "DS", "1\\0\\0\\0\\1\\0");
    measures.text(0x00280030, "DS", "0.75\\0.5").text(0x00180050, "DS", "9");
    transformation.text(0x00281052, "DS", "100").text(0x00281053, "DS", "2");
    shared.sequence(0x00209116, {directions}).sequence(0x00289110, {measures}).sequence(0x00289145, {transformation});
    elements.text(0x00280008, "IS", "3").sequence(0x52009229, {shared});
    elements.sequence(0x52009230, {positionGroup(4), positionGroup(0), positionGroup(2)});
    std::string samples;
    for (int frame = 0; frame < 3; ++frame)
        for (int i = 0; i < 48; ++i)
            samples += DicomElements::integer(static_cast<std::uint64_t>(frame), 2);
    elements.text(0x7fe00010, "OW", samples);
    const auto grid = readFile(dicomFile(elements));
    ASSERT_THAT(grid, test::IsOk());
    EXPECT_EQ(grid.value()->dims(), (GridDims{8, 6, 3}));
    EXPECT_EQ(grid.value()->geometry().spacing, glm::dvec3(0.5, 0.75, 2.0));
    EXPECT_EQ(grid.value()->type(), ScalarType::I32);
    for (int z = 0; z < 3; ++z)
        EXPECT_EQ(grid.value()->valueAt(0, 0, z), 100 + 2 * ((z + 1) % 3));
}

TEST(DicomFile, UnpacksTheFramesOfASegmentation) {
    auto elements = dicomSlice(0, 1);
    elements.text(0x00280008, "IS", "2").number(0x00280010, "US", 3).number(0x00280011, "US", 3);
    elements.number(0x00280100, "US", 1).number(0x00280101, "US", 1).number(0x00280102, "US", 0);
    elements.number(0x00280103, "US", 0).text(0x7fe00010, "OB", std::string("\xff\x01\x80\x00", 4)); // 9 ones, 0..., 1
    elements.text(0x00180088, "DS", "2");
    elements.text(0x7fe00010, "OB", std::string("\xff\x01\x02\x00", 4));
    const auto grid = readFile(dicomFile(elements));
    ASSERT_THAT(grid, test::IsOk());
    std::vector<int> expected(18, 0);
    std::fill_n(expected.begin(), 9, 1);
    expected[17] = 1;
    EXPECT_EQ(valuesOf(*grid.value()), expected);
    EXPECT_EQ(grid.value()->geometry().spacing.z, 2.0);
}

TEST(DicomFile, SaysWhatIsNotDone) {
    const test::TemporaryFolder folder;
    auto elements = dicomSlice(0, 1);
    elements.text(0x00280004, "CS", "MONOCHROME1").number(0x00280120, "SS", -2000);
    const auto source = openVolume(folder.write("slice", dicomFile(elements)));
    ASSERT_THAT(source, test::IsOk());
    EXPECT_THAT(source.value()->info().notes, Contains(HasSubstr("MONOCHROME1")));
    EXPECT_THAT(source.value()->info().notes, Contains(HasSubstr("-2000")));
}

// --- bad files
// ----------------------------------------------------------------------------------------------

struct BadDicom {
    const char* label;
    std::string bytes;
    const char* says;
};

void PrintTo(const BadDicom& bad, std::ostream* out) { *out << bad.label; } // NOLINT: GoogleTest's name

std::uint64_t peakRssBytes() {
    rusage usage{};
    ::getrusage(RUSAGE_SELF, &usage);
    return static_cast<std::uint64_t>(usage.ru_maxrss) << 10;
}

class BadDicomFile : public testing::TestWithParam<BadDicom> {};

TEST_P(BadDicomFile, IsRefusedSoonWithOneClearLine) {
    const test::TemporaryFolder folder;
    const auto path = folder.write("bad.dcm", GetParam().bytes);
    const std::uint64_t rssBefore = peakRssBytes();
    const auto begin = std::chrono::steady_clock::now();
    testing::internal::CaptureStderr();
    testing::internal::CaptureStdout();
    const auto grid = readVolume(path);
    EXPECT_EQ(testing::internal::GetCapturedStdout() + testing::internal::GetCapturedStderr(), "");
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - begin;
    ASSERT_FALSE(grid.isOk());
    EXPECT_THAT(grid.error().line(), HasSubstr(GetParam().says));
    EXPECT_THAT(grid.error().line(), testing::Not(HasSubstr("\n")));
    EXPECT_LT(elapsed.count(), 1.0);
    EXPECT_LT(peakRssBytes() - rssBefore, std::uint64_t{64} << 20);
}

std::string withNumber(std::uint32_t tag, double value) { return dicomFile(dicomSlice(0, 1).number(tag, "US", value)); }

std::string withFragments(const std::string& syntax, const std::vector<std::string>& fragments, int frames = 1) {
    auto elements = test::encapsulated(dicomSlice(0, 1), test::dicomFragments(fragments));
    return dicomFile(elements.text(0x00280008, "IS", std::to_string(frames)), syntax);
}

std::string jpeg2000Head(int columns, int rows, int codingBytes = 12) {
    const auto number = [](int value, int size) {
        return DicomElements::integer(static_cast<std::uint64_t>(value), size, true);
    };
    std::string all("\xff\x4f\xff\x51\0\x29\0\0", 8);
    for (const int value : {columns, rows, 0, 0, columns, rows, 0, 0})
        all += number(value, 4);
    all += std::string("\0\x01\x0f\x01\x01\xff\x52", 7) + number(codingBytes, 2) + std::string(10, '\1');
    return all + "\xff\x93" + std::string(20, 'x');
}

/// Segments of JPEG up to a scan of one component.
std::string jpegHead(char version) {
    std::string all("\xff\xd8\xff\xe0\0\x10JFIF\0", 11);
    all += version + std::string("\1\0\0\1\0\1\0\0", 8);
    all += std::string("\xff\xc3\0\x0b\x10\0\x06\0\x08\x01\1\x11\0", 13); // 8 x 6, lossless, 16 bits
    return all + std::string("\xff\xda\0\x08\1\1\0\1\0\0", 10) + std::string(20, 'x');
}

std::string nested(int depth) {
    std::string bytes;
    for (int i = 0; i < depth; ++i)
        bytes += DicomElements::tagBytes(0x52009229) + std::string("SQ\0\0\xff\xff\xff\xff", 8) +
                 DicomElements::tagBytes(0xfffee000) + std::string("\xff\xff\xff\xff", 4);
    return bytes;
}

const char* const kJpeg2000 = "1.2.840.10008.1.2.4.90";
const char* const kJpegLossless = "1.2.840.10008.1.2.4.70";

INSTANTIATE_TEST_SUITE_P(
    Dicom, BadDicomFile,
    testing::Values(
        BadDicom{"no DICOM", "hello, world", "is not DICOM"},
        BadDicom{"preamble only", std::string(128, '\0') + "DICM", "ends before its first element"},
        BadDicom{"samples cut by one byte",
                 dicomFile(dicomSlice(0, 1)).substr(0, dicomFile(dicomSlice(0, 1)).size() - 1),
                 "need 96 bytes, the file has 95"},
        BadDicom{"no samples", dicomFile(dicomSlice(0, 1).without(0x7fe00010)), "no pixel data"},
        BadDicom{"more rows than samples", withNumber(0x00280010, 60000), "need 960000 bytes"},
        BadDicom{"no rows", withNumber(0x00280010, 0), "rows, columns"},
        BadDicom{"20 bits", withNumber(0x00280100, 20), "bits allocated"},
        BadDicom{"17 bits stored", withNumber(0x00280101, 17), "bits stored"},
        BadDicom{"high bit", withNumber(0x00280102, 16), "bits stored"},
        BadDicom{"five components", withNumber(0x00280002, 5), "samples per pixel"},
        BadDicom{"a million frames", dicomFile(dicomSlice(0, 1).text(0x00280008, "IS", "1000000")), "number of frames"},
        BadDicom{"no frames", dicomFile(dicomSlice(0, 1).text(0x00280008, "IS", "-1")), "number of frames"},
        BadDicom{"more frames than samples", dicomFile(dicomSlice(0, 1).text(0x00280008, "IS", "60000")),
                 "need 5760000 bytes"},
        BadDicom{"an element of 4 GB",
                 dicomFile(dicomSlice(0, 1).text(0x00091001, "UN", "x").stating(0x00091001, 0xfffffff0)),
                 "element (0009,1001): its 4294967280 bytes"},
        BadDicom{"deep nesting", dicomFile(DicomElements()) + nested(1000), "deep"},
        BadDicom{"a sequence without end", dicomFile(DicomElements()) + nested(3), "does not end"},
        BadDicom{"a singular orientation", dicomFile(dicomSlice(0, 1).text(0x00200037, "DS", "1\\0\\0\\1\\0\\0")),
                 "image orientation"},
        BadDicom{"no spacing", dicomFile(dicomSlice(0, 1).text(0x00280030, "DS", "0\\0")), "spacing"},
        BadDicom{"an unknown syntax", withFragments("1.2.840.10008.1.2.4.100", {"video"}), "transfer syntax"},
        BadDicom{"no fragments", withFragments(test::kRunLength, {}), "0 fragments"},
        BadDicom{"more frames than fragments", withFragments(test::kRunLength, {plainRunLength()}, 60000), "60000"},
        BadDicom{
            "a fragment that leads out of the file",
            dicomFile(test::encapsulated(dicomSlice(0, 1), DicomElements::tagBytes(0xfffee000) + "\xf0\xff\xff\x7f"),
                      test::kRunLength),
            "does not lie within the file"},
        BadDicom{"run lengths too few", withFragments(test::kRunLength, {runLengthFrame({"\xff", "\x01"})}),
                 "RLE segment"},
        BadDicom{"run lengths cut",
                 withFragments(test::kRunLength, {runLengthFrame({std::string("\xd1\0", 2), literally("only a few")})}),
                 "RLE segment 1 ends early"},
        BadDicom{"one segment", withFragments(test::kRunLength, {runLengthFrame({"\xd1\x05"})}),
                 "2 RLE segments expected"},
        BadDicom{"a larger codestream", withFragments(kJpeg2000, {jpeg2000Head(8000, 6)}),
                 "is 8000 x 6 of 1 x 16 bits"},
        BadDicom{"a damaged codestream", withFragments(kJpeg2000, {jpeg2000Head(8, 6)}), "cannot be decompressed"},
        BadDicom{"a codestream of 100 bytes for 8 GB",
                 dicomFile(test::encapsulated(dicomSlice(0, 1), test::dicomFragments({jpeg2000Head(65535, 65535)}))
                               .number(0x00280010, "US", 65535)
                               .number(0x00280011, "US", 65535),
                           kJpeg2000),
                 "which cannot hold 8589672450 of samples"},
        BadDicom{"a codestream whose segment leads out of it", withFragments(kJpeg2000, {jpeg2000Head(8, 6, 5000)}),
                 "is not compressed as"},
        BadDicom{"JPEG of an unknown version", withFragments(kJpegLossless, {jpegHead('\x09')}),
                 "is not compressed as"},
        BadDicom{"JPEG without tables", withFragments(kJpegLossless, {jpegHead('\x01')}), "cannot be decompressed"},
        BadDicom{"an unknown photometric interpretation",
                 dicomFile(test::encapsulated(dicomSlice(0, 1), test::dicomFragments({jpegHead('\x01')}))
                               .text(0x00280004, "CS", "MONOCROM"),
                           kJpegLossless),
                 "cannot be decompressed"},
        BadDicom{"no codestream", withFragments(kJpeg2000, {"no JPEG at all"}), "is not compressed as"},
        BadDicom{"JPEG that is none", withFragments("1.2.840.10008.1.2.4.70", {"no JPEG at all"}),
                 "is not compressed as"}));

} // namespace
} // namespace isoslider::io
