// Index files of each released format version, kept for ever: those that are read open and slide, those of this version
// are what a build gives, older ones are refused, and what they lack is named. ISOSLIDER_WRITE_GOLDEN=FOLDER writes
// today's bytes instead of comparing them; commit such a file under a new name only, with a new format version.

#include <cstdlib>
#include <fstream>

#include <gtest/gtest.h>
#include <zstd.h>

#include "core/extract/full_extraction.h"
#include "core/extract/merged/merged_extraction.h"
#include "core/extract/slide_engine.h"
#include "core/index/index_reader.h"
#include "core/index/validation/index_validation.h"
#include "core/topology/index_topology.h"
#include "core/topology/stored_topology.h"
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
const std::filesystem::path kGolden = kData / "golden_v7.isx";

struct Golden {
    const char* name;
    IndexKind kind = IndexKind::Edges;
    extract::MergeError mergeError = {};
    const char* unit = ""; ///< minor version 1
    bool isResampled = false; ///< minor version 2
    bool hasTopology = false;
    bool isOfThisVersion = true;
};
constexpr Golden kGoldenIndexes[] = {
    {.name = "golden_v4_metacells", .kind = IndexKind::Metacells, .isOfThisVersion = false},
    {.name = "golden_v4_1_topology",
     .kind = IndexKind::Metacells,
     .unit = "mm",
     .hasTopology = true,
     .isOfThisVersion = false},
    {.name = "golden_v5_metacells", .kind = IndexKind::Metacells, .isOfThisVersion = false},
    {.name = "golden_v5_1_topology",
     .kind = IndexKind::Metacells,
     .unit = "mm",
     .hasTopology = true,
     .isOfThisVersion = false},
    {.name = "golden_v6", .isOfThisVersion = false},
    {.name = "golden_v6_metacells", .kind = IndexKind::Metacells, .isOfThisVersion = false},
    {.name = "golden_v6_merged", .mergeError = {extract::MergeBound::Measure::Scalar, 30.0}, .isOfThisVersion = false},
    {.name = "golden_v6_1_topology",
     .kind = IndexKind::Metacells,
     .unit = "mm",
     .hasTopology = true,
     .isOfThisVersion = false},
    {.name = "golden_v6_2", .unit = "mm", .isResampled = true, .isOfThisVersion = false},
    {.name = "golden_v7"},
    {.name = "golden_v7_metacells", .kind = IndexKind::Metacells},
    {.name = "golden_v7_merged", .mergeError = {extract::MergeBound::Measure::Scalar, 30.0}},
    {.name = "golden_v7_1_topology", .kind = IndexKind::Metacells, .unit = "mm", .hasTopology = true},
    {.name = "golden_v7_2", .unit = "mm", .isResampled = true},
};

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

std::string buildGolden(const std::filesystem::path& path, const Golden& golden) {
    preprocess::BuildOptions options;
    options.kind = golden.kind;
    options.mergeError = golden.mergeError;
    options.skipLevels = 4;
    options.redundancyThreshold = 0.5;
    options.sourceName = "golden";
    io::VolumeInfo info;
    info.lengthUnit = golden.unit;
    if (golden.isResampled)
        info.resampling = io::ResampleReport{300, 280, 0.5, 0.125, 0.04, 3};
    EXPECT_THAT(preprocess::buildIndex(*io::makeMemorySource(goldenVolume(), info), path, options), IsOk());
    return test::readText(path);
}

// Nothing can be made of them that is right.
TEST(GoldenIndex, NamesWhatEarlierVersionsLack) {
    const std::string others = "keeps samples in another way, or none", edges = "keeps no samples with the edges";
    for (const auto& [which, flaw] : {std::pair<std::string, std::string>{"1", others},
                                      {"2", others},
                                      {"3", others},
                                      {"4", edges},
                                      {"4_2", edges},
                                      {"4_merged", edges},
                                      {"5", edges},
                                      {"5_2", edges},
                                      {"5_merged", edges}}) {
        const std::string name = "golden_v" + which + ".isx", version = which.substr(0, 1);
        const auto opened = IndexReader::open(kData / name);
        ASSERT_THAT(opened, HasError(ErrorCode::UnsupportedVersion));
        const std::string line = opened.error().line();
        EXPECT_NE(line.find(name), std::string::npos) << line;
        EXPECT_NE(line.find("format version " + version + ", which " + flaw), std::string::npos) << line;
        EXPECT_NE(line.find("build it again from its volume"), std::string::npos) << line;
        EXPECT_EQ(line.find('\n'), std::string::npos);
    }
}

// What is no index, of a later version, or damaged gets three different answers, whatever else is wrong with it.
TEST(GoldenIndex, OfAnotherKindLaterOrDamagedHasThreeAnswers) {
    const test::TemporaryFolder folder;
    const std::string good = test::readText(kGolden);
    const auto errorOf = [&](std::size_t at, char byte) {
        std::string bytes = good;
        bytes[at] = byte;
        std::ofstream(folder / "a.isx", std::ios::binary) << bytes;
        const auto opened = IndexReader::open(folder / "a.isx");
        EXPECT_FALSE(opened.isOk());
        return opened.error();
    };
    EXPECT_EQ(errorOf(0, 'X').code, ErrorCode::InvalidArgument);
    EXPECT_NE(errorOf(0, 'X').message.find("not an ISOSLIDER index"), std::string::npos);
    EXPECT_EQ(errorOf(12, 9).code, ErrorCode::UnsupportedVersion);
    EXPECT_NE(errorOf(12, 9).message.find("made by a newer version"), std::string::npos);
    EXPECT_EQ(errorOf(20, 77).code, ErrorCode::Corruption);
    EXPECT_EQ(errorOf(good.size() - 20, 77).code, ErrorCode::Corruption);
}

class GoldenIndexOf : public testing::TestWithParam<Golden> {
protected:
    std::filesystem::path golden() const { return kData / (std::string(GetParam().name) + ".isx"); }
};

TEST_P(GoldenIndexOf, OpensWithTheFactsOfItsVolume) {
    const auto reader = IndexReader::open(golden());
    ASSERT_THAT(reader, IsOk());
    const IndexInfo& info = reader.value()->info();
    EXPECT_EQ(info.kind, GetParam().kind);
    EXPECT_EQ(info.mergeError, GetParam().mergeError.amount);
    EXPECT_EQ(info.lengthUnit, GetParam().unit);
    EXPECT_EQ(info.resampling.empty(), !GetParam().isResampled);
    EXPECT_EQ(info.geometry, goldenVolume()->geometry());
    EXPECT_EQ(info.type, ScalarType::F32);
    EXPECT_EQ(info.sourceName, "golden");
    EXPECT_EQ(info.nanCount, 2u);
    EXPECT_EQ(info.min, 0.5);
    EXPECT_EQ(info.max, 13.0);
    EXPECT_EQ(info.distinctValues, 44u);
    EXPECT_EQ(info.redundancyThreshold, 0.5);
    EXPECT_GE(info.levels.size(), GetParam().kind == IndexKind::Edges ? 3u : 1u);
}

TEST_P(GoldenIndexOf, SlidesLikeItsVolume) {
    const auto engine = extract::SlideEngine::open(golden());
    ASSERT_THAT(engine, IsOk());
    const auto grid = goldenVolume();
    std::vector<double> walk = {5.0, 5.25, 5.3, 2.0, 10.0, 0.0, 30.0, 7.5, 6.75};
    for (int step = 0; step <= 250; ++step) // through all tunnels
        walk.push_back(0.5 + 0.05 * step);
    extract::LeafCounts leaves{};
    std::uint64_t mergedLeaves = 0;
    for (const double isovalue : walk) {
        ASSERT_THAT(engine.value()->slideTo(isovalue), IsOk());
        const auto slid = engine.value()->mesh().value();
        if (GetParam().mergeError.amount > 0.0) {
            const auto merged = extract::extractMerged(*grid, isovalue, engine.value()->mergeBound(),
                                                       extract::kMaxBrickMergeLevel, {}, &leaves);
            EXPECT_TRUE(test::isSameSurface(slid, merged.value())) << isovalue;
            mergedLeaves += leaves[1];
            continue;
        }
        EXPECT_TRUE(test::isSameSurface(slid, extract::extractFull(*grid, isovalue).value())) << isovalue;
        EXPECT_TRUE(test::hasExpectedNormals(slid, *grid)) << isovalue;
    }
    EXPECT_EQ(mergedLeaves > 0, GetParam().mergeError.amount > 0.0);
}

TEST_P(GoldenIndexOf, HasTheTopologyOfItsVolume) {
    const auto opened = topology::openTopology(golden());
    ASSERT_THAT(opened, IsOk());
    ASSERT_EQ(opened.value() != nullptr, GetParam().hasTopology);
    if (!GetParam().hasTopology)
        return;
    const auto reader = IndexReader::open(golden());
    ASSERT_THAT(reader, IsOk());
    const auto analysed = topology::analyseTopology(topology::planesOf(*reader.value()));
    ASSERT_THAT(analysed, IsOk());
    EXPECT_EQ(opened.value()->eventCount(), analysed.value().eventCount());
    EXPECT_GT(opened.value()->eventCount(), 10u);
}

TEST_P(GoldenIndexOf, IsSound) {
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
    EXPECT_TRUE(report.value().areSamplesCompared);
}

TEST_P(GoldenIndexOf, IsWhatABuildGives) {
    if (!GetParam().isOfThisVersion)
        GTEST_SKIP() << "builds give a later version";
    if (const char* folder = std::getenv("ISOSLIDER_WRITE_GOLDEN")) {
        const std::filesystem::path path = std::filesystem::path(folder) / golden().filename();
        buildGolden(path, GetParam());
        if (GetParam().hasTopology) {
            ASSERT_THAT(topology::topologyOfIndex(path, {}, {}).value().storing, IsOk());
        }
        GTEST_SKIP() << "wrote " << golden().filename();
    }
#if !defined(__x86_64__) || defined(__FMA__)
    GTEST_SKIP() << "normals may round otherwise here";
#endif
    if (ZSTD_versionNumber() != 10504)
        GTEST_SKIP() << "compressed planes are those of zstd 1.5.4; here is " << ZSTD_versionString();
    const test::TemporaryFolder folder;
    const std::string built = buildGolden(folder / "golden.isx", GetParam());
    std::string wanted = test::readText(golden());
    if (GetParam().hasTopology) // what follows the index is another test's
        wanted.resize(std::min<std::size_t>(wanted.size(), IndexReader::open(golden()).value()->info().indexBytes));
    EXPECT_EQ(built.size(), wanted.size());
    const auto differs =
        std::mismatch(built.begin(), built.begin() + static_cast<std::ptrdiff_t>(std::min(built.size(), wanted.size())),
                      wanted.begin());
    EXPECT_TRUE(built == wanted) << "first difference at byte " << differs.first - built.begin();
}

INSTANTIATE_TEST_SUITE_P(Versions, GoldenIndexOf, testing::ValuesIn(kGoldenIndexes),
                         [](const auto& golden) { return std::string(golden.param.name); });

} // namespace
} // namespace isoslider::index
