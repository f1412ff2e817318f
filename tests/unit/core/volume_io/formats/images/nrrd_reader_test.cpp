#include <cmath>
#include <sstream>

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

std::string encoded(const std::string& encoding, const std::string& body) {
    return replaced(test::nrrdHeader(), "encoding: raw", "encoding: " + encoding) + "\n" + body;
}

/// A header of any number of axes; samples are i16.
std::string headerOf(const std::string& sizes, const std::string& more) {
    std::size_t dimension = 1;
    for (const char c : sizes)
        dimension += c == ' ' ? 1 : 0;
    return "NRRD0005\ntype: int16\ndimension: " + std::to_string(dimension) + "\nsizes: " + sizes +
           "\nendian: little\nencoding: raw\n" + more;
}

std::string hexDigits(const std::string& bytes) {
    std::string text;
    for (const char c : bytes) {
        const auto value = static_cast<unsigned char>(c);
        text += "0123456789abcdef"[value >> 4];
        text += "0123456789ABCDEF"[value & 15];
        text += text.size() % 9 == 8 ? "\n" : "";
    }
    return text;
}

class NrrdReader : public testing::Test {
protected:
    Result<std::shared_ptr<const ScalarGrid>> read(const std::string& bytes, const ReadOptions& options = {}) {
        return readVolume(folder.write("a.nrrd", bytes), options);
    }
    std::vector<int> samples(const std::string& bytes, const ReadOptions& options = {}) {
        const auto grid = read(bytes, options);
        EXPECT_THAT(grid, test::IsOk());
        if (!grid.isOk())
            return {};
        const auto values = grid.value()->values<std::int16_t>();
        return {values.begin(), values.end()};
    }
    std::string refusal(const std::string& bytes, const ReadOptions& options = {}) {
        const auto grid = read(bytes, options);
        return grid.isOk() ? "is read" : grid.error().message;
    }
    test::TemporaryFolder folder;
};

TEST_F(NrrdReader, TakesInterleavedComponents) {
    const std::string bytes =
        headerOf("3 2 1 1", "kinds: RGB-color domain domain domain\n\n") + test::ramp<std::int16_t>(6);
    EXPECT_EQ(refusal(bytes), "has 3 components (red, green, blue): choose one with --component 0 to 2 or magnitude");
    EXPECT_EQ(samples(bytes, {.component = 1}), (std::vector<int>{1, 4}));
    EXPECT_THAT(refusal(bytes, {.component = 3}), HasSubstr("--component 3"));
    EXPECT_THAT(refusal(bytes, {.component = 0, .frame = 1}), HasSubstr("--frame 1"));
    const auto length = read(bytes, {.component = kMagnitude});
    ASSERT_THAT(length, test::IsOk());
    EXPECT_EQ(length.value()->values<float>()[1], static_cast<float>(std::sqrt(9.0 + 16 + 25)));
}

TEST_F(NrrdReader, TakesComponentsOfAnyAxis) {
    // The value of a sample is its place in the file: axis lengths 2, 3 (components), 2, 2.
    for (const char* names :
         {"kinds: domain vector domain domain\n\n", "space: LPS\nspace directions: (1,0,0) none (0,1,0) (0,0,1)\n\n"}) {
        const std::string bytes = headerOf("2 3 2 2", names) + test::ramp<std::int16_t>(24);
        EXPECT_THAT(refusal(bytes), HasSubstr("has 3 components"));
        EXPECT_EQ(samples(bytes, {.component = 1}), (std::vector<int>{2, 3, 8, 9, 14, 15, 20, 21}));
        const auto length = read(bytes, {.component = kMagnitude});
        ASSERT_THAT(length, test::IsOk());
        EXPECT_EQ(length.value()->dims(), (GridDims{2, 2, 2}));
        EXPECT_EQ(length.value()->values<float>()[3], static_cast<float>(std::sqrt(49.0 + 81 + 121)));
    }
    const std::string last =
        headerOf("2 2 1 3", "kinds: domain domain domain 3-vector\n\n") + test::ramp<std::int16_t>(12);
    EXPECT_EQ(samples(last, {.component = 2}), (std::vector<int>{8, 9, 10, 11}));
}

TEST_F(NrrdReader, TakesFramesAndComponentsTogether) {
    const std::string bytes =
        headerOf("2 2 1 1 3", "kinds: complex domain domain domain time\n\n") + test::ramp<std::int16_t>(12);
    EXPECT_EQ(
        refusal(bytes),
        "has 2 components (real, imaginary) and 3 frames: choose with --component 0 to 1 or magnitude, and --frame 0 to 2");
    EXPECT_EQ(samples(bytes, {.component = 1, .frame = 2}), (std::vector<int>{9, 11}));
    const auto contents = listVolumes(folder.write("l.nrrd", bytes));
    ASSERT_THAT(contents, test::IsOk());
    const VolumeField& field = contents.value().fields[0];
    EXPECT_EQ(field.dims, (GridDims{2, 1, 1}));
    EXPECT_EQ(field.components, 2);
    EXPECT_EQ(field.frames, 3);
    EXPECT_EQ(field.typeName, "int16");
    EXPECT_EQ(field.componentNames, (std::vector<std::string>{"real", "imaginary"}));
}

TEST_F(NrrdReader, KnowsSeriesByWhateverSaysSo) {
    for (
        const char* names :
        {"\n", "kinds: domain domain domain list\n\n", "spacings: 1 1 1 nan\n\n",
         "space: left-posterior-superior-time\nspace directions: (1,0,0,0) (0,1,0,0) (0,0,1,0) (0,0,0,5)\nspace origin: (7,8,9,0)\n\n"}) {
        const std::string bytes = headerOf("2 1 1 3", names) + test::ramp<std::int16_t>(6);
        EXPECT_EQ(refusal(bytes), "has 3 frames: choose one with --frame 0 to 2") << names;
        EXPECT_EQ(samples(bytes, {.frame = 1}), (std::vector<int>{2, 3}));
    }
    // A series may be the fastest axis too.
    EXPECT_EQ(samples(headerOf("3 2 1 1", "kinds: time domain domain domain\n\n") + test::ramp<std::int16_t>(6),
                      {.frame = 2}),
              (std::vector<int>{2, 5}));
    EXPECT_THAT(refusal(headerOf("2 1 1 3 2", "\n") + test::ramp<std::int16_t>(12)),
                HasSubstr("several axes of frames"));
    EXPECT_THAT(refusal(headerOf("2", "kinds: vector\n\n") + test::ramp<std::int16_t>(2)), HasSubstr("kinds"));
}

TEST_F(NrrdReader, KeepsThePlaceOfSpatialAxes) {
    const std::string space = "space: right-anterior-superior\nspace origin: (1,2,3)\n";
    const auto open = [&](const std::string& bytes) {
        ReadOptions options;
        options.component = 0;
        const auto source = openVolume(folder.write("a.nrrd", bytes), options);
        EXPECT_THAT(source, test::IsOk());
        return source.isOk() ? source.value()->info().geometry : GridGeometry{};
    };
    const GridGeometry g = open(headerOf("3 2 2 2", space + "space directions: none (0,2,0) (0,0,3) (4,0,0)\n\n") +
                                test::ramp<std::int16_t>(24));
    EXPECT_EQ(g.spacing, glm::dvec3(2, 3, 4));
    EXPECT_EQ(g.origin, glm::dvec3(-1, -2, 3)); // in left-posterior-superior
    EXPECT_EQ(g.direction, glm::dmat3(0, -1, 0, 0, 0, 1, -1, 0, 0));
    // A slice in space: the third axis stands on it.
    const GridGeometry slice =
        open(headerOf("2 2", space + "space directions: (0,2,0) (0,0,3)\n\n") + test::ramp<std::int16_t>(4));
    EXPECT_EQ(slice.dims, (GridDims{2, 2, 1}));
    EXPECT_EQ(slice.direction[1], glm::dvec3(0, 0, 1));
    EXPECT_NEAR(std::abs(slice.direction[2].x), 1.0, 1e-12);
}

TEST_F(NrrdReader, TurnsEveryNamedSpaceIntoOneOrientation) {
    bool isPatient = false;
    const auto open = [&](const std::string& fields) {
        const auto source =
            openVolume(folder.write("a.nrrd", headerOf("2 2 2", fields + "\n") + test::ramp<std::int16_t>(8)));
        EXPECT_THAT(source, test::IsOk()) << fields;
        isPatient = source.isOk() && source.value()->info().isPatientSpace;
        return source.isOk() ? source.value()->info().geometry : GridGeometry{};
    };
    const std::string place = "\nspace directions: (2,0,0) (0,3,0) (0,0,4)\nspace origin: (5,6,7)\n";
    struct Case {
        const char* space;
        glm::dvec3 signs;
    };
    for (const Case& named : {Case{"space: RAS", {-1, -1, 1}}, Case{"space: right-anterior-superior", {-1, -1, 1}},
                              Case{"space: LAS", {1, -1, 1}}, Case{"space: Left-Anterior-Superior", {1, -1, 1}},
                              Case{"space: LPS", {1, 1, 1}}, Case{"space: scanner-xyz", {1, 1, 1}},
                              Case{"space: 3D-left-handed", {1, 1, 1}}, Case{"space dimension: 3", {1, 1, 1}}}) {
        const GridGeometry g = open(named.space + place);
        EXPECT_EQ(g.spacing, glm::dvec3(2, 3, 4)) << named.space;
        const std::string_view name(named.space);
        EXPECT_EQ(isPatient, name.find("3") == name.npos && name.find("scanner") == name.npos) << named.space;
        EXPECT_EQ(g.origin, glm::dvec3(5, 6, 7) * named.signs) << named.space;
        for (int axis = 0; axis < 3; ++axis)
            EXPECT_EQ(g.direction[axis][axis], named.signs[axis]) << named.space;
    }
    EXPECT_EQ(open("space: RAS\nspace origin: (1,2,3)\n").origin, glm::dvec3(-1, -2, 3));
    EXPECT_FALSE(isPatient) << "without directions";
    const auto bytes = [&](const std::string& fields) {
        return headerOf("2 2 2", fields + "\n") + test::ramp<std::int16_t>(8);
    };
    EXPECT_THAT(refusal(bytes("space: somewhere" + place)), HasSubstr("space: 'somewhere'"));
    EXPECT_THAT(refusal(bytes("space dimension: 2" + place)), HasSubstr("space origin: a vector of 2 numbers"));
    EXPECT_THAT(refusal(bytes("space dimension: 2\nspace directions: (2,0,0) (0,3,0) (0,0,4)\n")),
                HasSubstr("space directions: vectors of 2 numbers"));
    EXPECT_THAT(refusal(bytes("space directions: (2,0,0) (0,3,0) (0,0,4)\n")), HasSubstr("need a space"));
    EXPECT_THAT(refusal(bytes("space: RAS\nspace origin: (1,2)\n")), HasSubstr("space origin"));
}

TEST_F(NrrdReader, PutsPerpendicularAxesOnALine) {
    const auto source = openVolume(folder.write("a.nrrd", headerOf("4", "space: LPS\nspace directions: (0,2,0)\n\n") +
                                                              test::ramp<std::int16_t>(4)));
    ASSERT_THAT(source, test::IsOk());
    const glm::dmat3& direction = source.value()->info().geometry.direction;
    EXPECT_EQ(direction[0], glm::dvec3(0, 1, 0));
    EXPECT_DOUBLE_EQ(glm::determinant(direction), 1.0);
    EXPECT_EQ(glm::transpose(direction) * direction, glm::dmat3(1.0));
}

TEST_F(NrrdReader, TakesTheSpacingFromTheExtentOfAnAxis) {
    const auto open = [&](const std::string& fields) {
        const auto source =
            openVolume(folder.write("a.nrrd", headerOf("3 2 5", fields + "\n") + test::ramp<std::int16_t>(30)));
        EXPECT_THAT(source, test::IsOk());
        return source.isOk() ? source.value()->info() : VolumeInfo{};
    };
    const GridGeometry nodes = open("axis mins: 1 -1 0\naxis maxs: 2 1 10\n").geometry;
    EXPECT_EQ(nodes.spacing, glm::dvec3(0.5, 2, 2.5));
    EXPECT_EQ(nodes.origin, glm::dvec3(1, -1, 0));
    const GridGeometry cells = open("centers: cell cell cell\naxismins: 0 0 0\naxismaxs: 3 4 10\n").geometry;
    EXPECT_EQ(cells.spacing, glm::dvec3(1, 2, 2));
    EXPECT_EQ(cells.origin, glm::dvec3(0.5, 1, 1));
    // A spacing of its own goes first; what gives none is noted.
    EXPECT_EQ(open("spacings: 7 8 9\naxis mins: 0 0 0\naxis maxs: 1 1 1\n").geometry.spacing, glm::dvec3(7, 8, 9));
    EXPECT_THAT(open("axis mins: 0 0 0\naxis maxs: 1 0 1\n").notes,
                testing::Contains(HasSubstr("spacing: 1 is taken")));
}

TEST_F(NrrdReader, DecodesTextHexAndBzip2) {
    std::string text;
    for (int i = 0; i < 24; ++i)
        text += std::to_string(i) + (i % 3 == 0 ? ", " : i % 3 == 1 ? " , " : "\n");
    const std::string plain = test::ramp<std::int16_t>(24);
    std::vector<int> expected(24);
    for (int i = 0; i < 24; ++i)
        expected[static_cast<std::size_t>(i)] = i;
    for (const char* name : {"ascii", "text", "TXT"})
        EXPECT_EQ(samples(replaced(encoded(name, text), "endian: little\n", "")), expected) << name;
    EXPECT_EQ(samples(encoded("hex", hexDigits(plain) + "\n")), expected);
    EXPECT_EQ(samples(encoded("bzip2", test::bzipped(plain))), expected);
    EXPECT_EQ(samples(encoded("bz2", test::bzipped(plain.substr(0, 17)) + test::bzipped(plain.substr(17)))), expected);
    // Big-endian digits; text has no byte order.
    EXPECT_EQ(samples(replaced(encoded("hex", hexDigits(test::bigEndian16(24))), "endian: little", "endian: big")),
              expected);
    EXPECT_EQ(samples(replaced(encoded("ascii", text), "endian: little", "endian: big")), expected);
}

TEST_F(NrrdReader, ReadsEveryTypeOfText) {
    struct Case {
        const char* type;
        const char* numbers;
        double first, second;
    };
    const Case cases[] = {{"uchar", "0 255", 0, 255},
                          {"signed char", "-128 127", -128, 127},
                          {"ushort", "+7 65535", 7, 65535},
                          {"int", "-2147483648 2147483647", -2147483648.0, 2147483647.0},
                          {"uint", "0 4294967295", 0, 4294967295.0},
                          {"longlong", "-9007199254740992 1", -9007199254740992.0, 1},
                          {"ulonglong", "0 9007199254740992", 0, 9007199254740992.0},
                          {"float", "0.1 -1e-45", 0.1f, -1e-45f},
                          {"double", "0.1 4.9e-324", 0.1, 4.9e-324}};
    for (const Case& c : cases) {
        const auto grid = read("NRRD0001\ntype: " + std::string(c.type) +
                               "\ndimension: 1\nsizes: 2\nencoding: ascii\n\n" + c.numbers + "\n");
        ASSERT_THAT(grid, test::IsOk()) << c.type;
        EXPECT_EQ(grid.value()->valueAt(0, 0, 0), c.first) << c.type;
        EXPECT_EQ(grid.value()->valueAt(1, 0, 0), c.second) << c.type;
    }
    const auto outside = [&](const char* type, const char* numbers) {
        return refusal("NRRD0001\ntype: " + std::string(type) + "\ndimension: 1\nsizes: 2\nencoding: ascii\n\n" +
                       numbers + "\n");
    };
    EXPECT_THAT(outside("uchar", "1 256"), HasSubstr("sample 1"));
    EXPECT_THAT(outside("uchar", "-1 25"), HasSubstr("sample 0"));
    EXPECT_THAT(outside("float", "1 1e39"), HasSubstr("sample 1"));
    EXPECT_THAT(outside("double", "1 1e999"), HasSubstr("sample 1"));
    EXPECT_THAT(outside("longlong", "9007199254740993 1"), HasSubstr("no exact value"));
}

TEST_F(NrrdReader, ReadsListsOfFilesOfAnyEncoding) {
    const std::string plain = test::ramp<std::int16_t>(24);
    folder.write("1.gz", test::gzipped(plain.substr(0, 24)));
    folder.write("2.gz", test::gzipped(plain.substr(24)));
    folder.write("line1.raw", plain.substr(0, 8));
    for (int i = 1; i < 6; ++i)
        folder.write("line" + std::to_string(i + 1) + ".raw", plain.substr(static_cast<std::size_t>(i) * 8, 8));
    const auto packed = replaced(test::nrrdHeader(), "encoding: raw", "encoding: gzip");
    EXPECT_EQ(samples(packed + "data file: LIST\n1.gz\n2.gz\n")[23], 23);
    EXPECT_EQ(samples(packed + "data file: LIST 2\n1.gz\n2.gz\n")[12], 12);
    EXPECT_EQ(samples(packed + "data file: LIST 3\n1.gz\n2.gz\n")[12], 12); // slabs
    EXPECT_EQ(samples(packed + "data file: %d.gz 1 2 1\n")[23], 23);
    EXPECT_EQ(samples(test::nrrdHeader() + "data file: line%d.raw 1 6 1 1\n")[23], 23);
    // Slices against their order.
    auto source = openVolume(folder.write("a.nhdr", packed + "data file: %d.gz 2 1 -1\n"));
    ASSERT_THAT(source, test::IsOk());
    std::vector<std::byte> plane(24);
    for (const std::int64_t z : {1, 0, 1}) {
        ASSERT_THAT(source.value()->readSlab(z, z + 1, plane), test::IsOk());
        EXPECT_EQ(std::to_integer<int>(plane[0]), z == 0 ? 12 : 0);
    }
    // A damaged second file is found when it is read.
    folder.write("2.gz", test::gzipped(plain.substr(24) + "x"));
    EXPECT_THAT(refusal(packed + "data file: LIST\n1.gz\n2.gz\n"), HasSubstr("more than"));
    EXPECT_EQ(refusal(packed + "data file: LIST\n1.gz\n2.gz\n", {.allowsTrailing = true}), "is read");
}

TEST_F(NrrdReader, B044_KeepsSpacingsOfAnySize) {
    for (const double spacing : {1e300, 1e-300}) {
        std::ostringstream text;
        text << "spacings: " << spacing << " 1 1\n\n";
        const auto source =
            openVolume(folder.write("a.nrrd", headerOf("4 3 2", text.str()) + test::ramp<std::int16_t>(24)));
        ASSERT_THAT(source, test::IsOk());
        EXPECT_EQ(source.value()->info().geometry.spacing, glm::dvec3(spacing, 1, 1));
    }
}

TEST_F(NrrdReader, B041_ReadsPackedVolumesBeyondFourGigabytes) {
    // One stream of 4 GiB, so that no counter of 31 or 32 bits is enough for it, and another of 64 MiB.
    const std::string header = "NRRD0005\ntype: uchar\ndimension: 3\nsizes: 8192 8192 65\nencoding: gzip\n\n";
    const std::string bytes = header + test::gzippedRepeats(std::string(std::size_t{64} << 20, '\3'), 64) +
                              test::gzipped(std::string(std::size_t{64} << 20, '\7'));
    auto source = openVolume(folder.write("a.nrrd", bytes));
    ASSERT_THAT(source, test::IsOk());
    std::vector<std::byte> plane(std::size_t{64} << 20);
    // The bytes at 2^31 and at 2^32, and those behind them.
    for (const auto& [z, value] : {std::pair(32, 3), std::pair(64, 7)}) {
        ASSERT_THAT(source.value()->readSlab(z, z + 1, plane), test::IsOk());
        EXPECT_EQ(std::to_integer<int>(plane.front()), value);
        EXPECT_EQ(std::to_integer<int>(plane.back()), value);
    }
}

} // namespace
} // namespace isoslider::io
