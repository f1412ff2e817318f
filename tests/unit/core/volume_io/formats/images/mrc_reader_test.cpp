#include <algorithm>
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

using test::put;
using testing::HasSubstr;

void word(std::string& header, std::size_t number, std::int32_t value) { put(header, 4 * (number - 1), value); }
void real(std::string& header, std::size_t number, float value) { put(header, 4 * (number - 1), value); }

/// 4 x 3 x 2 samples of `mode`, steps 1 2 3, the first at 10 20 30.
std::string mrcHeader(std::int32_t mode) {
    std::string h(1024, '\0');
    const std::int32_t size[3] = {4, 3, 2};
    const float cell[6] = {4, 6, 6, 90, 90, 90}, origin[3] = {10, 20, 30};
    for (std::size_t i = 0; i < 3; ++i) {
        word(h, 1 + i, size[i]);
        word(h, 8 + i, size[i]);
        word(h, 17 + i, static_cast<std::int32_t>(i) + 1);
        real(h, 11 + i, cell[i]);
        real(h, 14 + i, cell[i + 3]);
        real(h, 50 + i, origin[i]);
    }
    word(h, 4, mode);
    word(h, 23, 1);
    std::memcpy(h.data() + 208, "MAP DD", 6);
    return h;
}

std::string swapped(std::string bytes, std::size_t size) {
    for (std::size_t at = 0; at + size <= bytes.size(); at += size)
        std::reverse(bytes.begin() + static_cast<std::ptrdiff_t>(at),
                     bytes.begin() + static_cast<std::ptrdiff_t>(at + size));
    return bytes;
}

class MrcReader : public testing::Test {
protected:
    Result<std::shared_ptr<const ScalarGrid>> read(const std::string& bytes, const ReadOptions& options = {},
                                                   const char* name = "a.mrc") {
        return readVolume(folder.write(name, bytes), options);
    }
    std::string refusal(const std::string& bytes, const ReadOptions& options = {}, const char* name = "a.mrc") {
        const auto grid = read(bytes, options, name);
        return grid.isOk() ? "is read" : grid.error().message;
    }
    GridGeometry geometry(const std::string& header) {
        const auto source = openVolume(folder.write("g.mrc", header + test::ramp<float>(24)));
        EXPECT_THAT(source, test::IsOk());
        return source.isOk() ? source.value()->info().geometry : GridGeometry{};
    }
    test::TemporaryFolder folder;
};

TEST_F(MrcReader, ReadsEveryModeOfScalars) {
    struct Case {
        std::int32_t mode;
        std::string samples;
        ScalarType type;
    };
    std::string halves(48, '\0');
    for (std::size_t i = 0; i < 24; ++i) // 2^(i - 12)
        put<std::uint16_t>(halves, 2 * i, static_cast<std::uint16_t>((i + 3) << 10));
    const Case cases[] = {{0, test::ramp<std::int8_t>(24), ScalarType::I8},
                          {1, test::ramp<std::int16_t>(24), ScalarType::I16},
                          {2, test::ramp<float>(24), ScalarType::F32},
                          {6, test::ramp<std::uint16_t>(24), ScalarType::U16},
                          {12, halves, ScalarType::F32}};
    for (const Case& c : cases) {
        const auto grid = read(mrcHeader(c.mode) + c.samples);
        ASSERT_THAT(grid, test::IsOk());
        EXPECT_EQ(grid.value()->type(), c.type);
        EXPECT_EQ(grid.value()->dims(), (GridDims{4, 3, 2}));
        EXPECT_EQ(grid.value()->geometry().spacing, glm::dvec3(1, 2, 3));
        EXPECT_EQ(grid.value()->geometry().origin, glm::dvec3(10, 20, 30));
        EXPECT_EQ(grid.value()->valueAt(3, 2, 1), c.mode == 12 ? 2048.0 : 23.0);
        EXPECT_EQ(grid.value()->valueAt(0, 0, 0), c.mode == 12 ? std::ldexp(1.0, -12) : 0.0);
    }
}

TEST_F(MrcReader, ReadsHalvesThatAreSmallOrNoNumbers) {
    std::string samples(48, '\0');
    const std::uint16_t bits[] = {0x0001, 0x8000, 0x7c00, 0xfc00, 0x7e00, 0xc000};
    std::memcpy(samples.data(), bits, sizeof bits);
    const auto grid = read(mrcHeader(12) + samples);
    ASSERT_THAT(grid, test::IsOk());
    const auto values = grid.value()->values<float>();
    EXPECT_EQ(values[0], std::ldexp(1.0f, -24));
    EXPECT_TRUE(std::signbit(values[1]) && values[1] == 0.0f);
    EXPECT_TRUE(std::isinf(values[2]) && values[2] > 0);
    EXPECT_TRUE(std::isinf(values[3]) && values[3] < 0);
    EXPECT_TRUE(std::isnan(values[4]));
    EXPECT_EQ(values[5], -2.0f);
}

TEST_F(MrcReader, ReadsEitherByteOrderWhateverTheStampSays) {
    std::string header = swapped(mrcHeader(1), 4);
    for (const char* stamp : {"\x11\x11", "DD"}) {
        std::memcpy(header.data() + 208, "MAP ", 4);
        std::memcpy(header.data() + 212, stamp, 2);
        const auto grid = read(header + test::bigEndian16(24));
        ASSERT_THAT(grid, test::IsOk());
        EXPECT_EQ(grid.value()->valueAt(3, 2, 1), 23.0);
    }
}

TEST_F(MrcReader, KnowsBytesWithoutSign) {
    std::string header = mrcHeader(0);
    word(header, 39, 1146047817); // "IMOD"
    const auto grid = read(header + std::string(24, '\xff'));
    ASSERT_THAT(grid, test::IsOk());
    EXPECT_EQ(grid.value()->type(), ScalarType::U8);
    EXPECT_EQ(grid.value()->valueAt(0, 0, 0), 255.0);
}

TEST_F(MrcReader, SkipsSymmetryAndReadsPackedFiles) {
    std::string header = mrcHeader(2);
    word(header, 24, 160);
    const std::string whole = header + std::string(160, 's') + test::ramp<float>(24);
    for (const char* name : {"a.mrc", "a.CCP4", "a.map", "a.rec", "a.st", "noname"})
        EXPECT_THAT(read(whole, {}, name), test::IsOk()) << name;
    for (const char* name : {"a.mrc.gz", "a.map.gz", "a.ccp4.gz"}) {
        const auto grid = read(test::gzipped(whole), {}, name);
        ASSERT_THAT(grid, test::IsOk()) << name;
        EXPECT_EQ(grid.value()->valueAt(3, 2, 1), 23.0);
    }
}

TEST_F(MrcReader, PlacesAxesInAnyOrder) {
    std::string header = mrcHeader(2);
    const std::int32_t axes[3] = {3, 1, 2}; // columns along z, rows along x, sections along y
    const std::int32_t intervals[3] = {3, 2, 4}, start[3] = {5, 6, 7};
    const float cell[3] = {6, 6, 4}; // steps 2 3 1
    for (std::size_t i = 0; i < 3; ++i) {
        word(header, 17 + i, axes[i]);
        word(header, 8 + i, intervals[i]);
        real(header, 11 + i, cell[i]);
        word(header, 5 + i, start[i]);
        real(header, 50 + i, 0.0f);
    }
    const GridGeometry g = geometry(header);
    EXPECT_EQ(g.dims, (GridDims{4, 3, 2}));
    EXPECT_EQ(g.spacing, glm::dvec3(1, 2, 3));
    EXPECT_EQ(g.direction, glm::dmat3(0, 0, 1, 1, 0, 0, 0, 1, 0));
    EXPECT_EQ(g.origin, glm::dvec3(6 * 2, 7 * 3, 5 * 1)); // starts are in the order of columns, rows, sections
    word(header, 17, 1);
    EXPECT_THAT(refusal(header + test::ramp<float>(24)), HasSubstr("mapc"));
}

TEST_F(MrcReader, KeepsAnObliqueCell) {
    std::string header = mrcHeader(2);
    real(header, 14, 80), real(header, 15, 95), real(header, 16, 120);
    const GridGeometry g = geometry(header);
    const auto cosine = [&](int i, int j) { return glm::dot(g.direction[i], g.direction[j]); };
    EXPECT_NEAR(cosine(1, 2), std::cos(80 * M_PI / 180), 1e-7);
    EXPECT_NEAR(cosine(0, 2), std::cos(95 * M_PI / 180), 1e-7);
    EXPECT_NEAR(cosine(0, 1), std::cos(120 * M_PI / 180), 1e-7);
    for (int axis = 0; axis < 3; ++axis)
        EXPECT_NEAR(g.spacing[axis], axis + 1, 1e-12);
    EXPECT_EQ(g.direction[0], glm::dvec3(1, 0, 0));
    real(header, 16, 180);
    EXPECT_THAT(refusal(header + test::ramp<float>(24)), HasSubstr("cell"));
}

TEST_F(MrcReader, AsksForVolumeAndComponent) {
    std::string header = mrcHeader(1);
    word(header, 23, 401);
    word(header, 10, 1); // one section a volume
    const std::string stack = header + test::ramp<std::int16_t>(24);
    EXPECT_EQ(refusal(stack), "has 2 frames: choose one with --frame 0 to 1");
    const auto second = read(stack, {.frame = 1});
    ASSERT_THAT(second, test::IsOk());
    EXPECT_EQ(second.value()->dims(), (GridDims{4, 3, 1}));
    EXPECT_EQ(second.value()->valueAt(0, 0, 0), 12.0);
    word(header, 10, 3);
    EXPECT_THAT(refusal(header + test::ramp<std::int16_t>(24)), HasSubstr("mz"));

    const std::string complex = mrcHeader(4) + test::ramp<float>(48);
    EXPECT_THAT(refusal(complex), HasSubstr("2 components (real, imaginary)"));
    const auto imaginary = read(complex, {.component = 1});
    ASSERT_THAT(imaginary, test::IsOk());
    EXPECT_EQ(imaginary.value()->valueAt(1, 0, 0), 3.0);
    const auto contents = listVolumes(folder.write("c.mrc", complex));
    ASSERT_THAT(contents, test::IsOk());
    EXPECT_EQ(contents.value().fields[0].typeName, "complex64");
}

TEST_F(MrcReader, RefusesWhatIsNone) {
    const std::string good = mrcHeader(2) + test::ramp<float>(24);
    EXPECT_THAT(refusal(good.substr(0, good.size() - 1)), HasSubstr("96 bytes"));
    EXPECT_THAT(refusal(good.substr(0, 1000)), HasSubstr("1024"));
    EXPECT_THAT(refusal(test::gzipped(good.substr(0, 1100)), {}, "a.mrc.gz"), HasSubstr("1120 expected"));
    const auto with = [&](std::size_t number, std::int32_t value) {
        std::string bytes = good;
        word(bytes, number, value);
        return refusal(bytes);
    };
    EXPECT_THAT(with(1, -4), HasSubstr("nx"));
    EXPECT_THAT(with(1, 0), HasSubstr("nx"));
    EXPECT_THAT(with(3, 1'000'000), HasSubstr("48000000 bytes"));
    EXPECT_THAT(with(4, 101), HasSubstr("mode"));
    EXPECT_THAT(with(24, -1), HasSubstr("nsymbt"));
    EXPECT_THAT(with(24, 2'000'000'000), HasSubstr("ends early"));
    EXPECT_THAT(with(11, 0x7fc00000), HasSubstr("cell")); // NaN
    EXPECT_EQ(with(8, 0), "is read"); // a note states what is assumed
    EXPECT_EQ(refusal(good + "x"), "is read");
}

} // namespace
} // namespace isoslider::io
