// Index files of each released format version, kept for ever: those of this version open, slide, and are
// what a build gives, older ones are refused by name. ISOSLIDER_WRITE_GOLDEN=FOLDER writes today's bytes
// instead of comparing them; commit such a file under a new name only, with a new format version.

#include <cstdlib>

#include <gtest/gtest.h>
#include <zstd.h>

#include "core/extract/full_extraction.h"
#include "core/extract/slide_engine.h"
#include "core/index/hidden_corners.h"
#include "core/index/index_reader.h"
#include "core/index/validation/index_validation.h"
#include "tests/property/surface_comparison.h"
#include "tests/property/test_volumes.h"
#include "tests/support/result_matchers.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_paths.h"

namespace isoslider::index {
namespace {

using test::HasError;
using test::IsOk;

const std::filesystem::path kData = std::filesystem::path(test::sourceFolder()) / "tests/data";
const std::filesystem::path kGolden = kData / "golden_v4.isx";
const std::filesystem::path kGoldenMetacells = kData / "golden_v4_metacells.isx";

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

std::string buildGolden(const std::filesystem::path& path, IndexKind kind) {
    preprocess::BuildOptions options;
    options.kind = kind;
    options.skipLevels = 4;
    options.redundancyThreshold = 0.5;
    options.sourceName = "golden";
    EXPECT_THAT(test::buildIndexOf(goldenVolume(), path, options), IsOk());
    return test::readText(path);
}

// The first lacks samples that its surfaces need.
TEST(GoldenIndex, EarlierVersionsAreRefusedByName) {
    for (const std::string version : {"1", "2", "3"}) {
        const std::string name = "golden_v" + version + ".isx";
        const auto opened = IndexReader::open(kData / name);
        ASSERT_THAT(opened, HasError(ErrorCode::UnsupportedVersion));
        const std::string line = opened.error().line();
        EXPECT_NE(line.find(name), std::string::npos) << line;
        EXPECT_NE(
            line.find("format version " + version + ", this program reads version 4: build it again from its volume"),
            std::string::npos)
            << line;
        EXPECT_EQ(line.find('\n'), std::string::npos);
    }
}

class GoldenIndexKind : public testing::TestWithParam<IndexKind> {
protected:
    std::filesystem::path golden() const { return GetParam() == IndexKind::Edges ? kGolden : kGoldenMetacells; }
};

TEST_P(GoldenIndexKind, OpensWithTheFactsOfItsVolume) {
    const auto reader = IndexReader::open(golden());
    ASSERT_THAT(reader, IsOk());
    const IndexInfo& info = reader.value()->info();
    EXPECT_EQ(info.kind, GetParam());
    EXPECT_EQ(info.geometry, goldenVolume()->geometry());
    EXPECT_EQ(info.type, ScalarType::F32);
    EXPECT_EQ(info.sourceName, "golden");
    EXPECT_EQ(info.nanCount, 2u);
    EXPECT_EQ(info.min, 0.5);
    EXPECT_EQ(info.max, 13.0);
    EXPECT_EQ(info.distinctValues, 44u);
    EXPECT_EQ(info.redundancyThreshold, 0.5);
    EXPECT_GE(info.levels.size(), GetParam() == IndexKind::Edges ? 3u : 1u);
}

TEST_P(GoldenIndexKind, SlidesLikeItsVolume) {
    const auto engine = extract::SlideEngine::open(golden());
    ASSERT_THAT(engine, IsOk());
    const auto grid = goldenVolume();
    std::vector<double> walk = {5.0, 5.25, 5.3, 2.0, 10.0, 0.0, 30.0, 7.5, 6.75};
    for (int step = 0; step <= 250; ++step) // through all tunnels
        walk.push_back(0.5 + 0.05 * step);
    for (const double isovalue : walk) {
        ASSERT_THAT(engine.value()->slideTo(isovalue), IsOk());
        const auto slid = engine.value()->mesh().value();
        EXPECT_TRUE(test::isSameSurface(slid, extract::extractFull(*grid, isovalue).value())) << isovalue;
        EXPECT_TRUE(test::hasExpectedNormals(slid, *grid)) << isovalue;
    }
}

TEST_P(GoldenIndexKind, IsSound) {
    ValidationOptions options;
    options.isFull = true;
    const auto source = std::shared_ptr<io::VolumeSource>(io::makeMemorySource(goldenVolume()));
    options.volume = ComparedVolume{source->info().geometry, source->info().type,
                                    [source](std::int64_t zBegin, std::int64_t zEnd, std::span<std::byte> out) {
                                        return source->readSlab(zBegin, zEnd, out);
                                    }};
    const auto report = validateIndex(golden(), options);
    ASSERT_THAT(report, IsOk());
    EXPECT_EQ(report.value().faultCount, 0u) << (report.value().isSound() ? "" : report.value().faults[0].line());
    EXPECT_TRUE(report.value().areEdgesCompared);
}

TEST(GoldenIndex, HasHiddenCorners) {
    const auto reader = IndexReader::open(kGolden);
    ASSERT_THAT(reader, IsOk());
    EXPECT_EQ(reader.value()->info().hiddenCorners, 2u);
    const HiddenCorners hidden(*reader.value());
    const auto grid = goldenVolume();
    int found = 0;
    for (const BrickIndex brick : firstIds<BrickIndex>(2))
        for (const LocalPoint cell : firstIds<LocalPoint>(kBrickPoints))
            for (int corner = 0; corner < 8; ++corner) {
                const auto scalar = hidden.find(brick, cell, corner);
                ASSERT_THAT(scalar, IsOk());
                if (!scalar.value())
                    continue;
                ++found;
                const auto p = reader.value()->grid().pointCoords(pointIn(brick, cell));
                EXPECT_EQ(*scalar.value(),
                          grid->valueAt(p[0] + (corner & 1), p[1] + (corner >> 1 & 1), p[2] + (corner >> 2)));
            }
    EXPECT_EQ(found, 2);
}

TEST_P(GoldenIndexKind, IsWhatABuildGives) {
    if (const char* folder = std::getenv("ISOSLIDER_WRITE_GOLDEN")) {
        buildGolden(std::filesystem::path(folder) / golden().filename(), GetParam());
        GTEST_SKIP() << "wrote " << golden().filename();
    }
#if !defined(__x86_64__) || defined(__FMA__)
    GTEST_SKIP() << "normals may round otherwise here";
#endif
    if (ZSTD_versionNumber() != 10504)
        GTEST_SKIP() << "compressed planes are those of zstd 1.5.4; here is " << ZSTD_versionString();
    const test::TemporaryFolder folder;
    const std::string built = buildGolden(folder / "golden.isx", GetParam()), wanted = test::readText(golden());
    EXPECT_EQ(built.size(), wanted.size());
    const auto differs =
        std::mismatch(built.begin(), built.begin() + static_cast<std::ptrdiff_t>(std::min(built.size(), wanted.size())),
                      wanted.begin());
    EXPECT_TRUE(built == wanted) << "first difference at byte " << differs.first - built.begin();
}

INSTANTIATE_TEST_SUITE_P(Kinds, GoldenIndexKind, testing::Values(IndexKind::Edges, IndexKind::Metacells),
                         [](const auto& kind) { return std::string(indexKindName(kind.param)); });

} // namespace
} // namespace isoslider::index
