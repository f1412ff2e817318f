#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/volume_io/volume_contents.h"
#include "core/volume_io/volume_reader.h"
#include "tests/support/result_matchers.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/core/volume_io/volume_bytes.h"

namespace isoslider::io {
namespace {

using test::replaced;
using testing::HasSubstr;

class MetaImageReader : public testing::Test {
protected:
    std::vector<int> samples(const std::string& bytes, const ReadOptions& options = {}) {
        const auto grid = readVolume(folder.write("a.mhd", bytes), options);
        EXPECT_THAT(grid, test::IsOk());
        if (!grid.isOk())
            return {};
        EXPECT_EQ(grid.value()->type(), ScalarType::I16);
        const auto values = grid.value()->values<std::int16_t>();
        return {values.begin(), values.end()};
    }
    std::string refusal(const std::string& bytes, const ReadOptions& options = {}) {
        const auto grid = readVolume(folder.write("a.mhd", bytes), options);
        return grid.isOk() ? "is read" : grid.error().message;
    }
    test::TemporaryFolder folder;
};

TEST_F(MetaImageReader, TakesOneChannel) {
    const std::string header =
        replaced(replaced(test::mhaHeader(), "NDims", "ElementNumberOfChannels = 3\nNDims"), "4 3 2", "2 1 1");
    const std::string bytes = header + test::ramp<std::int16_t>(6);
    EXPECT_EQ(refusal(bytes), "has 3 components: choose one with --component 0 to 2 or magnitude");
    EXPECT_EQ(samples(bytes, {.component = 2}), (std::vector<int>{2, 5}));
    const auto length = readVolume(folder / "a.mhd", {.component = kMagnitude});
    ASSERT_THAT(length, test::IsOk());
    EXPECT_EQ(length.value()->values<float>()[0], static_cast<float>(std::sqrt(5.0)));
}

TEST_F(MetaImageReader, IsOfAPatientWhereTheHeaderNamesDirections) {
    const auto isPatient = [&](const std::string& fields, const std::string& offset = "10 20 30") {
        const std::string header =
            replaced(replaced(test::mhaHeader(), "TransformMatrix = 1 0 0 0 1 0 0 0 1\n", fields), "10 20 30", offset);
        const std::string bytes = header + test::ramp<std::int16_t>(24);
        const auto source = openVolume(folder.write("a.mha", bytes));
        EXPECT_THAT(source, test::IsOk()) << bytes;
        return source.isOk() && source.value()->info().isPatientSpace;
    };
    const std::string matrix = "TransformMatrix = 0 1 0 1 0 0 0 0 1\n", code = "AnatomicalOrientation = ";
    EXPECT_FALSE(isPatient(""));
    EXPECT_FALSE(isPatient(matrix));
    EXPECT_TRUE(isPatient(code + "RAI\n"));
    EXPECT_TRUE(isPatient(matrix + code + "ASL\n"));
    EXPECT_TRUE(isPatient(matrix + code + "ASL\n", "0 0 0"));
    EXPECT_FALSE(isPatient(code + "RAI\n", "0 0 0")) << "as ITK writes where nobody has placed the image";
    EXPECT_FALSE(isPatient("TransformMatrix = 1 0 0 0 1 0 0 0 1\n" + code + "RAI\n", "0 0 0"));
    EXPECT_FALSE(isPatient(code + "LPS\n")) << "the axes are not turned to that";
    for (const char* none : {"???\n", "RRI\n", "RA\n", "RAIS\n", "unknown\n"})
        EXPECT_FALSE(isPatient(matrix + code + none)) << none;
}

TEST_F(MetaImageReader, TakesOneFrameOfFourDimensions) {
    const std::string bytes =
        "ObjectType = Image\nNDims = 4\nBinaryData = True\nElementNumberOfChannels = 2\n"
        "TransformMatrix = 0 1 0 0 1 0 0 0 0 0 1 0 0 0 0 1\nOffset = 1 2 3 4\nElementSpacing = 5 6 7 8\n"
        "DimSize = 2 1 1 3\nElementType = MET_SHORT\nElementDataFile = LOCAL\n" +
        test::ramp<std::int16_t>(12);
    EXPECT_THAT(refusal(bytes), HasSubstr("--frame 0 to 2"));
    EXPECT_EQ(samples(bytes, {.component = 1, .frame = 2}), (std::vector<int>{9, 11}));
    ReadOptions options;
    options.component = 0, options.frame = 0;
    const auto source = openVolume(folder / "a.mhd", options);
    ASSERT_THAT(source, test::IsOk());
    const GridGeometry& geometry = source.value()->info().geometry;
    EXPECT_EQ(geometry.spacing, glm::dvec3(5, 6, 7));
    EXPECT_EQ(geometry.origin, glm::dvec3(1, 2, 3));
    EXPECT_EQ(geometry.direction, glm::dmat3(0, 1, 0, 1, 0, 0, 0, 0, 1));
    const auto contents = listVolumes(folder / "a.mhd");
    ASSERT_THAT(contents, test::IsOk());
    EXPECT_EQ(contents.value().fields[0].frames, 3);
    EXPECT_EQ(contents.value().fields[0].components, 2);
    EXPECT_EQ(contents.value().fields[0].dims, (GridDims{2, 1, 1}));
}

TEST_F(MetaImageReader, KnowsEveryNameOfAPlace) {
    const auto open = [&](const std::string& fields) {
        folder.write("a.mhd", "NDims = 3\n" + fields +
                                  "DimSize = 2 2 2\nElementType = MET_SHORT\nElementDataFile = LOCAL\n" +
                                  test::ramp<std::int16_t>(8));
        const auto source = openVolume(folder / "a.mhd");
        EXPECT_THAT(source, test::IsOk()) << fields;
        return source.isOk() ? source.value()->info().geometry : GridGeometry{};
    };
    for (const std::string name : {"Offset", "Origin", "Position"})
        EXPECT_EQ(open(name + " = 1 2 3\n").origin, glm::dvec3(1, 2, 3)) << name;
    for (const std::string name : {"TransformMatrix", "Rotation", "Orientation"})
        EXPECT_EQ(open(name + " = 0 1 0 -1 0 0 0 0 1\n").direction, glm::dmat3(0, 1, 0, -1, 0, 0, 0, 0, 1)) << name;
    EXPECT_EQ(open("ElementSize = 4 5 6\n").spacing, glm::dvec3(4, 5, 6));
    EXPECT_EQ(open("ElementSize = 4 5 6\nElementSpacing = 1 2 3\n").spacing, glm::dvec3(1, 2, 3));
}

TEST_F(MetaImageReader, ReadsSlicesOfTwoDimensions) {
    const std::string bytes =
        "NDims = 2\nElementSpacing = 2 3\nDimSize = 4 3\nElementType = MET_SHORT\nElementDataFile = LOCAL\n" +
        test::ramp<std::int16_t>(12);
    EXPECT_EQ(samples(bytes)[11], 11);
    const auto source = openVolume(folder / "a.mhd");
    ASSERT_THAT(source, test::IsOk());
    EXPECT_EQ(source.value()->info().geometry.dims, (GridDims{4, 3, 1}));
    EXPECT_EQ(source.value()->info().geometry.spacing, glm::dvec3(2, 3, 1));
}

TEST_F(MetaImageReader, ReadsListsAndPatterns) {
    const std::string plain = test::ramp<std::int16_t>(24);
    folder.write("slice 1.raw", plain.substr(0, 24));
    folder.write("s02.raw", "head" + plain.substr(24));
    folder.write("s01.raw", "head" + plain.substr(0, 24));
    for (int i = 0; i < 6; ++i)
        folder.write("line" + std::to_string(i), plain.substr(static_cast<std::size_t>(i) * 8, 8));
    const std::string ends = "HeaderSize = -1\n";
    EXPECT_EQ(samples(ends + test::mhaHeader("LIST") + "slice 1.raw\ns02.raw\n")[23], 23);
    EXPECT_EQ(samples(ends + test::mhaHeader("LIST 2D") + "\nslice 1.raw\r\n\ns02.raw")[12], 12);
    EXPECT_EQ(samples("HeaderSize = 4\n" + test::mhaHeader("s%02d.raw 1 2 1"))[23], 23);
    EXPECT_EQ(samples(test::mhaHeader("LIST 1") + "line0\nline1\nline2\nline3\nline4\nline5\n")[23], 23);
    EXPECT_EQ(refusal(ends + test::mhaHeader("slice 1.raw")),
              "data ends early: the header asks for 48 bytes from byte 0, the file has 24 bytes");
    folder.write("whole file.raw", plain);
    EXPECT_EQ(samples(test::mhaHeader("whole file.raw"))[23], 23);
    folder.write("z1", test::packed(plain.substr(0, 24), 15));
    folder.write("z2", test::packed(plain.substr(24), 15));
    EXPECT_EQ(
        samples(replaced(test::mhaHeader("LIST"), "CompressedData = False", "CompressedData = True") + "z1\nz2\n")[23],
        23);
}

TEST_F(MetaImageReader, ReadsNumbersAsText) {
    const std::string header = replaced(test::mhaHeader(), "BinaryData = True", "BinaryData = False");
    std::string text;
    for (int i = 0; i < 24; ++i)
        text += std::to_string(i - 12) + (i % 4 == 3 ? "\n" : " ");
    EXPECT_EQ(samples(header + text)[23], 11);
    EXPECT_EQ(samples(header + text)[0], -12);
    folder.write("numbers.txt", text);
    EXPECT_EQ(samples(replaced(header, "LOCAL", "numbers.txt"))[0], -12);
    EXPECT_THAT(refusal(header + text + "7"), HasSubstr("more than"));
    EXPECT_EQ(refusal(header + text + "7", {.allowsTrailing = true}), "is read");
    EXPECT_THAT(refusal(replaced(header, "CompressedData = False", "CompressedData = True") + text),
                HasSubstr("BinaryData"));
}

TEST_F(MetaImageReader, AppliesSlopeAndOffset) {
    const auto with = [&](const std::string& fields) {
        return openVolume(folder.write("a.mhd", replaced(test::mhaHeader(), "NDims", fields + "NDims") +
                                                    test::ramp<std::int16_t>(24)));
    };
    auto source = with("ElementToIntensityFunctionSlope = 0.5\nElementToIntensityFunctionOffset = -3\n");
    ASSERT_THAT(source, test::IsOk());
    ASSERT_EQ(source.value()->info().notes.size(), 1u);
    EXPECT_EQ(source.value()->info().notes[0], "samples are the stored values times 0.5 plus -3, as "
                                               "ElementToIntensityFunctionSlope and Offset state");
    const auto grid = readVolume(folder / "a.mhd");
    ASSERT_THAT(grid, test::IsOk());
    ASSERT_EQ(grid.value()->type(), ScalarType::F32);
    EXPECT_EQ(grid.value()->values<float>()[23], 8.5F);
    source = with("ElementToIntensityFunctionSlope = 1\nElementToIntensityFunctionOffset = 0\n");
    ASSERT_THAT(source, test::IsOk());
    EXPECT_TRUE(source.value()->info().notes.empty());
    EXPECT_EQ(source.value()->info().type, ScalarType::I16);
    for (const char* fields : {"ElementToIntensityFunctionSlope = 0\n", "ElementToIntensityFunctionSlope = two\n",
                               "ElementToIntensityFunctionOffset = nan\n"}) {
        source = with(fields);
        ASSERT_THAT(source, test::IsOk());
        EXPECT_EQ(source.value()->info().type, ScalarType::I16);
        ASSERT_EQ(source.value()->info().notes.size(), 1u) << fields;
        EXPECT_THAT(source.value()->info().notes[0], HasSubstr("is ignored"));
    }
}

TEST_F(MetaImageReader, B053_LetsBytesBehindPackedSamplesPassWhenAllowed) {
    const std::string header = replaced(test::mhaHeader(), "CompressedData = False", "CompressedData = True");
    EXPECT_EQ(samples(header + test::packed(test::ramp<std::int16_t>(24), 15))[23], 23); // no size given
    const std::string longer = header + test::packed(test::ramp<std::int16_t>(25), 15);
    EXPECT_THAT(refusal(longer), HasSubstr("trailing bytes have to be allowed"));
    EXPECT_EQ(samples(longer, {.allowsTrailing = true})[23], 23);
}

} // namespace
} // namespace isoslider::io
