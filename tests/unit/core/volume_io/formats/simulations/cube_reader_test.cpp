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

const char* const kHeader =
    "title\nof two lines\n  2  10.0 20.0 30.0\n  2  1.0 0.0 0.0\n  3  0.0 2.0 0.0\n  4  0.0 0.5 3.0\n"
    "  1  1.0  0.0 0.0 0.0\n  8  8.0  1.0 1.0 1.0\n";

// Numbers of 2 x 3 x 4 points, the third axis fastest: 0, 1, ...
std::string numbers(int count) {
    std::string text;
    for (int i = 0; i < count; ++i)
        text += " " + std::to_string(i) + (i % 6 == 5 ? "\n" : "");
    return text + "\n";
}

class CubeReader : public testing::Test {
protected:
    Result<std::shared_ptr<const ScalarGrid>> read(const std::string& text, const ReadOptions& options = {},
                                                   const char* name = "a.cube") {
        return readVolume(folder.write(name, text), options);
    }
    std::string refusal(const std::string& text, const ReadOptions& options = {}) {
        const auto grid = read(text, options);
        return grid.isOk() ? "is read" : grid.error().message;
    }
    test::TemporaryFolder folder;
};

TEST_F(CubeReader, TurnsTheThirdAxisToTheLast) {
    for (const char* name : {"a.cube", "a.cub", "A.CUBE"}) {
        const auto grid = read(kHeader + numbers(24), {}, name);
        ASSERT_THAT(grid, test::IsOk());
        EXPECT_EQ(grid.value()->type(), ScalarType::F64);
        EXPECT_EQ(grid.value()->dims(), (GridDims{2, 3, 4}));
        EXPECT_EQ(grid.value()->valueAt(0, 0, 3), 3.0);
        EXPECT_EQ(grid.value()->valueAt(0, 2, 0), 8.0);
        EXPECT_EQ(grid.value()->valueAt(1, 0, 0), 12.0);
        EXPECT_EQ(grid.value()->valueAt(1, 2, 3), 23.0);
    }
    EXPECT_THAT(read(test::gzipped(kHeader + numbers(24)), {}, "a.cube.gz"), test::IsOk());
}

TEST_F(CubeReader, ReadsInPassesWhatDoesNotFitIntoMemory) {
    const auto path = folder.write("a.cube", kHeader + numbers(24));
    constexpr std::uint64_t kPlaneBytes = 2 * 3 * sizeof(double);
    for (const std::uint64_t planes : {1, 2, 3, 4, 9}) { // held at once
        ReadOptions options;
        options.memoryBytes = 2 * planes * kPlaneBytes;
        const auto source = openVolume(path, options);
        ASSERT_THAT(source, test::IsOk());
        for (const auto& [begin, end] : {std::pair{0, 4}, {3, 4}, {1, 3}, {0, 1}, {2, 2}}) {
            std::vector<double> samples(static_cast<std::size_t>(end - begin) * 6);
            ASSERT_THAT(source.value()->readSlab(begin, end, std::as_writable_bytes(std::span(samples))), test::IsOk());
            std::size_t at = 0;
            for (int z = begin; z < end; ++z)
                for (int y = 0; y < 3; ++y)
                    for (int x = 0; x < 2; ++x)
                        ASSERT_EQ(samples[at++], 12 * x + 4 * y + z) << planes;
        }
    }
    ReadOptions little;
    little.memoryBytes = 1;
    EXPECT_THAT(refusal(kHeader + numbers(23) + " x", little), HasSubstr("'x' is not one")) << "of the last plane";
}

TEST_F(CubeReader, KeepsObliqueAxes) {
    const auto source = openVolume(folder.write("a.cube", kHeader + numbers(24)));
    ASSERT_THAT(source, test::IsOk());
    const VolumeInfo& info = source.value()->info();
    EXPECT_EQ(info.geometry.origin, glm::dvec3(10, 20, 30));
    EXPECT_EQ(info.geometry.spacing, glm::dvec3(1, 2, std::sqrt(9.25)));
    const glm::dvec3 corner(info.geometry.indexToWorld() * glm::dvec4(1, 2, 3, 1));
    EXPECT_NEAR(corner.x, 11, 1e-12);
    EXPECT_NEAR(corner.y, 25.5, 1e-12);
    EXPECT_NEAR(corner.z, 39, 1e-12);
    EXPECT_EQ(info.lengthUnit, "bohr");
    EXPECT_THAT(info.notes, testing::IsEmpty());
    const auto angstrom =
        openVolume(folder.write("b.cube", replaced(kHeader, "  2  1.0 0.0", " -2  1.0 0.0") + numbers(24)));
    ASSERT_THAT(angstrom, test::IsOk());
    EXPECT_EQ(angstrom.value()->info().lengthUnit, "Å");
}

TEST_F(CubeReader, KeepsEveryDigit) {
    const std::string text =
        replaced(kHeader + numbers(24), " 0 1 2 3 4 5\n",
                 " 0.1 1.2345678901234567E-300 -0.5D+01 1.5-102 1e-999 +4.9406564584124654e-324\n");
    const auto grid = read(text);
    ASSERT_THAT(grid, test::IsOk());
    EXPECT_EQ(grid.value()->valueAt(0, 0, 0), 0.1);
    EXPECT_EQ(grid.value()->valueAt(0, 0, 1), 1.2345678901234567E-300);
    EXPECT_EQ(grid.value()->valueAt(0, 0, 2), -5.0);
    EXPECT_EQ(grid.value()->valueAt(0, 0, 3), 1.5e-102);
    EXPECT_EQ(grid.value()->valueAt(0, 1, 0), 0.0);
    EXPECT_EQ(grid.value()->valueAt(0, 1, 1), 4.9406564584124654e-324);
}

TEST_F(CubeReader, AsksWhichOrbital) {
    const std::string header = replaced(kHeader, "  2  10.0", " -2  10.0") + "  2  17\n  18\n";
    EXPECT_EQ(refusal(header + numbers(48)),
              "has 2 components (orbital 17, orbital 18): choose one with --component 0 to 1 or magnitude");
    const auto second = read(header + numbers(48), {.component = 1});
    ASSERT_THAT(second, test::IsOk());
    EXPECT_EQ(second.value()->valueAt(1, 2, 3), 47.0);
    EXPECT_EQ(second.value()->valueAt(0, 0, 1), 3.0);
    const auto length = read(header + numbers(48), {.component = kMagnitude});
    ASSERT_THAT(length, test::IsOk());
    EXPECT_EQ(length.value()->valueAt(0, 0, 1), std::sqrt(4.0 + 9.0));
    const auto contents = listVolumes(folder.write("l.cube", header + numbers(48)));
    ASSERT_THAT(contents, test::IsOk());
    EXPECT_EQ(contents.value().fields[0].title, "title of two lines");
    EXPECT_TRUE(contents.value().needsChoice());
    const std::string gradient = replaced(kHeader, "10.0 20.0 30.0", "10.0 20.0 30.0 4");
    EXPECT_THAT(refusal(gradient + numbers(96)), HasSubstr("4 components"));
}

TEST_F(CubeReader, TitleIsOneLine) {
    const std::string text = replaced(kHeader, "title\n", "ti\x1b[2Jt\tle\x7f\n") + numbers(24);
    const auto contents = listVolumes(folder.write("a.cube", text));
    ASSERT_THAT(contents, test::IsOk());
    EXPECT_EQ(contents.value().fields[0].title, "ti [2Jt le  of two lines");
}

TEST_F(CubeReader, RefusesWhatIsNone) {
    const std::string good = kHeader + numbers(24);
    EXPECT_THAT(refusal(kHeader + numbers(23)), HasSubstr("24 expected, found 23"));
    EXPECT_THAT(refusal(good + "24\n"), HasSubstr("more than the 24"));
    EXPECT_EQ(refusal(good + "24\n", {.allowsTrailing = true}), "is read");
    EXPECT_THAT(refusal(replaced(good, " 7 ", " abc ")), HasSubstr("number 7: 'abc'"));
    EXPECT_THAT(refusal(replaced(good, " 7 ", " 1-2 ")), HasSubstr("number 7: '1-2'"));
    EXPECT_THAT(refusal(replaced(good, " 7 ", " 1e999 ")), HasSubstr("number 7: '1e999'"));
    EXPECT_THAT(refusal(replaced(good, " 7 ", " " + std::string(100'000, '0') + " ")), HasSubstr("number 7"));
    EXPECT_THAT(refusal(replaced(good, "  4  0.0", "  0  0.0")), HasSubstr("axes"));
    EXPECT_THAT(refusal(replaced(good, "  4  0.0", "  4000000000  0.0")), HasSubstr("axes"));
    EXPECT_THAT(refusal(replaced(good, "  4  0.0", "  400000  0.0")), HasSubstr("cannot hold"));
    EXPECT_THAT(refusal(replaced(good, "  4  0.0 0.5 3.0", "  4  0.0 0.0 0.0")), HasSubstr("axes"));
    EXPECT_THAT(refusal(replaced(good, "  4  0.0 0.5 3.0", "  4  0.0 2.0 0.0")), HasSubstr("axes"));
    EXPECT_THAT(refusal(replaced(good, "0.5 3.0", "nan 3.0")), HasSubstr("axis 3"));
    EXPECT_THAT(refusal(replaced(good, "  2  10.0", "  999999999999  10.0")), HasSubstr("atoms"));
    EXPECT_THAT(refusal(replaced(good, "  2  10.0", "  1000  10.0")), HasSubstr("atoms"));
    EXPECT_THAT(refusal(replaced(good, "  2  10.0", "  -2  10.0")), HasSubstr("orbitals"));
    EXPECT_THAT(refusal(replaced(good, "10.0 20.0 30.0", "10.0 20.0 30.0 0")), HasSubstr("values per point"));
    EXPECT_THAT(refusal("Dear reader,\nthis is\na letter.\n"), HasSubstr("not a Gaussian cube"));
    EXPECT_THAT(refusal(std::string(3'000'000, 'x')), HasSubstr("title"));
}

} // namespace
} // namespace isoslider::io
