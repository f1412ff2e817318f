// Power fails at any moment of a build: writes that were not synced are lost, all of them, some or none.

#include <random>

#include <gtest/gtest.h>

#include "core/extract/slide_engine.h"
#include "preprocess/build_index.h"
#include "tests/property/test_volumes.h"
#include "tests/support/recording_file_system.h"
#include "tests/support/result_matchers.h"
#include "tests/support/temporary_folder.h"

namespace isoslider::preprocess {
namespace {

class PowerLoss : public testing::TestWithParam<index::IndexKind> {};

TEST_P(PowerLoss, B090_LeavesTheEarlierIndexOrTheNewOne) {
    const test::TemporaryFolder folder;
    const auto path = folder / "a.isx";
    BuildOptions options;
    options.kind = GetParam();
    ASSERT_THAT(test::buildIndexOf(test::noiseVolume({6, 6, 6}, 8), path, options), test::IsOk());
    const std::string earlier = test::readText(path);
    test::RecordingFileSystem disk(defaultFileSystem());
    options.fileSystem = &disk;
    ASSERT_THAT(test::buildIndexOf(test::hillsVolume({24, 20, 33}), path, options), test::IsOk());
    const std::string later = test::readText(path);
    ASSERT_NE(earlier, later);

    std::mt19937 random(11);
    std::size_t withEarlier = 0, withLater = 0;
    for (std::size_t moment = 0; moment <= disk.calls().size(); ++moment)
        for (int chance = 0; chance < 6; ++chance) {
            // None of the unsynced writes survives, all do, or every second one at random.
            auto files = test::LostPower::after(disk.calls(), moment, [&] {
                return chance == 0 ? false : chance == 1 ? true : random() % 2 == 0;
            });
            const auto found = files.find(path);
            const std::string there =
                found == files.end()
                    ? earlier
                    : std::string(reinterpret_cast<const char*>(found->second.data()), found->second.size());
            ASSERT_TRUE(there == earlier || there == later) << "after call " << moment;
            (there == later ? withLater : withEarlier)++;
            // What lies beside it cannot be taken for an index, and is in nobody's way.
            for (const auto& [name, bytes] : files) {
                if (name == path || name.extension() != ".partial" || bytes.empty())
                    continue;
                const std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
                const auto opened = extract::SlideEngine::open(folder.write("beside.isx", text));
                ASSERT_TRUE(!opened.isOk() || text == later) << "after call " << moment;
            }
        }
    EXPECT_GT(withEarlier, 6u);
    EXPECT_GE(withLater, 6u);
}

// A state speaks only of what had been synced before it: whatever else the disk has lost, the build goes on from it.
TEST_P(PowerLoss, B090_LeavesABuildThatGoesOn) {
    const test::TemporaryFolder folder, after;
    const auto grid = test::hillsVolume({20, 12, 50});
    BuildOptions options;
    options.kind = GetParam();
    options.checkpointSeconds = 0.0;
    test::RecordingFileSystem disk(defaultFileSystem());
    options.fileSystem = &disk;
    ASSERT_THAT(test::buildIndexOf(grid, folder / "a.isx", options), test::IsOk());
    const std::string whole = test::readText(folder / "a.isx");
    options.fileSystem = nullptr;
    options.checkpointSeconds = 10.0;
    options.resumes = true;
    std::mt19937 random(12);
    std::size_t resumed = 0;
    for (std::size_t moment = 0; moment <= disk.calls().size(); ++moment)
        for (int chance = 0; chance < 3; ++chance) {
            const auto files = test::LostPower::after(disk.calls(), moment, [&] {
                return chance == 0 ? false : chance == 1 ? true : random() % 2 == 0;
            });
            for (const std::string& name : after.names())
                std::filesystem::remove(after / name);
            for (const auto& [name, bytes] : files)
                after.write(name.filename().string(), {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
            const auto built = test::buildIndexOf(grid, after / "a.isx", options);
            ASSERT_THAT(built, test::IsOk()) << "after call " << moment << " chance " << chance;
            ASSERT_TRUE(test::readText(after / "a.isx") == whole) << "after call " << moment;
            resumed += built.value().isResumed ? 1 : 0;
        }
    EXPECT_GT(resumed, 20u);
}

INSTANTIATE_TEST_SUITE_P(Kinds, PowerLoss, testing::Values(index::IndexKind::Edges, index::IndexKind::Metacells),
                         [](const auto& kind) { return std::string(index::indexKindName(kind.param)); });

} // namespace
} // namespace isoslider::preprocess
