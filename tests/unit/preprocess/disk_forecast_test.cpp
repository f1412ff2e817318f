// What a build will take of the disk: near the truth, and a build that has no room is refused before it writes.

#include "preprocess/forecast/disk_forecast.h"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/memory_file_system.h"
#include "core/index/format/index_format.h"
#include "core/index/index_reader.h"
#include "core/topology/stored_topology.h"
#include "core/topology/topology_analysis.h"
#include "preprocess/build_index.h"
#include "preprocess/forecast/metered_file_system.h"
#include "tests/property/random_volumes.h"
#include "tests/support/limited_file_system.h"
#include "tests/support/result_matchers.h"
#include "tests/support/temporary_folder.h"

namespace isoslider::preprocess {
namespace {

using test::HasError;
using test::IsOk;
using ::testing::HasSubstr;

// One of few in a volume of many, or all of them.
TEST(SpreadSample, TakesOneOfEachRun) {
    for (const auto& [total, count] : {std::pair<std::uint64_t, std::uint64_t>{1000, 7}, {16, 16}, {5, 16}, {1, 1}}) {
        const SpreadSample sample(total, count);
        ASSERT_EQ(sample.count(), std::min(total, count));
        for (std::uint64_t i = 0; i < sample.count(); ++i) {
            EXPECT_GE(sample.at(i), total * i / sample.count());
            EXPECT_LT(sample.at(i), total * (i + 1) / sample.count());
        }
    }
    EXPECT_NE(SpreadSample(1000, 7).at(3, 1), SpreadSample(1000, 7).at(3, 2));
}

struct ForecastCase {
    std::string name;
    std::function<std::shared_ptr<const ScalarGrid>()> make;
};

std::vector<ForecastCase> forecastCases() {
    // Linear in no direction: else differences between neighbouring values come again all over the range, which packs
    // well, and a part of the volume does not show.
    const auto waves = [](auto x, auto y, auto z) {
        return std::sin(0.11 * static_cast<double>(x)) + std::cos(0.07 * static_cast<double>(y + z)) +
               0.003 * static_cast<double>(z) + 0.00007 * static_cast<double>(z * z);
    };
    // Nothing but air for most of it: how full it is differs from layer to layer.
    const auto ball = [](auto x, auto y, auto z) {
        const auto square = [](auto a) { return static_cast<double>((a - 60) * (a - 60)); };
        return std::max(0.0, 200.0 - 8.0 * std::sqrt(square(x) + square(y) + square(z)));
    };
    return {
        {"NoiseOfBytes",
         [] {
             return test::noiseVolume({120, 112, 104}, 3, 250);
         }},
        {"NoiseOfFewBytes",
         [] {
             return test::noiseVolume({120, 112, 104}, 3, 4);
         }},
        {"SmoothWords",
         [] {
             return test::hillsVolume({130, 101, 120});
         }},
        {"SmoothFloats", [=] { return test::makeVolume<float>(ScalarType::F32, test::cubeGeometry(112), waves); }},
        {"SmoothDoubles", [=] { return test::makeVolume<double>(ScalarType::F64, test::cubeGeometry(80), waves); }},
        {"BallInAir", [=] { return test::makeVolume<std::uint8_t>(ScalarType::U8, test::cubeGeometry(128), ball); }},
        {"Constant",
         [] {
             return test::makeVolume<std::uint8_t>(ScalarType::U8, test::cubeGeometry(100),
                                                   [](auto, auto, auto) { return 7; });
         }},
        {"FloatsWithHoles",
         [=] {
             return test::makeVolume<float>(ScalarType::F32, test::cubeGeometry(96), [=](auto x, auto y, auto z) {
                 return (x * 7 + y * 5 + z * 3) % 11 == 0 ? std::numeric_limits<double>::quiet_NaN() : waves(x, y, z);
             });
         }},
        {"Plane",
         [] {
             return test::hillsVolume({400, 300, 1});
         }},
        {"Tiny",
         [] {
             return test::noiseVolume({3, 2, 2}, 1);
         }},
    };
}

class ForecastOfSize : public testing::TestWithParam<std::tuple<index::IndexKind, std::size_t>> {};

TEST_P(ForecastOfSize, IsNearTheTruth) {
    const auto [kind, number] = GetParam();
    const test::TemporaryFolder folder;
    BuildOptions options;
    options.kind = kind;
    const auto built = test::buildIndexOf(forecastCases()[number].make(), folder / "a.isx", options);
    ASSERT_THAT(built, IsOk());
    const auto truth = static_cast<double>(built.value().info.indexBytes);
    EXPECT_EQ(truth, static_cast<double>(std::filesystem::file_size(folder / "a.isx")));
    EXPECT_NEAR(static_cast<double>(built.value().forecast.indexBytes) / truth, 1.0, 0.15);
    EXPECT_LE(built.value().temporaryBytes, built.value().forecast.temporaryBytes);
}

INSTANTIATE_TEST_SUITE_P(Volumes, ForecastOfSize,
                         testing::Combine(testing::Values(index::IndexKind::Edges, index::IndexKind::Metacells),
                                          testing::Range(std::size_t{0}, forecastCases().size())),
                         [](const auto& test) {
                             return std::string(index::indexKindName(std::get<0>(test.param))) + "_" +
                                    forecastCases()[std::get<1>(test.param)].name;
                         });

// Events of one isovalue are one: of bytes there are far fewer than places where the topology changes.
TEST(DiskForecast, KnowsTopology) {
    const test::TemporaryFolder folder;
    for (const ForecastCase& of : forecastCases()) {
        SCOPED_TRACE(of.name);
        const auto grid = of.make();
        const auto path = folder / (of.name + ".isx");
        BuildOptions options;
        options.kind = index::IndexKind::Metacells;
        options.withTopology = true;
        const auto built = test::buildIndexOf(grid, path, options);
        ASSERT_THAT(built, IsOk());
        const auto curve = topology::analyseTopology(topology::planesOf(*grid));
        const auto reader = index::IndexReader::open(path);
        ASSERT_THAT(topology::storeTopology(*reader.value(), curve.value()), IsOk());
        const DiskForecast& forecast = built.value().forecast;
        const auto whole = static_cast<double>(std::filesystem::file_size(path));
        constexpr double kCurves = 8192.0; // which are not made here
        EXPECT_NEAR(static_cast<double>(forecast.indexBytes + forecast.topologyBytes), whole, 0.4 * whole + kCurves);
    }
}

TEST(DiskForecast, KnowsMergedCells) {
    const test::TemporaryFolder folder;
    BuildOptions options;
    options.mergeError = {extract::MergeBound::Measure::Distance, 0.25};
    const auto built = test::buildIndexOf(test::hillsVolume({80, 64, 72}), folder / "a.isx", options);
    ASSERT_THAT(built, IsOk());
    EXPECT_NEAR(static_cast<double>(built.value().forecast.indexBytes) /
                    static_cast<double>(built.value().info.indexBytes),
                1.0, 0.15);
}

// The sort's runs, in a budget that holds a part of them; and checkpoints, as often as there can be.
TEST(DiskForecast, BoundsTemporaryFiles) {
    const test::TemporaryFolder folder;
    BuildOptions options;
    options.memoryBytes = kMinBuildMemoryBytes;
    const auto spilled = test::buildIndexOf(test::noiseVolume({128, 128, 90}, 5, 250), folder / "a.isx", options);
    ASSERT_THAT(spilled, IsOk());
    EXPECT_GT(spilled.value().temporaryBytes, std::uint64_t{30} << 20);
    EXPECT_LE(spilled.value().temporaryBytes, spilled.value().forecast.temporaryBytes);
    EXPECT_GT(static_cast<double>(spilled.value().temporaryBytes),
              0.6 * static_cast<double>(spilled.value().forecast.temporaryBytes));
    for (const auto kind : {index::IndexKind::Edges, index::IndexKind::Metacells}) {
        options.kind = kind;
        options.checkpointSeconds = 0.0;
        const auto saved = test::buildIndexOf(test::hillsVolume({64, 64, 64}), folder / "b.isx", options);
        ASSERT_THAT(saved, IsOk());
        EXPECT_GT(saved.value().temporaryBytes, 0u);
        EXPECT_LE(saved.value().temporaryBytes, saved.value().forecast.temporaryBytes);
    }
}

class BuildWithoutRoom : public testing::TestWithParam<index::IndexKind> {
protected:
    void SetUp() override {
        options_.kind = GetParam();
        options_.fileSystem = &disk_;
        disk_.set(folder_.path(), std::numeric_limits<std::uint64_t>::max());
        const auto built = build();
        ASSERT_THAT(built, IsOk());
        forecast_ = built.value().forecast;
        created_ = disk_.created();
        folder_.write("a.isx", "an earlier file");
    }
    Result<BuildReport> build() { return test::buildIndexOf(grid_, folder_ / "a.isx", options_); }
    void expectRefusal(const std::string& what) {
        const auto refused = build();
        ASSERT_THAT(refused, HasError(ErrorCode::OutOfSpace));
        EXPECT_THAT(refused.error().line(), HasSubstr(what));
        EXPECT_EQ(disk_.created(), created_) << "nothing has been begun";
        EXPECT_EQ(test::readText(folder_ / "a.isx"), "an earlier file");
        EXPECT_EQ(folder_.names(), std::vector<std::string>{"a.isx"});
    }

    test::TemporaryFolder folder_;
    test::LimitedFileSystem disk_;
    BuildOptions options_;
    std::shared_ptr<const ScalarGrid> grid_ = test::noiseVolume({128, 128, 72}, 6, 200);
    DiskForecast forecast_;
    int created_ = 0;
};

TEST_P(BuildWithoutRoom, IsRefusedBeforeAnythingIsWritten) {
    ASSERT_GT(forecast_.temporaryBytes, 0u);
    const std::uint64_t needed = forecast_.indexBytes + forecast_.temporaryBytes;
    disk_.set(folder_.path(), needed - 1);
    expectRefusal("not enough free space: index and temporary files need about " + std::to_string(needed >> 20) +
                  " MiB, " + std::to_string((needed - 1) >> 20) + " MiB are free");
    disk_.set(folder_.path(), 0);
    expectRefusal("0 bytes are free");
    disk_.set(folder_.path(), needed);
    EXPECT_THAT(build(), IsOk());
}

// Which takes the place of temporary files.
TEST_P(BuildWithoutRoom, NeedsRoomForTopology) {
    options_.withTopology = true;
    const auto built = build();
    ASSERT_THAT(built, IsOk());
    const DiskForecast forecast = built.value().forecast;
    EXPECT_EQ(forecast.indexBytes, forecast_.indexBytes);
    ASSERT_GT(forecast.topologyBytes, 0u);
    folder_.write("a.isx", "an earlier file");
    created_ = disk_.created();
    const std::uint64_t needed = forecast.indexBytes + std::max(forecast.topologyBytes, forecast.temporaryBytes);
    disk_.set(folder_.path(), needed - 1);
    expectRefusal(forecast.topologyBytes > forecast.temporaryBytes ? "the index and its topology need"
                                                                   : "index and temporary files need");
    disk_.set(folder_.path(), needed);
    EXPECT_THAT(build(), IsOk());
}

TEST_P(BuildWithoutRoom, AsksTheDiskOfEachFolder) {
    const test::TemporaryFolder other;
    options_.temporaryFolder = other.path();
    disk_.set(folder_.path(), forecast_.indexBytes, 1);
    disk_.set(other.path(), forecast_.temporaryBytes - 1, 2);
    expectRefusal("temporary files need");
    disk_.set(other.path(), forecast_.temporaryBytes, 2);
    disk_.set(folder_.path(), forecast_.indexBytes - 1, 1);
    expectRefusal("the index needs");
    disk_.set(folder_.path(), forecast_.indexBytes, 1);
    EXPECT_THAT(build(), IsOk());
    EXPECT_TRUE(other.names().empty());
}

TEST_P(BuildWithoutRoom, GoesOnWhereTheSystemDoesNotStateWhatIsFree) {
    const test::TemporaryFolder unknown;
    EXPECT_THAT(test::buildIndexOf(grid_, unknown / "a.isx", options_), IsOk());
}

// What is there already needs no room.
TEST_P(BuildWithoutRoom, ThatGoesOnNeedsWhatIsStillMissing) {
    options_.resumes = true;
    options_.checkpointSeconds = 0.0;
    std::stop_source stop;
    JobControl job;
    job.stop = stop.get_token();
    job.progress = [&](double fraction, std::string_view) {
        if (fraction > 0.6)
            stop.request_stop();
    };
    ASSERT_THAT(test::buildIndexOf(grid_, folder_ / "a.isx", options_, job), HasError(ErrorCode::Cancelled));
    const std::uint64_t there = std::filesystem::file_size(folder_ / "a.isx.partial");
    ASSERT_GT(there, forecast_.indexBytes / 20);
    disk_.set(folder_.path(), 1000);
    const auto refused = build();
    ASSERT_THAT(refused, HasError(ErrorCode::OutOfSpace));
    EXPECT_TRUE(std::filesystem::exists(folder_ / "a.isx.resume")) << "it may go on once there is room";
    disk_.set(folder_.path(), forecast_.indexBytes + forecast_.temporaryBytes - there / 2);
    const auto resumed = build();
    ASSERT_THAT(resumed, IsOk());
    EXPECT_TRUE(resumed.value().isResumed);
    EXPECT_EQ(resumed.value().forecast.indexBytes, forecast_.indexBytes);
}

INSTANTIATE_TEST_SUITE_P(Kinds, BuildWithoutRoom, testing::Values(index::IndexKind::Edges, index::IndexKind::Metacells),
                         [](const auto& kind) { return std::string(index::indexKindName(kind.param)); });

TEST(MeteredFileSystem, CountsTheMostThatLayBesideTheFile) {
    const test::TemporaryFolder folder;
    MeteredFileSystem metered(defaultFileSystem(), folder / "a.isx");
    const std::vector<std::byte> bytes(1000);
    const auto index = AtomicFile::create(folder / "a.isx", metered);
    ASSERT_THAT(index, IsOk());
    ASSERT_THAT(index.value()->writeAll(bytes), IsOk());
    EXPECT_EQ(metered.mostBytes(), 0u);
    const auto runs = metered.create(folder / "runs");
    ASSERT_THAT(runs, IsOk());
    ASSERT_THAT(runs.value()->writeAll(bytes), IsOk());
    EXPECT_EQ(metered.mostBytes(), 1000u);
    for (int i = 0; i < 3; ++i)
        ASSERT_THAT(writeWholeFile(folder / "state", std::string(100, 'x'), metered), IsOk());
    EXPECT_EQ(metered.mostBytes(), 1200u) << "a state, and the one that replaces it";
    ASSERT_THAT(runs.value()->cut(10), IsOk());
    ASSERT_THAT(metered.removeFile(folder / "state"), IsOk());
    ASSERT_THAT(runs.value()->writeAll(std::span(bytes).first(990)), IsOk());
    EXPECT_EQ(metered.mostBytes(), 1200u);
    ASSERT_THAT(runs.value()->writeAll(std::span(bytes).first(500)), IsOk());
    EXPECT_EQ(metered.mostBytes(), 1500u);
    ASSERT_THAT(index.value()->publish(), IsOk());
}

TEST(FileSystemSpace, IsWhatTheSystemStates) {
    const test::TemporaryFolder folder;
    const auto space = defaultFileSystem().space(folder.path());
    ASSERT_THAT(space, IsOk());
    const auto stated = std::filesystem::space(folder.path());
    EXPECT_EQ(space.value().totalBytes, stated.capacity);
    EXPECT_LE(space.value().freeBytes, stated.free);
    std::filesystem::create_directory(folder / "below");
    EXPECT_EQ(defaultFileSystem().space(folder / "below").value().fileSystemId, space.value().fileSystemId);
    EXPECT_NE(defaultFileSystem().space("/proc").value().fileSystemId, space.value().fileSystemId);
    EXPECT_THAT(defaultFileSystem().space(folder / "none"), HasError(ErrorCode::NotFound));
    EXPECT_THAT(defaultFileSystem().space({}), IsOk()) << "where the program is";
    MemoryFileSystem memory;
    EXPECT_EQ(memory.space("anywhere").value().freeBytes, std::numeric_limits<std::uint64_t>::max());
}

} // namespace
} // namespace isoslider::preprocess
