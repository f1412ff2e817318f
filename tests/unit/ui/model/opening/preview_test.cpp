// Volumes that are too large for memory: a preview first, the index behind it, read from the file.
#include <cmath>
#include <limits>
#include <thread>

#include <gtest/gtest.h>

#include "core/volume_io/volume_reader.h"
#include "preprocess/build_index.h"
#include "preprocess/metacells/brick_list.h"
#include "tests/support/result_matchers.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/ui/main_thread_queue.h"
#include "ui/model/session/session.h"

namespace isoslider::model {
namespace {

using test::HasError;
using test::IsOk;
namespace fs = std::filesystem;

constexpr std::uint64_t kNoBound = std::numeric_limits<std::uint64_t>::max();

/// A MetaImage file of floats, value(x, y, z) at each grid point.
fs::path writeVolume(const test::TemporaryFolder& folder, const GridDims& dims,
                     const std::function<float(int, int, int)>& value) {
    std::string bytes = "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\nDimSize =";
    for (const auto n : dims)
        bytes += " " + std::to_string(n);
    bytes += "\nElementSpacing = 0.5 1 2\nElementType = MET_FLOAT\nElementDataFile = LOCAL\n";
    for (int z = 0; z < dims[2]; ++z)
        for (int y = 0; y < dims[1]; ++y)
            for (int x = 0; x < dims[0]; ++x) {
                const float sample = value(x, y, z);
                bytes.append(reinterpret_cast<const char*>(&sample), sizeof sample);
            }
    return folder.write("volume.mha", bytes);
}

/// Minus the distance from a grid point near the middle, so that 0 is the greatest value. That point and the
/// farthest one, which has the least, are at odd places: no preview has them.
constexpr int kBallDim = 24;
float ballValue(int x, int y, int z) {
    return -std::hypot(static_cast<float>(x) - 11.0f, static_cast<float>(y) - 11.0f, static_cast<float>(z) - 11.0f);
}
fs::path writeBall(const test::TemporaryFolder& folder) {
    return writeVolume(folder, {kBallDim, kBallDim, kBallDim}, ballValue);
}
constexpr std::uint64_t kBallBytes = std::uint64_t{kBallDim} * kBallDim * kBallDim * sizeof(float);

class PreviewTest : public ::testing::Test {
protected:
    Result<LoadedDataset> load(const fs::path& path, std::uint64_t wholeVolumeBytes, const JobControl& job = {}) {
        OpenRequest request;
        request.path = path;
        return loadDataset(request, IndexCache(folder_ / "cache"), {}, wholeVolumeBytes, job);
    }
    test::TemporaryFolder folder_;
};

TEST_F(PreviewTest, ReadsAllThatFitsAndNoMore) {
    const auto path = writeBall(folder_);
    const auto whole = load(path, kBallBytes);
    ASSERT_THAT(whole, IsOk());
    EXPECT_EQ(whole.value().dataset.coarseStep, 1);
    EXPECT_EQ(whole.value().grid->dims(), (GridDims{24, 24, 24}));
    EXPECT_GT(whole.value().dataset.distinctValues, 0u);
    EXPECT_TRUE(whole.value().dataset.values->spread.isExact);
    const auto preview = load(path, kBallBytes - 1);
    ASSERT_THAT(preview, IsOk());
    EXPECT_EQ(preview.value().dataset.coarseStep, 2);
    EXPECT_EQ(load(path, kBallBytes / 8).value().dataset.coarseStep, 2);
    EXPECT_EQ(load(path, kBallBytes / 8 - 1).value().dataset.coarseStep, 4);
}

TEST_F(PreviewTest, HasTheFileSamplesAtTheirPlaces) {
    const auto path = writeVolume(folder_, {13, 10, 7},
                                  [](int x, int y, int z) { return static_cast<float>(x + 100 * y + 10000 * z); });
    const auto read = load(path, 600);
    ASSERT_THAT(read, IsOk());
    const Dataset& dataset = read.value().dataset;
    const auto& grid = read.value().grid;
    EXPECT_EQ(dataset.coarseStep, 2);
    EXPECT_EQ(grid->dims(), (GridDims{7, 5, 4}));
    EXPECT_EQ(grid->geometry().spacing, glm::dvec3(1.0, 2.0, 4.0));
    EXPECT_EQ(grid->geometry().origin, dataset.geometry.origin);
    for (int z = 0; z < 4; ++z)
        for (int y = 0; y < 5; ++y)
            for (int x = 0; x < 7; ++x)
                EXPECT_EQ(grid->valueAt(x, y, z), 2 * x + 200 * y + 20000 * z);
    // What is known of the whole stays known.
    EXPECT_EQ(dataset.geometry.dims, (GridDims{13, 10, 7}));
    EXPECT_EQ(dataset.geometry.spacing, glm::dvec3(0.5, 1.0, 2.0));
    EXPECT_EQ(dataset.sampleBytes(), 13u * 10 * 7 * 4);
}

TEST_F(PreviewTest, CountsOnlyWhatItHasRead) {
    const auto path = writeVolume(folder_, {8, 8, 8}, [](int x, int y, int z) {
        if (x == 1 && y == 1 && z == 1)
            return 1000.0f; // between the samples
        return x == 2 && y == 2 && z == 2 ? std::numeric_limits<float>::quiet_NaN() : static_cast<float>(x);
    });
    const auto read = load(path, 1000);
    ASSERT_THAT(read, IsOk());
    const auto& dataset = read.value().dataset;
    EXPECT_EQ(dataset.min, 0.0);
    EXPECT_EQ(dataset.max, 6.0);
    EXPECT_EQ(dataset.distinctValues, 0u); // not counted
    EXPECT_EQ(dataset.missingSamples, 1u);
    std::uint64_t counted = 0;
    for (const auto count : dataset.histogram.counts)
        counted += count;
    EXPECT_EQ(counted, 63u);
    EXPECT_FALSE(dataset.values->spread.isExact);
}

TEST_F(PreviewTest, IsCancelledWhileItIsRead) {
    std::stop_source stop;
    JobControl job;
    job.stop = stop.get_token();
    std::vector<double> fractions;
    job.progress = [&](double fraction, std::string_view) {
        fractions.push_back(fraction);
        stop.request_stop();
    };
    EXPECT_THAT(load(writeBall(folder_), 5000, job), HasError(ErrorCode::Cancelled));
    ASSERT_EQ(fractions.size(), 1u);
    EXPECT_LT(fractions[0], 0.5);
}

TEST_F(PreviewTest, IsRefusedWhereItMakesNoGrid) {
    const auto flat = writeVolume(folder_, {20, 20, 3}, [](int x, int, int) { return static_cast<float>(x); });
    EXPECT_THAT(load(flat, 100), HasError(ErrorCode::OutOfSpace));
    EXPECT_THAT(load(flat, 1599),
                HasError(ErrorCode::OutOfSpace)); // a preview of 800 bytes, but a plane of 1600
    EXPECT_THAT(load(flat, 1600), IsOk());
}

TEST_F(PreviewTest, IsRefusedWhereItShowsNothing) {
    const auto path = writeVolume(folder_, {8, 8, 8}, [](int x, int, int) {
        return x % 2 == 0 ? std::numeric_limits<float>::quiet_NaN() : static_cast<float>(x);
    });
    const auto read = load(path, 1000);
    ASSERT_THAT(read, HasError(ErrorCode::InvalidArgument));
    EXPECT_NE(read.error().message.find("preview"), std::string::npos);
    const auto nothing =
        writeVolume(folder_, {8, 8, 8}, [](int, int, int) { return std::numeric_limits<float>::infinity(); });
    const auto whole = load(nothing, kNoBound);
    ASSERT_THAT(whole, HasError(ErrorCode::InvalidArgument));
    EXPECT_NE(whole.error().message.find("choose another file"), std::string::npos);
}

/// Builds from files; can be told to wait, to refuse, or to come upon another volume.
class FileBuilder final : public IndexBuilder {
public:
    Status build(const std::shared_ptr<const ScalarGrid>&, const std::string&, const io::VolumeInfo&, const fs::path&,
                 const JobControl&) override {
        ++gridBuilds;
        return makeError(ErrorCode::InvalidArgument, "was given samples, not a file");
    }
    Status buildFromFile(const fs::path& volume, const io::ReadOptions& options, const std::string& sourceName,
                         const fs::path& indexPath, const JobControl& job) override {
        ++fileBuilds;
        while (waits && !job.isStopRequested())
            std::this_thread::yield();
        if (job.isStopRequested())
            return cancelledError();
        if (refuses)
            return makeError(ErrorCode::OutOfSpace, "no room for the index");
        auto source = io::openVolume(volume, options);
        if (!source.isOk())
            return source.error();
        preprocess::BuildOptions build;
        build.sourceName = sourceName;
        build.kind = index::IndexKind::Metacells;
        auto report = preprocess::buildIndex(*source.value(), indexPath, build, job);
        return report.isOk() ? Status{} : Status{report.error()};
    }
    Result<std::unique_ptr<extract::SlideEngine>> engineInMemory(const std::shared_ptr<const ScalarGrid>& grid,
                                                                 const JobControl& job) override {
        return preprocess::makeMemoryEngine(grid, job);
    }
    std::atomic<int> gridBuilds{0};
    std::atomic<int> fileBuilds{0};
    std::atomic<bool> waits{true};
    std::atomic<bool> refuses{false};
};

class PreviewSessionTest : public PreviewTest {
protected:
    PreviewSessionTest() {
        SessionServices services;
        services.postToMain = queue_.poster();
        services.indexBuilder = builder_;
        services.cacheFolder = folder_ / "cache";
        services.wholeVolumeBytes = kBallBytes / 8;
        session_ = std::make_unique<Session>(std::move(services));
        subscription_ = session_->noticePosted().observe([this](const Notice& notice) { notices_.push_back(notice); });
    }
    void openBall(std::optional<double> isovalue = -6.0) {
        OpenRequest request;
        request.path = writeBall(folder_);
        request.isovalue = isovalue;
        session_->open(request);
        ASSERT_TRUE(queue_.runUntil([&] { return session_->frame() != nullptr; }));
        ASSERT_TRUE(session_->isPreview());
    }
    bool runUntilWhole() {
        builder_->waits = false;
        return queue_.runUntil([&] { return session_->frame()->isFromIndex; });
    }

    test::MainThreadQueue queue_;
    std::shared_ptr<FileBuilder> builder_ = std::make_shared<FileBuilder>();
    std::vector<Notice> notices_;
    std::unique_ptr<Session> session_;
    Subscription subscription_;
};

TEST_F(PreviewSessionTest, SlidesOnThePreviewMeanwhile) {
    openBall();
    EXPECT_EQ(session_->shownStep(), 2);
    EXPECT_EQ(session_->indexState(), IndexState::Building);
    EXPECT_EQ(session_->frame()->geometry.dims, (GridDims{12, 12, 12}));
    EXPECT_FALSE(session_->frame()->isWholeExtraction);
    EXPECT_EQ(session_->dataset()->geometry.dims, (GridDims{24, 24, 24}));
    const auto before = session_->frame()->stats.triangles;
    session_->isovalue().request(-4.0);
    ASSERT_TRUE(queue_.runUntil([&] { return session_->isovalue().displayed() == -4.0; }));
    EXPECT_LT(session_->frame()->stats.triangles, before);
    EXPECT_EQ(builder_->gridBuilds, 0);
}

TEST_F(PreviewSessionTest, TheIndexIsBuiltFromTheFileAndTakesOver) {
    openBall();
    session_->isovalue().request(-5.25);
    ASSERT_TRUE(queue_.runUntil([&] { return session_->isovalue().displayed() == -5.25; }));
    const auto coarse = session_->frame();
    EXPECT_LT(session_->isovalue().max(), 0.0); // the middle is between the preview's samples
    const double previewMin = session_->isovalue().min();
    ASSERT_TRUE(runUntilWhole());
    EXPECT_EQ(builder_->fileBuilds, 1);
    EXPECT_EQ(builder_->gridBuilds, 0);
    EXPECT_EQ(session_->frame()->isovalue, -5.25);
    EXPECT_EQ(session_->frame()->geometry, session_->dataset()->geometry);
    EXPECT_GT(session_->frame()->stats.triangles, 3 * coarse->stats.triangles);
    EXPECT_FALSE(session_->isPreview());
    EXPECT_EQ(session_->shownStep(), 1);
    // What the preview could only guess.
    EXPECT_EQ(session_->isovalue().requested(), -5.25);
    EXPECT_EQ(session_->isovalue().max(), 0.0);
    EXPECT_LT(session_->isovalue().min(), previewMin);
    EXPECT_EQ(session_->isovalue().max(), session_->dataset()->max);
    EXPECT_GT(session_->dataset()->distinctValues, 0u);
    EXPECT_TRUE(notices_.empty());
}

TEST_F(PreviewSessionTest, AnIsovalueThatThePreviewMissedIsHonouredByTheIndex) {
    openBall(-0.5);
    EXPECT_EQ(session_->isovalue().requested(), session_->isovalue().max());
    EXPECT_LT(session_->isovalue().max(), -0.5);
    ASSERT_TRUE(runUntilWhole());
    EXPECT_EQ(session_->frame()->isovalue, -0.5);
}

TEST_F(PreviewSessionTest, AHandleThatWasMovedStaysWhereItIs) {
    openBall(-0.5);
    session_->isovalue().request(-3.0);
    ASSERT_TRUE(runUntilWhole());
    EXPECT_EQ(session_->isovalue().requested(), -3.0);
}

TEST_F(PreviewSessionTest, IsNeitherCheckedNorExported) {
    openBall();
    session_->exportMesh(folder_ / "ball.ply", session_->datasetGeneration());
    session_->checkMesh();
    ASSERT_EQ(notices_.size(), 2u);
    EXPECT_EQ(notices_[0].title, "The mesh was not exported");
    EXPECT_EQ(notices_[0].detail, "the index is still being built; the preview is not exported");
    EXPECT_EQ(notices_[1].detail, "the index is still being built; the preview is not checked");
    EXPECT_FALSE(session_->isCheckingMesh());
    ASSERT_TRUE(runUntilWhole());
    session_->exportMesh(folder_ / "ball.ply", session_->datasetGeneration());
    ASSERT_TRUE(queue_.runUntil([&] { return session_->certificate().has_value(); }));
    EXPECT_EQ(session_->certificate()->geometry, session_->dataset()->geometry);
    EXPECT_TRUE(fs::exists(folder_ / "ball.ply"));
}

TEST_F(PreviewSessionTest, StaysWhenTheBuildIsCancelled) {
    openBall();
    session_->cancelJob(session_->jobs().entries().back().id);
    ASSERT_TRUE(queue_.runUntil([&] { return session_->indexState() == IndexState::Cancelled; }));
    EXPECT_TRUE(session_->isPreview());
    EXPECT_TRUE(notices_.empty());
    session_->isovalue().request(-4.0);
    ASSERT_TRUE(queue_.runUntil([&] { return session_->isovalue().displayed() == -4.0; }));
    EXPECT_TRUE(session_->refusesExport());
    EXPECT_EQ(notices_.at(0).detail, "the volume has no index; build it first, the preview is not exported");
    session_->buildIndex();
    ASSERT_TRUE(runUntilWhole());
}

TEST_F(PreviewSessionTest, StaysWhenTheBuildFails) {
    builder_->refuses = true;
    openBall();
    builder_->waits = false;
    ASSERT_TRUE(queue_.runUntil([&] { return session_->indexState() == IndexState::Failed; }));
    ASSERT_EQ(notices_.size(), 1u);
    EXPECT_EQ(notices_[0].title, "The index could not be built; the preview stays");
    EXPECT_TRUE(session_->isPreview());
    EXPECT_EQ(session_->shownStep(), 2);
    EXPECT_TRUE(session_->isSettled());
}

TEST_F(PreviewSessionTest, AFileThatChangedMeanwhileIsNotMixedWithItsPreview) {
    openBall();
    const auto preview = session_->frame();
    writeVolume(folder_, {10, 10, 10}, ballValue);
    builder_->waits = false;
    ASSERT_TRUE(queue_.runUntil([&] { return session_->indexState() == IndexState::Failed; }));
    ASSERT_EQ(notices_.size(), 1u);
    EXPECT_NE(notices_[0].detail.find("was changed after it was opened"), std::string::npos);
    EXPECT_EQ(session_->frame(), preview);
}

TEST_F(PreviewSessionTest, ASecondOpenNeedsNoPreview) {
    openBall();
    ASSERT_TRUE(runUntilWhole());
    OpenRequest request;
    request.path = folder_ / "volume.mha";
    session_->open(request);
    ASSERT_TRUE(queue_.runUntil([&] { return session_->isSettled(); }));
    EXPECT_TRUE(session_->frame()->isFromIndex);
    EXPECT_EQ(session_->dataset()->coarseStep, 1);
    EXPECT_EQ(builder_->fileBuilds, 1);
}

} // namespace
} // namespace isoslider::model
