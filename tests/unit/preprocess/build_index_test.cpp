#include "preprocess/build_index.h"

#include <sys/resource.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <thread>

#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include "core/base/machine.h"
#include "core/extract/full_extraction.h"
#include "core/extract/slide_engine.h"
#include "core/grid/volume_statistics.h"
#include "core/index/format/index_format.h"
#include "core/index/sample_store.h"
#include "preprocess/metacells/brick_list.h"
#include "tests/property/random_volumes.h"
#include "tests/property/surface_comparison.h"
#include "tests/support/faulty_file_system.h"
#include "tests/support/result_matchers.h"
#include "tests/support/temporary_folder.h"

namespace isoslider::preprocess {
namespace {

using test::HasError;
using test::IsOk;

// The real disk; remembers what was created.
class WatchedFileSystem final : public FileSystem {
public:
    Result<std::unique_ptr<RandomAccessFile>> openForReading(const std::filesystem::path& path) override {
        return defaultFileSystem().openForReading(path);
    }
    Result<std::unique_ptr<WritableFile>> create(const std::filesystem::path& path) override {
        created.push_back(path);
        return defaultFileSystem().create(path);
    }
    Status renameDurably(const std::filesystem::path& from, const std::filesystem::path& to) override {
        return defaultFileSystem().renameDurably(from, to);
    }
    Status removeFile(const std::filesystem::path& path) override { return defaultFileSystem().removeFile(path); }

    std::vector<std::filesystem::path> created;
};

class BuildIndexKind : public testing::TestWithParam<index::IndexKind> {
protected:
    static BuildOptions options() {
        BuildOptions options;
        options.kind = GetParam();
        return options;
    }
};

INSTANTIATE_TEST_SUITE_P(Kinds, BuildIndexKind, testing::Values(index::IndexKind::Edges, index::IndexKind::Metacells),
                         [](const auto& kind) { return std::string(index::indexKindName(kind.param)); });

/// How many threads of this process give way so much at least.
std::size_t threadsThatGiveWay(int nice) {
    std::size_t count = 0;
    std::error_code error;
    for (const auto& task : std::filesystem::directory_iterator("/proc/self/task", error))
        count += ::getpriority(PRIO_PROCESS, static_cast<id_t>(std::stoul(task.path().filename()))) >= nice ? 1 : 0;
    return count;
}

TEST_P(BuildIndexKind, HasHelpersThatGiveWayAsItsCallerDoes) {
    constexpr int kLow = 10;
    if (std::thread::hardware_concurrency() < 2)
        GTEST_SKIP() << "there are no helpers on one processor";
    if (threadsThatGiveWay(kLow) > 0)
        GTEST_SKIP() << "the whole process gives way";
    // Helpers that the build itself makes would give way from the start.
    tbb::parallel_for(0, 100, [](int) { std::this_thread::sleep_for(std::chrono::milliseconds(1)); });
    const test::TemporaryFolder folder;
    const auto grid = test::noiseVolume({128, 128, 128}, 6, 250); // large: loops must last until a helper is seen
    std::atomic<bool> isEnough{false};
    std::thread builder([&] {
        lowerThreadPriority();
        // Where other programs keep all processors busy, a helper may be too late for many builds.
        const auto patience = std::chrono::steady_clock::now() + std::chrono::seconds(30);
        while (!isEnough && std::chrono::steady_clock::now() < patience)
            EXPECT_THAT(test::buildIndexOf(grid, folder / "a.isx", options()), IsOk());
        isEnough = true;
    });
    std::size_t most = 0;
    while (!isEnough) {
        most = std::max(most, threadsThatGiveWay(kLow));
        isEnough = isEnough || most > 1;
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    builder.join();
    EXPECT_GT(most, 1u) << "the builder's thread alone";
}

TEST_P(BuildIndexKind, GivesTheSameBytesForAnyNumberOfThreads) {
    const test::TemporaryFolder folder;
    for (const auto& grid : {test::hillsVolume({50, 41, 30}), test::noiseVolume({50, 41, 50}, 6, 250)}) {
        std::vector<std::string> bytes;
        for (const int threads : {1, 2, 4}) {
            BuildOptions threaded = options();
            threaded.threads = threads;
            ASSERT_THAT(test::buildIndexOf(grid, folder / "a.isx", threaded), IsOk());
            bytes.push_back(test::readText(folder / "a.isx"));
        }
        EXPECT_TRUE(bytes[0] == bytes[1] && bytes[0] == bytes[2]);
    }
}

// A program started from a menu may stand in a folder that it cannot write to.
TEST(MemoryEngine, DoesNotDependOnTheWorkingFolder) {
    const test::TemporaryFolder folder;
    std::filesystem::create_directory(folder / "bricks"); // the name of the list in memory
    const auto before = std::filesystem::current_path();
    std::filesystem::current_path(folder.path());
    const auto engine = makeMemoryEngine(test::hillsVolume({20, 20, 20}));
    const auto built = test::buildIndexOf(test::hillsVolume({40, 40, 40}), folder / "a.isx", {});
    std::filesystem::current_path(before);
    EXPECT_THAT(engine, IsOk());
    EXPECT_THAT(built, IsOk());
}

TEST(BuildIndex, GivesTheSameBytesForAnyMemoryBudget) {
    const test::TemporaryFolder folder;
    GridGeometry geometry = test::cubeGeometry(92);
    test::Random random(1);
    const auto grid = test::makeVolume<double>(ScalarType::F64, geometry, [&](auto x, auto y, auto z) {
        const double noise = static_cast<double>(random() % 1000); // strong in the lower half
        return std::sin(0.1 * static_cast<double>(x + y)) + 0.01 * static_cast<double>(z) +
               (z < 46 ? 1e-2 : 1e-6) * noise;
    });
    const auto build = [&](const char* name, std::uint64_t memory, const std::filesystem::path& temporaryFolder) {
        WatchedFileSystem disk;
        BuildOptions options;
        options.memoryBytes = memory;
        options.temporaryFolder = temporaryFolder;
        options.fileSystem = &disk;
        options.checkpointSeconds = -1.0; // no file more where the build takes long
        const auto built = test::buildIndexOf(grid, folder / name, options);
        EXPECT_THAT(built, IsOk());
        return disk.created;
    };
    const test::TemporaryFolder elsewhere;
    EXPECT_EQ(build("wide.isx", std::uint64_t{1} << 30, {}).size(), 1u) << "nothing but the index";
    const auto created = build("tight.isx", kMinBuildMemoryBytes, elsewhere.path());
    ASSERT_EQ(created.size(), 2u) << "the sort did not spill";
    EXPECT_EQ(created[1].parent_path(), elsewhere.path());
    EXPECT_TRUE(test::readText(folder / "wide.isx") == test::readText(folder / "tight.isx"));
    EXPECT_TRUE(elsewhere.names().empty());
    EXPECT_EQ(folder.names(), (std::vector<std::string>{"tight.isx", "wide.isx"}));
}

// Smooth, with steps of 1 and `values` of them or so, and a few far away.
double steppedField(std::int64_t x, std::int64_t y, std::int64_t z, double values) {
    if (x == 17 && y == 3)
        return values + 30.0;
    const double wave = std::sin(0.11 * static_cast<double>(x)) + std::sin(0.07 * static_cast<double>(y + z)) +
                        std::sin(0.013 * static_cast<double>(z * x));
    return std::floor((wave + 3.0) / 6.0 * values);
}

template <class Sample>
std::vector<std::array<std::uint64_t, 5>> levelsOf(ScalarType type, const BuildOptions& options, double values) {
    const test::TemporaryFolder folder;
    GridGeometry geometry;
    geometry.dims = {110, 100, values > 1000.0 ? 97 : 40}; // 97: more points than are sampled
    const auto grid =
        test::makeVolume<Sample>(type, geometry, [&](auto x, auto y, auto z) { return steppedField(x, y, z, values); });
    const auto built = test::buildIndexOf(grid, folder / "a.isx", options);
    EXPECT_THAT(built, IsOk());
    std::vector<std::array<std::uint64_t, 5>> levels;
    for (const index::SkipLevelInfo& level : built.value().info.levels)
        levels.push_back({level.blocks, level.points, level.edges, level.activatedEdges, level.redundantRemoved});
    return levels;
}

// Values lie as they lie, whatever their bits.
TEST_P(BuildIndexKind, GivesTheSameLevelsForAFieldInEveryScalarType) {
    BuildOptions fixed = options();
    fixed.redundancyThreshold = 0.5;
    const std::size_t least = GetParam() == index::IndexKind::Edges ? 3 : 2;
    const auto few = levelsOf<std::uint8_t>(ScalarType::U8, fixed, 90);
    EXPECT_GE(few.size(), least);
    EXPECT_EQ(levelsOf<std::int8_t>(ScalarType::I8, fixed, 90), few);
    EXPECT_EQ(levelsOf<std::int32_t>(ScalarType::I32, fixed, 90), few);
    EXPECT_EQ(levelsOf<double>(ScalarType::F64, fixed, 90), few);
}

TEST_P(BuildIndexKind, GivesTheSameLevelsForManyValuesInEveryScalarType) {
    BuildOptions fixed = options();
    fixed.redundancyThreshold = 0.5;
    const std::size_t least = GetParam() == index::IndexKind::Edges ? 3 : 2;
    const auto many = levelsOf<std::int16_t>(ScalarType::I16, fixed, 5000);
    EXPECT_GE(many.size(), least);
    EXPECT_EQ(levelsOf<std::uint16_t>(ScalarType::U16, fixed, 5000), many);
    EXPECT_EQ(levelsOf<std::int32_t>(ScalarType::I32, fixed, 5000), many);
    EXPECT_EQ(levelsOf<float>(ScalarType::F32, fixed, 5000), many);
    EXPECT_EQ(levelsOf<double>(ScalarType::F64, fixed, 5000), many);
}

// The threshold, too, depends on the field and not on how it is stored.
TEST_P(BuildIndexKind, ChoosesTheSameThresholdInEveryScalarType) {
    const auto chosen = levelsOf<std::int16_t>(ScalarType::I16, options(), 5000);
    EXPECT_EQ(levelsOf<double>(ScalarType::F64, options(), 5000), chosen);
}

TEST(BuildEdges, RefuseABudgetWithoutRoomForTheirPlanes) {
    const test::TemporaryFolder folder;
    GridGeometry geometry;
    geometry.dims = {700, 400, 2};
    const auto grid =
        test::makeVolume<double>(ScalarType::F64, geometry, [](auto x, auto, auto) { return static_cast<double>(x); });
    BuildOptions options;
    options.kind = index::IndexKind::Edges;
    options.memoryBytes = kMinBuildMemoryBytes;
    const auto refused = test::buildIndexOf(grid, folder / "a.isx", options);
    ASSERT_THAT(refused, HasError(ErrorCode::InvalidArgument));
    EXPECT_NE(refused.error().line().find("at least 84M"), std::string::npos) << refused.error().line();
    EXPECT_TRUE(folder.names().empty());
    options.memoryBytes = std::uint64_t{84} << 20;
    EXPECT_THAT(test::buildIndexOf(grid, folder / "a.isx", options), IsOk());
}

TEST_P(BuildIndexKind, StatesTheFactsOfItsVolume) {
    for (std::uint64_t seed = test::testSeed(900), last = seed + 120; seed < last && !HasFailure(); ++seed) {
        test::Random random(seed);
        const test::RandomVolume volume = test::randomVolume(random, 24);
        if (!volume.hasFinite)
            continue;
        SCOPED_TRACE("seed " + std::to_string(seed) + ": " + volume.description);
        const test::TemporaryFolder folder;
        BuildOptions named = options();
        named.sourceName = "volume.raw";
        const auto built = test::buildIndexOf(volume.grid, folder / "a.isx", named);
        ASSERT_THAT(built, IsOk());
        const index::IndexInfo& info = built.value().info;
        const auto statistics = computeStatistics(*volume.grid);
        ASSERT_THAT(statistics, IsOk());
        EXPECT_EQ(info.min, statistics.value().min);
        EXPECT_EQ(info.max, statistics.value().max);
        EXPECT_EQ(info.distinctValues, statistics.value().distinctValues);
        EXPECT_EQ(info.nanCount, statistics.value().nanCount);
        EXPECT_EQ(info.histogram.min, statistics.value().histogram.min);
        EXPECT_EQ(info.histogram.max, statistics.value().histogram.max);
        EXPECT_EQ(info.sourceName, "volume.raw");
        EXPECT_EQ(info.geometry, volume.grid->geometry());
        EXPECT_EQ(info.type, volume.grid->type());
        EXPECT_EQ(info.kind, GetParam());
        EXPECT_THAT(kRedundancyChoices, testing::Contains(info.redundancyThreshold)) << "0 stands for these";
        EXPECT_EQ(info.indexBytes, std::filesystem::file_size(folder / "a.isx"));
        std::uint64_t counted = 0;
        for (const std::uint64_t count : info.histogram.counts)
            counted += count;
        EXPECT_EQ(counted + info.nanCount, static_cast<std::uint64_t>(pointCount(volume.grid->dims())));
        // The cost of an isovalue before a visit is what a visit finds.
        for (const std::size_t bin : {0, 1, 100, 256, 511}) {
            const double at = static_cast<double>(bin) / static_cast<double>(info.activeEdgesPerBin.size());
            const auto fresh = extract::extractFull(*volume.grid, info.min * (1.0 - at) + info.max * at);
            EXPECT_EQ(info.activeEdgesPerBin.at(bin), fresh.value().activeEdgeCount()) << "bin " << bin;
        }
    }
}

TEST_P(BuildIndexKind, PutsEverySampleIntoTheBinThatStatisticsPutItInto) {
    for (const auto& grid : {test::noiseVolume({20, 20, 20}, 3, 200), test::hillsVolume({20, 30, 20})}) {
        const test::TemporaryFolder folder;
        const auto built = test::buildIndexOf(grid, folder / "a.isx", options());
        ASSERT_THAT(built, IsOk());
        EXPECT_EQ(built.value().info.histogram.counts, computeStatistics(*grid).value().histogram.counts);
    }
}

TEST_P(BuildIndexKind, TakesConstantAndSmallestVolumes) {
    for (const GridDims& dims :
         {GridDims{1, 1, 1}, GridDims{5, 5, 5}, GridDims{1, 9, 9}, GridDims{2, 2, 2}, GridDims{9, 1, 1}}) {
        const test::TemporaryFolder folder;
        GridGeometry geometry;
        geometry.dims = dims;
        const auto grid = test::makeVolume<float>(ScalarType::F32, geometry, [](auto, auto, auto) { return 4.5f; });
        const auto built = test::buildIndexOf(grid, folder / "a.isx", options());
        ASSERT_THAT(built, IsOk());
        EXPECT_EQ(built.value().info.distinctValues, 1u);
        EXPECT_EQ(built.value().info.min, 4.5);
        EXPECT_EQ(built.value().info.max, 4.5);
        const auto engine = extract::SlideEngine::open(folder / "a.isx");
        ASSERT_THAT(engine, IsOk());
        for (const double isovalue : {4.0, 4.5, 5.0}) {
            ASSERT_THAT(engine.value()->slideTo(isovalue), IsOk());
            EXPECT_TRUE(engine.value()->mesh().value().positions.empty());
        }
    }
}

TEST(BuildIndex, RefusesOptionsThatCannotBe) {
    const test::TemporaryFolder folder;
    const auto grid = test::noiseVolume({4, 4, 4}, 1);
    const auto refuses = [&](auto change) {
        BuildOptions options;
        change(options);
        EXPECT_THAT(test::buildIndexOf(grid, folder / "a.isx", options), HasError(ErrorCode::InvalidArgument));
    };
    refuses([](BuildOptions& o) { o.skipLevels = 0; });
    refuses([](BuildOptions& o) { o.skipLevels = 9; });
    refuses([](BuildOptions& o) { o.skipLevels = -1; });
    refuses([](BuildOptions& o) { o.redundancyThreshold = -1.0; });
    refuses([](BuildOptions& o) { o.redundancyThreshold = std::numeric_limits<double>::quiet_NaN(); });
    refuses([](BuildOptions& o) { o.redundancyThreshold = std::numeric_limits<double>::infinity(); });
    refuses([](BuildOptions& o) { o.memoryBytes = kMinBuildMemoryBytes - 1; });
    refuses([](BuildOptions& o) { o.threads = -1; });
    EXPECT_THAT(test::buildIndexOf(grid, folder.path()), HasError(ErrorCode::InvalidArgument));
    EXPECT_THAT(test::buildIndexOf(grid, folder / "none/a.isx"), HasError(ErrorCode::NotFound));
    EXPECT_TRUE(folder.names().empty());
}

TEST_P(BuildIndexKind, RefusesAVolumeWithoutAFiniteSample) {
    const test::TemporaryFolder folder;
    const auto missing =
        test::makeVolume<float>(ScalarType::F32, test::cubeGeometry(3), [](auto, auto, auto) { return std::nanf(""); });
    EXPECT_THAT(test::buildIndexOf(missing, folder / "a.isx", options()), HasError(ErrorCode::InvalidArgument));
    EXPECT_TRUE(folder.names().empty());
}

// Eighteen planes must be there; the budget reports it before anything is read or written.
TEST(BuildMetacells, RefuseABudgetWithoutRoomForTheirPlanes) {
    const test::TemporaryFolder folder;
    GridGeometry geometry;
    geometry.dims = {1200, 1000, 2};
    const auto grid =
        test::makeVolume<double>(ScalarType::F64, geometry, [](auto x, auto, auto) { return static_cast<double>(x); });
    geometry.dims = {1200, 1000, 18};
    const auto thick =
        test::makeVolume<double>(ScalarType::F64, geometry, [](auto x, auto, auto) { return static_cast<double>(x); });
    BuildOptions options;
    options.kind = index::IndexKind::Metacells;
    options.memoryBytes = kMinBuildMemoryBytes;
    EXPECT_THAT(test::buildIndexOf(grid, folder / "a.isx", options), IsOk());
    const auto refused = test::buildIndexOf(thick, folder / "b.isx", options);
    ASSERT_THAT(refused, HasError(ErrorCode::InvalidArgument));
    EXPECT_NE(refused.error().line().find("at least 187M"), std::string::npos) << refused.error().line();
    EXPECT_EQ(folder.names(), std::vector<std::string>{"a.isx"});
    options.memoryBytes = std::uint64_t{187} << 20;
    EXPECT_THAT(test::buildIndexOf(thick, folder / "b.isx", options), IsOk());
}

// The samples come back as they were, and take no more room than they did.
TEST(BuildMetacells, KeepTheSamples) {
    for (std::uint64_t seed = test::testSeed(1900), last = seed + 40; seed < last && !HasFailure(); ++seed) {
        test::Random random(seed);
        const test::RandomVolume volume = test::randomVolume(random, 40);
        if (!volume.hasFinite)
            continue;
        SCOPED_TRACE("seed " + std::to_string(seed) + ": " + volume.description);
        const test::TemporaryFolder folder;
        BuildOptions options;
        options.kind = index::IndexKind::Metacells;
        ASSERT_THAT(test::buildIndexOf(volume.grid, folder / "a.isx", options), IsOk());
        const auto reader = index::IndexReader::open(folder / "a.isx");
        ASSERT_THAT(reader, IsOk());
        const index::SampleStore store(*reader.value());
        volume.grid->visit([&](auto values) {
            using Sample = std::remove_cv_t<typename decltype(values)::element_type>;
            const GridDims& dims = volume.grid->dims();
            std::vector<Sample> chunk(index::SampleStore::kChunkSamples);
            std::uint64_t bytesRead = 0;
            for (const index::ChunkIndex c : firstIds<index::ChunkIndex>(store.chunks().chunkCount())) {
                const std::span<Sample, index::SampleStore::kChunkSamples> out(chunk.data(), chunk.size());
                ASSERT_THAT(store.read<Sample>(c, out, bytesRead), IsOk());
                const auto at = store.chunks().chunkCoords(c);
                const auto extent = store.chunks().extent(c);
                for (int z = 0; z < extent[2]; ++z)
                    for (int y = 0; y < extent[1]; ++y)
                        for (int x = 0; x < extent[0]; ++x) {
                            const auto from = static_cast<std::size_t>(
                                16 * at[0] + x + dims[0] * (16 * at[1] + y + dims[1] * (16 * at[2] + z)));
                            const Sample* stored = &chunk[static_cast<std::size_t>(x + 16 * y + 256 * z)];
                            ASSERT_EQ(std::memcmp(stored, &values[from], sizeof(Sample)), 0) << "bit for bit";
                        }
            }
            EXPECT_LE(reader.value()->info().chunkBytes, values.size_bytes() + 2 * store.chunks().chunkCount());
        });
    }
}

TEST_P(BuildIndexKind, ReportsProgressThatRisesToTheEnd) {
    const test::TemporaryFolder folder;
    std::vector<double> fractions;
    JobControl job;
    job.progress = [&](double fraction, std::string_view stage) {
        fractions.push_back(fraction);
        EXPECT_FALSE(stage.empty());
    };
    ASSERT_THAT(test::buildIndexOf(test::hillsVolume({20, 20, 70}), folder / "a.isx", options(), job), IsOk());
    ASSERT_GT(fractions.size(), 5u);
    EXPECT_TRUE(std::is_sorted(fractions.begin(), fractions.end()));
    EXPECT_GE(fractions.front(), 0.0);
    EXPECT_LE(fractions.back(), 1.0);
}

} // namespace
} // namespace isoslider::preprocess
