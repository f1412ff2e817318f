// Events of volumes with more of them than memory holds: what is found goes to a file meanwhile.

#include <cerrno>
#include <climits>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/topology/topology_analysis.h"
#include "tests/support/faulty_file_system.h"
#include "tests/support/limited_file_system.h"
#include "tests/support/result_matchers.h"
#include "tests/support/temporary_folder.h"

namespace isoslider::topology {
namespace {

using test::HasError;
using test::IsOk;

// Layers take half of it, events of noise several times as much.
constexpr std::uint64_t kLittleMemory = 3 << 20;

template <class Sample, class Draw>
ScalarGrid gridOf(ScalarType type, const Draw& draw, int width = 40) {
    GridGeometry geometry;
    geometry.dims = {width, width, 60};
    std::vector<Sample> samples;
    for (int z = 0; z < 60; ++z)
        for (int y = 0; y < width; ++y)
            for (int x = 0; x < width; ++x)
                samples.push_back(static_cast<Sample>(draw(x, y, z)));
    return ScalarGrid::fromValues<Sample>(geometry, type, samples);
}

ScalarGrid noise(int width = 40) {
    std::mt19937 random(1);
    std::uniform_real_distribution<float> unit(-1.0F, 1.0F);
    return gridOf<float>(
        ScalarType::F32, [&](int, int, int) { return unit(random); }, width);
}

enum class Ties { None, Some }; ///< where isovalues repeat, any of several places may be stated

void expectTheEventsOfMemory(const ScalarGrid& grid, Ties ties = Ties::None) {
    const auto held = analyseTopology(planesOf(grid));
    ASSERT_THAT(held, IsOk());
    const test::TemporaryFolder folder;
    test::FaultyFileSystem counting(INT_MAX, EIO);
    AnalysisOptions options;
    options.memoryBytes = kLittleMemory;
    ASSERT_THAT(analyseTopology(planesOf(grid), options), HasError(ErrorCode::OutOfSpace)) << "without a file";
    options.scratch = folder / "found";
    options.fileSystem = &counting;
    options.boundaryPointsAtOnce = 3;
    const auto parted = analyseTopology(planesOf(grid), options);
    ASSERT_THAT(parted, IsOk());
    EXPECT_GT(counting.calls(), 10) << "the file was used";
    EXPECT_TRUE(folder.names().empty()) << "it has no name";
    EXPECT_EQ(parted.value().areCountsExact(), held.value().areCountsExact());
    std::vector<TopologyEvent> events;
    ASSERT_THAT(parted.value().visitEvents([&](const TopologyEvent& event) {
        events.push_back(event);
        return true;
    }),
                IsOk());
    const std::vector<TopologyEvent> expected = held.value().events();
    ASSERT_EQ(events.size(), expected.size());
    for (std::size_t i = 0; i < events.size(); ++i) {
        ASSERT_EQ(events[i].isovalue, expected[i].isovalue);
        ASSERT_EQ(events[i].below, expected[i].below) << events[i].isovalue;
        ASSERT_EQ(events[i].above, expected[i].above) << events[i].isovalue;
        ASSERT_EQ(events[i].pieces, expected[i].pieces) << events[i].isovalue;
        ASSERT_EQ(events[i].persistence, expected[i].persistence) << events[i].isovalue;
        if (ties == Ties::None) {
            ASSERT_EQ(events[i].position, expected[i].position) << events[i].isovalue;
            ASSERT_EQ(events[i].kind, expected[i].kind) << events[i].isovalue;
        }
    }
}

TEST(ScratchAnalysis, FindsTheEventsOfNoise) { expectTheEventsOfMemory(noise()); }

// Changes of one isovalue lie in many runs.
TEST(ScratchAnalysis, FindsTheEventsOfValuesThatRepeat) {
    std::mt19937 random(2);
    std::uniform_int_distribution<int> integers(-2000, 2000);
    expectTheEventsOfMemory(gridOf<std::int16_t>(ScalarType::I16, [&](int, int, int) { return integers(random); }),
                            Ties::Some);
}

TEST(ScratchAnalysis, FindsTheEventsWhereSamplesAreMissing) {
    std::mt19937 random(3);
    std::uniform_real_distribution<float> unit(-1.0F, 1.0F);
    expectTheEventsOfMemory(gridOf<float>(ScalarType::F32, [&](int x, int y, int z) {
        const bool isHollow = std::hypot(x - 20, y - 20, z - 30) < 5, isTunnel = std::abs(x - 30) < 2 && y < 4;
        return isHollow || isTunnel ? std::numeric_limits<float>::quiet_NaN() : unit(random);
    }));
}

AnalysisOptions littleMemory(const ScalarGrid& grid, const test::TemporaryFolder& folder) {
    AnalysisOptions options;
    options.memoryBytes = kLittleMemory;
    options.measures = planMeasures(grid);
    options.scratch = folder / "found";
    return options;
}

// A file that fails is done without: here that is too little memory for events.
TEST(ScratchAnalysis, MakesCountsWhereTheFileFails) {
    using Fails = test::FaultyFileSystem::Fails;
    const ScalarGrid grid = noise(20); // a quarter of it, as the whole is analysed again and again
    const test::TemporaryFolder folder;
    AnalysisOptions options = littleMemory(grid, folder);
    options.memoryBytes = kLittleMemory / 4;
    for (const Fails fails : {Fails::Writing, Fails::Reading}) {
        int failed = 0;
        for (int call = 0; call < INT_MAX; call += 1 + 3 * call) {
            SCOPED_TRACE(testing::Message() << (fails == Fails::Reading ? "reading " : "writing ") << call);
            test::FaultyFileSystem faulty(call, call % 2 == 0 ? EIO : ENOSPC, fails);
            std::string problem;
            options.fileSystem = &faulty;
            options.scratchProblem = &problem;
            const auto found = analyseTopology(planesOf(grid), options);
            ASSERT_THAT(found, IsOk());
            EXPECT_TRUE(folder.names().empty());
            if (faulty.calls() <= call)
                break;
            ++failed;
            EXPECT_FALSE(found.value().hasEvents());
            EXPECT_NE(problem.find(fails == Fails::Reading ? "cannot read" : "cannot write"), std::string::npos)
                << problem;
        }
        EXPECT_GT(failed, 3);
    }
    test::FaultyFileSystem full(0, ENOSPC);
    options.fileSystem = &full;
    options.scratchProblem = nullptr;
    options.mayLackEvents = false;
    const auto found = analyseTopology(planesOf(grid), options);
    ASSERT_THAT(found, HasError(ErrorCode::OutOfSpace));
    EXPECT_NE(found.error().message.find("cannot write"), std::string::npos) << found.error().message;
}

// What the place of the file is like shows before anything is found.
TEST(ScratchAnalysis, ReadsNothingTwiceWhereTheFileCannotBeMade) {
    const ScalarGrid grid = noise();
    const test::TemporaryFolder folder;
    AnalysisOptions options = littleMemory(grid, folder);
    options.memoryBytes = std::uint64_t{1} << 30;
    options.scratch = folder / "is not there" / "found";
    PlaneSource source = planesOf(grid);
    std::int64_t planes = 0;
    source.read = [&planes, read = source.read](std::int64_t zBegin, std::int64_t zEnd, std::span<std::byte> out) {
        planes += zEnd - zBegin;
        return read(zBegin, zEnd, out);
    };
    std::string problem;
    options.scratchProblem = &problem;
    const auto found = analyseTopology(source, options);
    ASSERT_THAT(found, IsOk());
    EXPECT_TRUE(found.value().hasEvents());
    EXPECT_FALSE(problem.empty());
    EXPECT_EQ(planes, grid.dims()[2]);
}

TEST(ScratchAnalysis, LeavesADiskAloneThatDoesNotHoldWhatIsFound) {
    const ScalarGrid grid = noise();
    const test::TemporaryFolder folder;
    AnalysisOptions options = littleMemory(grid, folder);
    // 2.9 million bytes of changes, and half a million of events that memory does not hold either.
    for (const auto& [freeBytes, isEnough] :
         {std::pair(100'000u, false), {3'000'000u, false}, {4'000'000u, true}, {100'000'000u, true}}) {
        test::LimitedFileSystem disk;
        disk.set(folder.path(), freeBytes);
        options.fileSystem = &disk;
        const auto found = analyseTopology(planesOf(grid), options);
        ASSERT_THAT(found, IsOk());
        EXPECT_EQ(found.value().hasEvents(), isEnough) << freeBytes;
        EXPECT_EQ(disk.created(), isEnough ? 2 : 0) << freeBytes;
    }
}

} // namespace
} // namespace isoslider::topology
