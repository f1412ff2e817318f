#include <cmath>
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

using test::TemporaryFolder;
using testing::HasSubstr;

void setDims(std::string& header, std::initializer_list<std::int16_t> sizes) {
    test::put<std::int16_t>(header, 40, static_cast<std::int16_t>(sizes.size()));
    std::size_t at = 42;
    for (const std::int16_t size : sizes) {
        test::put(header, at, size);
        at += 2;
    }
}
void setType(std::string& header, std::int16_t code, std::int16_t bits) {
    test::put(header, 70, code);
    test::put(header, 72, bits);
}

// 2 x 1 x 1 points, 2 times, 3 components: the value of each sample is its place in the file.
std::string seriesOfVectors() {
    std::string header = test::niftiHeader();
    setDims(header, {2, 1, 1, 2, 3});
    return header + test::ramp<std::int16_t>(12);
}

/// The header of a NIfTI-2 file that states what niftiHeader() does, 544 bytes.
std::string nifti2Header() {
    std::string h(544, '\0');
    test::put<std::int32_t>(h, 0, 540);
    std::memcpy(h.data() + 4, "n+2\0\r\n\032\n", 8);
    test::put<std::int16_t>(h, 12, 4);
    test::put<std::int16_t>(h, 14, 16);
    const std::int64_t dim[4] = {3, 4, 3, 2};
    std::memcpy(h.data() + 16, dim, sizeof dim);
    const double pixdim[4] = {1, 1, 2, 3};
    std::memcpy(h.data() + 104, pixdim, sizeof pixdim);
    test::put<std::int64_t>(h, 168, 544);
    test::put<std::int32_t>(h, 348, 1); // sform
    const double sform[12] = {1, 0, 0, -10, 0, 2, 0, -20, 0, 0, 3, 30};
    std::memcpy(h.data() + 400, sform, sizeof sform);
    test::put<std::int32_t>(h, 500, 2);
    return h;
}

class NiftiReader : public testing::Test {
protected:
    template <class T>
    std::vector<double> values(const std::filesystem::path& path, const ReadOptions& options = {}) {
        const auto grid = readVolume(path, options);
        EXPECT_THAT(grid, test::IsOk());
        if (!grid.isOk())
            return {};
        std::vector<double> out;
        for (const T value : grid.value()->values<T>())
            out.push_back(static_cast<double>(value));
        return out;
    }
    std::string refusal(const std::filesystem::path& path, const ReadOptions& options = {}) {
        const auto grid = readVolume(path, options);
        return grid.isOk() ? "is read" : grid.error().message;
    }
    TemporaryFolder folder;
};

TEST_F(NiftiReader, B067_AsksForAFrameOfASeries) {
    std::string bytes = test::niftiHeader();
    setDims(bytes, {4, 3, 2, 2});
    const auto path = folder.write("a.nii", bytes + test::ramp<std::int16_t>(48));
    EXPECT_EQ(refusal(path), "has 2 frames: choose one with --frame 0 to 1");
    EXPECT_THAT(refusal(path, {.frame = 2}), HasSubstr("--frame 2: has frame 0 to 1"));
    const auto second = values<std::int16_t>(path, {.frame = 1});
    ASSERT_EQ(second.size(), 24u);
    EXPECT_EQ(second[0], 24);
    EXPECT_EQ(second[23], 47);
    const auto contents = listVolumes(path);
    ASSERT_THAT(contents, test::IsOk());
    EXPECT_EQ(contents.value().fields[0].frames, 2);
    EXPECT_TRUE(contents.value().needsChoice());
}

TEST_F(NiftiReader, TakesComponentsThatLieOneBehindTheOther) {
    const auto path = folder.write("a.nii.gz", test::gzipped(seriesOfVectors()));
    EXPECT_EQ(refusal(path),
              "has 3 components and 2 frames: choose with --component 0 to 2 or magnitude, and --frame 0 to 1");
    EXPECT_EQ(refusal(path, {.frame = 0}), "has 3 components: choose one with --component 0 to 2 or magnitude");
    EXPECT_THAT(refusal(path, {.component = 3, .frame = 0}), HasSubstr("--component 3: has component 0 to 2"));
    // x fastest, then time, then component.
    EXPECT_EQ(values<std::int16_t>(path, {.component = 1, .frame = 1}), (std::vector<double>{6, 7}));
    EXPECT_EQ(values<std::int16_t>(path, {.component = 2, .frame = 0}), (std::vector<double>{8, 9}));
    EXPECT_EQ(values<float>(path, {.component = kMagnitude, .frame = 0}),
              (std::vector<double>{static_cast<float>(std::sqrt(0.0 + 16 + 64)),
                                   static_cast<float>(std::sqrt(1.0 + 25 + 81))}));
}

TEST_F(NiftiReader, CountsSeriesOfSeries) {
    std::string bytes = test::niftiHeader();
    setDims(bytes, {1, 1, 1, 2, 3, 2}); // dim[6] is slower than the components of dim[5]
    const auto path = folder.write("a.nii", bytes + test::ramp<std::int16_t>(12));
    EXPECT_EQ(values<std::int16_t>(path, {.component = 2, .frame = 3}), (std::vector<double>{11}));
    EXPECT_EQ(values<std::int16_t>(path, {.component = 1, .frame = 2}), (std::vector<double>{8}));
}

TEST_F(NiftiReader, B064_TakesColoursAndComplexNumbersApart) {
    std::string bytes = test::niftiHeader();
    setDims(bytes, {2, 1, 1});
    setType(bytes, 128, 24);
    const auto colours = folder.write("a.nii", bytes + test::ramp<std::uint8_t>(6));
    EXPECT_EQ(refusal(colours), "has 3 components (red, green, blue): choose one with --component 0 to 2 or magnitude");
    EXPECT_EQ(values<std::uint8_t>(colours, {.component = 2}), (std::vector<double>{2, 5}));
    setType(bytes, 2304, 32);
    EXPECT_EQ(values<std::uint8_t>(folder.write("b.nii", bytes + test::ramp<std::uint8_t>(8)), {.component = 3}),
              (std::vector<double>{3, 7}));
    setType(bytes, 32, 64);
    const auto complex = folder.write("c.nii", bytes + test::ramp<float>(4));
    EXPECT_THAT(refusal(complex), HasSubstr("(real, imaginary)"));
    EXPECT_EQ(values<float>(complex, {.component = 1}), (std::vector<double>{1, 3}));
    EXPECT_EQ(values<float>(complex, {.component = kMagnitude}),
              (std::vector<double>{1, static_cast<float>(std::sqrt(13.0))}));
    setType(bytes, 1792, 128);
    EXPECT_EQ(values<double>(folder.write("d.nii", bytes + test::ramp<double>(4)), {.component = 1}),
              (std::vector<double>{1, 3}));
    setType(bytes, 1536, 128);
    EXPECT_THAT(refusal(folder.write("e.nii", bytes + std::string(32, '\0'))), HasSubstr("float128"));
}

TEST_F(NiftiReader, B064_RefusesWholeNumbersBeyondDouble) {
    std::string bytes = test::niftiHeader();
    setDims(bytes, {1, 1, 1});
    setType(bytes, 1024, 64);
    std::string sample(8, '\0');
    test::put<std::int64_t>(sample, 0, (std::int64_t{1} << 53) + 1);
    EXPECT_THAT(refusal(folder.write("a.nii", bytes + sample)), HasSubstr("9007199254740993 has no exact value"));
}

TEST_F(NiftiReader, ReadsNifti2InEitherByteOrder) {
    const auto grid = readVolume(folder.write("a.nii", nifti2Header() + test::ramp<std::int16_t>(24)));
    ASSERT_THAT(grid, test::IsOk());
    EXPECT_EQ(grid.value()->dims(), (GridDims{4, 3, 2}));
    EXPECT_EQ(grid.value()->geometry().spacing, glm::dvec3(1, 2, 3));
    EXPECT_EQ(grid.value()->geometry().origin, glm::dvec3(10, 20, 30));
    EXPECT_EQ(grid.value()->values<std::int16_t>()[23], 23);

    std::string header = nifti2Header();
    const auto swapAt = [&](std::size_t at, std::size_t size) {
        std::reverse(header.begin() + static_cast<std::ptrdiff_t>(at),
                     header.begin() + static_cast<std::ptrdiff_t>(at + size));
    };
    swapAt(0, 4), swapAt(12, 2), swapAt(14, 2), swapAt(168, 8), swapAt(344, 4), swapAt(348, 4), swapAt(500, 4);
    for (std::size_t i = 0; i < 8; ++i)
        swapAt(16 + 8 * i, 8), swapAt(104 + 8 * i, 8);
    for (std::size_t i = 0; i < 12; ++i)
        swapAt(400 + 8 * i, 8);
    const auto swapped = readVolume(folder.write("b.nii", header + test::bigEndian16(24)));
    ASSERT_THAT(swapped, test::IsOk());
    EXPECT_EQ(swapped.value()->geometry(), grid.value()->geometry());
    EXPECT_EQ(swapped.value()->values<std::int16_t>()[23], 23);
}

TEST_F(NiftiReader, B059_RefusesDimensionsOfNifti2) {
    for (const std::int64_t count : {std::int64_t{0}, std::int64_t{-5}, std::int64_t{200}}) {
        std::string bytes = nifti2Header() + test::ramp<std::int16_t>(24);
        test::put<std::int64_t>(bytes, 16, count);
        EXPECT_THAT(refusal(folder.write("a.nii", bytes)), HasSubstr("dim[0]"));
    }
    std::string bytes = nifti2Header();
    test::put<std::int64_t>(bytes, 24, std::int64_t{1} << 62);
    EXPECT_THAT(refusal(folder.write("a.nii", bytes)), HasSubstr("dim: extent"));
    bytes = nifti2Header();
    test::put<std::int64_t>(bytes, 168, std::int64_t{1} << 62);
    EXPECT_THAT(refusal(folder.write("a.nii", bytes)), HasSubstr("vox_offset"));
}

TEST_F(NiftiReader, ReadsPairsOfNiftiAndAnalyze) {
    std::string header = test::niftiHeader();
    std::memcpy(header.data() + 344, "ni1", 4);
    test::put<float>(header, 108, 0);
    folder.write("a.hdr", header);
    folder.write("a.img", test::ramp<std::int16_t>(24));
    EXPECT_EQ(values<std::int16_t>(folder / "a.hdr").size(), 24u);
    EXPECT_EQ(values<std::int16_t>(folder / "a.img")[23], 23);
    folder.write("b.hdr.gz", test::gzipped(header));
    folder.write("b.img.gz", test::gzipped(test::ramp<std::int16_t>(24)));
    EXPECT_EQ(values<std::int16_t>(folder / "b.img.gz")[23], 23);

    header.resize(348);
    test::put<std::int32_t>(header, 344, 0);
    folder.write("c.hdr", header);
    folder.write("c.img", test::ramp<std::int16_t>(24));
    const auto source = openVolume(folder / "c.img");
    ASSERT_THAT(source, test::IsOk());
    EXPECT_EQ(source.value()->info().format, "Analyze");
    EXPECT_EQ(source.value()->info().geometry.spacing, glm::dvec3(1, 2, 3));
    EXPECT_EQ(source.value()->info().notes.size(), 1u);
}

TEST_F(NiftiReader, ReadsSlicesAndNamelessFiles) {
    std::string bytes = test::niftiHeader();
    setDims(bytes, {4, 3});
    const auto grid = readVolume(folder.write("scan", bytes + test::ramp<std::int16_t>(12)));
    ASSERT_THAT(grid, test::IsOk());
    EXPECT_EQ(grid.value()->dims(), (GridDims{4, 3, 1}));
}

TEST_F(NiftiReader, PlacesTheQform) {
    std::string bytes = test::niftiHeader();
    test::put<std::int16_t>(bytes, 252, 1);
    test::put<std::int16_t>(bytes, 254, 0);
    test::put<float>(bytes, 76, -1.0f); // the third axis is turned round
    const float turn = static_cast<float>(std::sqrt(0.5)); // a quarter turn about z: x goes to y
    test::put<float>(bytes, 264, turn);
    const float offset[3] = {-10, -20, 30};
    std::memcpy(bytes.data() + 268, offset, sizeof offset);
    const auto source = openVolume(folder.write("a.nii", bytes + test::ramp<std::int16_t>(24)));
    ASSERT_THAT(source, test::IsOk());
    const GridGeometry& geometry = source.value()->info().geometry;
    EXPECT_EQ(geometry.origin, glm::dvec3(10, 20, 30));
    EXPECT_EQ(geometry.spacing, glm::dvec3(1, 2, 3));
    const glm::dmat3 expected(0, -1, 0, 1, 0, 0, 0, 0, -1); // in left-posterior-superior
    for (int axis = 0; axis < 3; ++axis)
        for (int row = 0; row < 3; ++row)
            EXPECT_NEAR(geometry.direction[axis][row], expected[axis][row], 1e-6);
    EXPECT_TRUE(geometry.isLeftHanded());
    EXPECT_TRUE(source.value()->info().isPatientSpace);
}

TEST_F(NiftiReader, B063_FallsBackFromASingularSform) {
    std::string bytes = test::niftiHeader();
    test::put<float>(bytes, 280, 0.0f); // srow_x is zero
    const auto source = openVolume(folder.write("a.nii", bytes + test::ramp<std::int16_t>(24)));
    ASSERT_THAT(source, test::IsOk());
    EXPECT_EQ(source.value()->info().geometry.spacing, glm::dvec3(1, 2, 3));
    ASSERT_FALSE(source.value()->info().notes.empty());
    EXPECT_THAT(source.value()->info().notes[0], HasSubstr("sform"));
    EXPECT_FALSE(source.value()->info().isPatientSpace) << "its orientation is assumed";
}

TEST_F(NiftiReader, TurnsMetresAndMicrometresToMillimetres) {
    for (const auto& [unit, factor] : {std::pair(1, 1e3), std::pair(3, 1e-3)}) {
        std::string bytes = test::nifti();
        bytes[123] = static_cast<char>(unit);
        const auto source = openVolume(folder.write("a.nii", bytes));
        ASSERT_THAT(source, test::IsOk());
        EXPECT_EQ(source.value()->info().geometry.spacing, factor * glm::dvec3(1, 2, 3));
        EXPECT_EQ(source.value()->info().geometry.origin, factor * glm::dvec3(10, 20, 30));
    }
}

TEST_F(NiftiReader, B062_LeavesOutSlopesThatAreNoNumbers) {
    const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
    for (const auto& [at, value, notes] :
         {std::tuple(112, 0.0f, 0u), std::tuple(112, nan, 1u), std::tuple(112, inf, 1u), std::tuple(116, nan, 1u)}) {
        const auto source =
            openVolume(folder.write("a.nii", test::niftiWith<float>(static_cast<std::size_t>(at), value)));
        ASSERT_THAT(source, test::IsOk());
        EXPECT_EQ(source.value()->info().type, ScalarType::I16);
        ASSERT_EQ(source.value()->info().notes.size(), notes);
        if (notes > 0) {
            EXPECT_THAT(source.value()->info().notes[0], HasSubstr("scl_slope or scl_inter"));
        }
    }
    // An intercept that is none beside a slope that is one: samples stay what they are in the file.
    for (const float intercept : {nan, inf}) {
        std::string bytes = test::niftiWith<float>(112, 2.0f);
        test::put<float>(bytes, 116, intercept);
        EXPECT_EQ(values<std::int16_t>(folder.write("a.nii", bytes))[23], 23);
    }
}

TEST_F(NiftiReader, AppliesAnInterceptWithASlopeOfOne) {
    std::string bytes = test::niftiHeader();
    setDims(bytes, {2, 1, 1});
    test::put<float>(bytes, 112, 1.0f);
    test::put<float>(bytes, 116, -10.5f);
    const auto path = folder.write("a.nii", bytes + test::ramp<std::int16_t>(2));
    EXPECT_THAT(values<float>(path), testing::ElementsAre(-10.5, -9.5));
}

TEST_F(NiftiReader, KeepsTheDigitsOfScaledIntegers) {
    std::string bytes = test::niftiHeader();
    setDims(bytes, {2, 1, 1});
    setType(bytes, 8, 32);
    test::put<float>(bytes, 112, 0.5f);
    for (const std::int32_t value : {(1 << 30) + 1, -7}) { // no f32 holds half the first
        bytes.resize(bytes.size() + sizeof value);
        test::put(bytes, bytes.size() - sizeof value, value);
    }
    EXPECT_THAT(values<double>(folder.write("a.nii", bytes)), testing::ElementsAre(536870912.5, -3.5));
}

TEST_F(NiftiReader, LetsTrailingBytesPassWhenAllowed) {
    const auto path = folder.write("a.nii.gz", test::gzipped(test::nifti() + "x"));
    EXPECT_THAT(refusal(path), HasSubstr("more than"));
    EXPECT_EQ(values<std::int16_t>(path, {.allowsTrailing = true})[23], 23);
    const auto plain = openVolume(folder.write("b.nii", test::nifti() + "x"));
    ASSERT_THAT(plain, test::IsOk());
    EXPECT_THAT(plain.value()->info().notes, testing::ElementsAre(HasSubstr("longer")));
}

} // namespace
} // namespace isoslider::io
