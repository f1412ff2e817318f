// What the window's builds leave when they are cancelled, and what they do with what is there.

#include <gtest/gtest.h>

#include "app/desktop/preprocess_index_builder.h"
#include "core/volume_io/volume_reader.h"
#include "preprocess/build_index.h"
#include "tests/support/result_matchers.h"
#include "tests/support/small_disk.h"
#include "tests/support/temporary_folder.h"

namespace isoslider::desktop {
namespace {

using test::HasError;
using test::IsOk;

class PreprocessIndexBuilderTest : public testing::Test {
protected:
    /// 40 x 40 x `planes` bytes in waves of this length.
    std::filesystem::path writeVolume(int wave, int planes = 60) {
        std::string samples;
        for (int z = 0; z < planes; ++z)
            for (int y = 0; y < 40; ++y)
                for (int x = 0; x < 40; ++x)
                    samples += static_cast<char>((x * x + y * wave + z * x) % 120);
        folder_.write("waves.raw", samples);
        return folder_.write("waves.mhd", "ObjectType = Image\nNDims = 3\nDimSize = 40 40 " + std::to_string(planes) +
                                              "\nElementType = MET_UCHAR\nElementDataFile = waves.raw\n");
    }
    Status build(const std::filesystem::path& index, const JobControl& job = {}) {
        return builder_.buildFromFile(volume_, {}, "waves", index, job);
    }
    /// As a build of this program's that was killed leaves it; a short one would make no checkpoint.
    void leaveUnfinished(const std::filesystem::path& index) {
        preprocess::BuildOptions options;
        options.kind = index::IndexKind::Metacells;
        options.sourceName = "waves";
        options.resumes = true;
        options.checkpointSeconds = 0.0;
        std::stop_source stop;
        JobControl job;
        job.stop = stop.get_token();
        job.progress = [&](double fraction, std::string_view) {
            if (fraction > 0.7)
                stop.request_stop();
        };
        const auto source = io::openVolume(volume_);
        ASSERT_THAT(source, IsOk());
        ASSERT_THAT(preprocess::buildIndex(*source.value(), index, options, job), HasError(ErrorCode::Cancelled));
    }

    test::TemporaryFolder folder_;
    std::filesystem::path volume_ = writeVolume(7);
    PreprocessIndexBuilder builder_;
};

TEST_F(PreprocessIndexBuilderTest, GoesOnWithWhatWasLeft) {
    ASSERT_THAT(build(folder_ / "whole.isx"), IsOk());
    const auto index = folder_ / "a.isx";
    EXPECT_FALSE(builder_.hasUnfinished(index));
    leaveUnfinished(index);
    EXPECT_TRUE(builder_.hasUnfinished(index));
    double least = 1.0;
    JobControl job;
    job.progress = [&](double fraction, std::string_view) { least = std::min(least, fraction); };
    ASSERT_THAT(build(index, job), IsOk());
    EXPECT_GT(least, 0.3) << "what was there has been done again";
    EXPECT_EQ(test::readText(index), test::readText(folder_ / "whole.isx"));
    EXPECT_FALSE(builder_.hasUnfinished(index));
}

// The cache lies on a disk that is full, and on one that fills up meanwhile.
TEST_F(PreprocessIndexBuilderTest, LeavesAFullDiskAsItWas) {
    const test::SmallDisk disk(folder_ / "disk", 4);
    if (!disk.problem().empty())
        GTEST_SKIP() << disk.problem();
    const auto index = disk / "a.isx";
    disk.fill();
    EXPECT_THAT(build(index), HasError(ErrorCode::OutOfSpace));
    EXPECT_TRUE(disk.names().empty());
    disk.free();
    ASSERT_THAT(build(index), IsOk());
    const std::string before = test::readText(index);
    writeVolume(11, 64);
    JobControl job;
    job.progress = [&](double, std::string_view) { disk.fill(); };
    EXPECT_THAT(build(index, job), HasError(ErrorCode::OutOfSpace));
    EXPECT_EQ(test::readText(index), before);
    disk.free();
    ASSERT_THAT(build(index), IsOk());
    ASSERT_THAT(build(folder_ / "whole.isx"), IsOk());
    EXPECT_EQ(test::readText(index), test::readText(folder_ / "whole.isx"));
}

TEST_F(PreprocessIndexBuilderTest, StartsAgainWhenTheVolumeIsAnother) {
    const auto index = folder_ / "a.isx";
    leaveUnfinished(index);
    writeVolume(11, 64);
    ASSERT_THAT(build(index), IsOk());
    EXPECT_FALSE(builder_.hasUnfinished(index));
    ASSERT_THAT(build(folder_ / "whole.isx"), IsOk());
    EXPECT_EQ(test::readText(index), test::readText(folder_ / "whole.isx"));
}

TEST_F(PreprocessIndexBuilderTest, StaysUnfinishedWhenItIsCancelledAgain) {
    const auto index = folder_ / "a.isx";
    leaveUnfinished(index);
    std::stop_source stop;
    stop.request_stop();
    JobControl job;
    job.stop = stop.get_token();
    EXPECT_THAT(build(index, job), HasError(ErrorCode::Cancelled));
    EXPECT_TRUE(builder_.hasUnfinished(index));
    EXPECT_THAT(build(index), IsOk());
}

// A build that has nothing worth keeping leaves nothing.
TEST_F(PreprocessIndexBuilderTest, LeavesNothingOfAShortBuild) {
    std::stop_source stop;
    JobControl job;
    job.stop = stop.get_token();
    job.progress = [&](double fraction, std::string_view) {
        if (fraction > 0.5)
            stop.request_stop();
    };
    std::filesystem::create_directory(folder_ / "cache");
    EXPECT_THAT(build(folder_ / "cache/a.isx", job), HasError(ErrorCode::Cancelled));
    EXPECT_TRUE(std::filesystem::is_empty(folder_ / "cache"));
}

} // namespace
} // namespace isoslider::desktop
