// Index files of each released format version, kept for ever: they open, slide, and are what a build
// gives. ISOSLIDER_WRITE_GOLDEN=FILE writes today's bytes instead of comparing them; commit such a file
// under a new name only, with a new format version.

#include <cstdlib>

#include <gtest/gtest.h>
#include <zstd.h>

#include "core/extract/full_extraction.h"
#include "core/extract/slide_engine.h"
#include "core/index/index_reader.h"
#include "tests/property/surface_comparison.h"
#include "tests/property/test_volumes.h"
#include "tests/support/result_matchers.h"
#include "tests/support/temporary_folder.h"

namespace isoslider::index {
namespace {

using test::IsOk;

const std::filesystem::path kGolden = std::filesystem::path(ISOSLIDER_SOURCE_DIR) / "tests/data/golden_v1.isx";

// Never to be changed: the golden file is of this volume.
std::shared_ptr<const ScalarGrid> goldenVolume() {
    GridGeometry geometry;
    geometry.dims = {9, 5, 6};
    geometry.spacing = {1.0, 0.5, 2.0};
    geometry.origin = {-1.0, 2.0, 3.5};
    return test::makeVolume<float>(ScalarType::F32, geometry, [](std::int64_t x, std::int64_t y, std::int64_t z) {
        if ((x == 3 && y == 2 && z == 4) || (x == 8 && y == 0 && z == 0))
            return std::numeric_limits<float>::quiet_NaN();
        const std::int64_t bowl = (x - 4) * (x - 4) + 2 * (y - 2) * (y - 2) + 2 * (z - 3) * (z - 3);
        return static_cast<float>(bowl + (x * 7 + y * 5 + z * 3) % 11) * 0.25f;
    });
}

std::string buildGolden(const std::filesystem::path& path) {
    preprocess::BuildOptions options;
    options.skipLevels = 4;
    options.redundancyThreshold = 0.5;
    options.sourceName = "golden";
    EXPECT_THAT(test::buildIndexOf(goldenVolume(), path, options), IsOk());
    return test::readText(path);
}

TEST(GoldenIndex, OpensWithTheFactsOfItsVolume) {
    const auto reader = IndexReader::open(kGolden);
    ASSERT_THAT(reader, IsOk());
    const IndexInfo& info = reader.value()->info();
    EXPECT_EQ(info.geometry, goldenVolume()->geometry());
    EXPECT_EQ(info.type, ScalarType::F32);
    EXPECT_EQ(info.sourceName, "golden");
    EXPECT_EQ(info.nanCount, 2u);
    EXPECT_EQ(info.min, 0.5);
    EXPECT_EQ(info.max, 13.0);
    EXPECT_EQ(info.distinctValues, 44u);
    EXPECT_EQ(info.redundancyThreshold, 0.5);
    EXPECT_GE(info.levels.size(), 3u);
}

TEST(GoldenIndex, SlidesLikeItsVolume) {
    const auto engine = extract::SlideEngine::open(kGolden);
    ASSERT_THAT(engine, IsOk());
    const auto grid = goldenVolume();
    for (const double isovalue : {5.0, 5.25, 5.3, 2.0, 10.0, 0.0, 30.0, 7.5, 6.75}) {
        ASSERT_THAT(engine.value()->slideTo(isovalue), IsOk());
        const auto slid = engine.value()->mesh();
        EXPECT_TRUE(test::isSameSurface(slid, extract::extractFull(*grid, isovalue).value())) << isovalue;
        EXPECT_TRUE(test::hasExpectedNormals(slid, *grid)) << isovalue;
    }
}

TEST(GoldenIndex, IsWhatABuildGives) {
    if (const char* path = std::getenv("ISOSLIDER_WRITE_GOLDEN")) {
        buildGolden(path);
        GTEST_SKIP() << "wrote " << path;
    }
#if !defined(__x86_64__) || defined(__FMA__)
    GTEST_SKIP() << "normals may round otherwise here";
#endif
    if (ZSTD_versionNumber() != 10504)
        GTEST_SKIP() << "compressed planes are those of zstd 1.5.4; here is " << ZSTD_versionString();
    const test::TemporaryFolder folder;
    const std::string built = buildGolden(folder / "golden.isx"), golden = test::readText(kGolden);
    EXPECT_EQ(built.size(), golden.size());
    const auto differs = std::mismatch(built.begin(), built.begin() + static_cast<std::ptrdiff_t>(std::min(built.size(), golden.size())), golden.begin());
    EXPECT_TRUE(built == golden) << "first difference at byte " << differs.first - built.begin();
}

} // namespace
} // namespace isoslider::index
