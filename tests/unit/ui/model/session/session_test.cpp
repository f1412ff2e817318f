#include "ui/model/session/session.h"

#include <gtest/gtest.h>

#include "core/base/machine.h"
#include "core/index/index_reader.h"
#include "core/topology/stored_topology.h"
#include "core/topology/topology_curve.h"
#include "core/volume_io/sources/volume_source.h"
#include "preprocess/build_index.h"
#include "tests/support/damaged_index.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/ui/main_thread_queue.h"

namespace isoslider::model {
namespace {

/// Distance from the middle of an 18^3 grid, negated: a ball, brighter inside.
std::shared_ptr<const ScalarGrid> ballGrid(double spacing = 1.0) {
    GridGeometry geometry;
    geometry.spacing = glm::dvec3(spacing);
    geometry.dims = {18, 18, 18};
    std::vector<float> values;
    for (int z = 0; z < 18; ++z)
        for (int y = 0; y < 18; ++y)
            for (int x = 0; x < 18; ++x)
                values.push_back(-std::hypot(x - 8.5f, y - 8.5f, z - 8.5f));
    return std::make_shared<ScalarGrid>(ScalarGrid::fromValues<float>(geometry, ScalarType::F32, values));
}

/// Refuses, or waits to be cancelled.
class FakeBuilder final : public IndexBuilder {
public:
    Status build(const std::shared_ptr<const ScalarGrid>&, const std::string&, const io::VolumeInfo&,
                 const std::filesystem::path&, const JobControl& job) override {
        nice = threadNice();
        ++builds;
        while (waits && !job.isStopRequested())
            std::this_thread::yield();
        return waits ? cancelledError() : makeError(ErrorCode::OutOfSpace, "no room for the index");
    }
    Status buildFromFile(const std::filesystem::path&, const io::ReadOptions&, const std::string&,
                         const std::filesystem::path&, const JobControl&) override {
        return makeError(ErrorCode::InvalidArgument, "was given a file, not samples");
    }
    Result<std::unique_ptr<extract::SlideEngine>> engineInMemory(const std::shared_ptr<const ScalarGrid>&,
                                                                 const JobControl& job) override {
        while (holdsEngine && !job.isStopRequested()) {
            job.report(0.5, "looking at samples");
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
        }
        if (job.isStopRequested())
            return cancelledError();
        return std::unique_ptr<extract::SlideEngine>();
    }
    std::atomic<bool> holdsEngine{false};
    std::atomic<int> builds{0};
    std::atomic<int> nice{0}; ///< of the last build
    std::atomic<bool> waits{false};
};

class SessionTest : public ::testing::Test {
protected:
    SessionTest() {
        SessionServices services;
        services.postToMain = queue_.poster();
        services.indexBuilder = builder_;
        services.cacheFolder = folder_ / "cache";
        services.backgroundPriority = JobPriority::Low;
        services.sampleLoader = [this](const std::string& name,
                                       const JobControl&) -> Result<std::shared_ptr<const ScalarGrid>> {
            loadingNice_ = threadNice();
            if (name == "ball")
                return ballGrid();
            if (name == "tiny") // areas too small for a number: every triangle counts as degenerate
                return ballGrid(1e-170);
            return makeError(ErrorCode::NotFound, "no such sample", name);
        };
        session_ = std::make_unique<Session>(std::move(services));
        subscription_ = session_->noticePosted().observe([this](const Notice& notice) { notices_.push_back(notice); });
    }

    void openBall(const std::string& name = "ball") {
        OpenRequest request;
        request.sampleName = name;
        request.isovalue = -5.0;
        session_->open(request);
        ASSERT_TRUE(queue_.runUntil([&] { return session_->frame() != nullptr; }));
    }

    test::TemporaryFolder folder_;
    test::MainThreadQueue queue_;
    std::atomic<int> loadingNice_{0};
    std::shared_ptr<FakeBuilder> builder_ = std::make_shared<FakeBuilder>();
    std::vector<Notice> notices_;
    std::unique_ptr<Session> session_;
    Subscription subscription_;
};

TEST(Dataset, NamesOfFilesBeginWithoutTheSuffix) {
    const auto stemOf = [](const std::string& name) {
        Dataset dataset;
        dataset.name = name;
        dataset.path = "/data/" + name;
        return fileStem(dataset);
    };
    EXPECT_EQ(stemOf("brain.nii.gz"), "brain");
    EXPECT_EQ(stemOf("map.MRC.GZ"), "map");
    EXPECT_EQ(stemOf("charges.cube.gz"), "charges");
    EXPECT_EQ(stemOf("ball_1.5.nii.gz"), "ball_1.5");
    EXPECT_EQ(stemOf("ball_1.5.nrrd"), "ball_1.5");
    EXPECT_EQ(stemOf("überall.isx"), "überall");
    EXPECT_EQ(stemOf("slices"), "slices");
    Dataset sample;
    sample.name = "Charges, no. 2";
    EXPECT_EQ(fileStem(sample), sample.name);
}

TEST_F(SessionTest, ShowsASurfaceBeforeThereIsAnIndex) {
    builder_->waits = true;
    openBall();
    EXPECT_EQ(session_->isovalue().displayed(), -5.0);
    EXPECT_FALSE(session_->frame()->isFromIndex);
    EXPECT_GT(session_->frame()->stats.triangles, 100u);
    EXPECT_EQ(session_->indexState(), IndexState::Building);
    EXPECT_FALSE(session_->isSettled());
}

TEST_F(SessionTest, TheIndexGivesWayAndTheVolumeDoesNot) {
    openBall();
    ASSERT_TRUE(queue_.runUntil([&] { return builder_->builds == 1; }));
    EXPECT_EQ(loadingNice_, threadNice()) << "it is waited for";
    EXPECT_GE(builder_->nice, 10);
}

TEST_F(SessionTest, TheFirstSurfaceShowsProgressCanBeStoppedAndAskedForAgain) {
    builder_->waits = true;
    builder_->holdsEngine = true;
    OpenRequest request;
    request.sampleName = "ball";
    request.isovalue = -5.0;
    session_->open(request);
    ASSERT_TRUE(queue_.runUntil([&] { return session_->moveProgress() > 0.1; }));
    EXPECT_LT(session_->moveProgress(), 0.5) << "the surface itself is still to come";
    EXPECT_TRUE(session_->isMoving());
    EXPECT_EQ(session_->indexState(), IndexState::None) << "the first surface has the processor for itself";
    session_->stopMove();
    EXPECT_FALSE(session_->isMoving());
    EXPECT_TRUE(session_->hasStoppedMove());
    EXPECT_EQ(session_->moveProgress(), 0.0);
    ASSERT_TRUE(queue_.runUntil([&] { return builder_->builds == 1; })) << "the index is built all the same";
    builder_->holdsEngine = false;
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    queue_.runAll();
    EXPECT_EQ(session_->frame(), nullptr);
    EXPECT_TRUE(notices_.empty()) << notices_[0].title;
    session_->moveAgain();
    EXPECT_FALSE(session_->hasStoppedMove());
    ASSERT_TRUE(queue_.runUntil([&] { return session_->frame() != nullptr; }));
    EXPECT_EQ(session_->frame()->isovalue, -5.0);
    session_->stopMove(); // there is none
    EXPECT_FALSE(session_->hasStoppedMove());
}

TEST_F(SessionTest, B106_ALimitedPictureIsCoarserAndTheMeshIsWhole) {
    openBall();
    const auto whole = session_->frame();
    session_->limitPicture(extract::pictureBytes(*whole) / 2);
    EXPECT_FALSE(session_->isSettled());
    ASSERT_TRUE(queue_.runUntil([&] { return session_->frame() != whole; }));
    const auto coarse = session_->frame();
    EXPECT_EQ(coarse->mergedCells, 2);
    EXPECT_EQ(coarse->isovalue, whole->isovalue);
    EXPECT_EQ(coarse->stats.triangles, whole->stats.triangles);
    session_->exportMesh(folder_ / "ball.ply", session_->datasetGeneration());
    ASSERT_TRUE(queue_.runUntil([&] { return session_->certificate().has_value(); }));
    EXPECT_EQ(session_->certificate()->report.triangles, whole->stats.triangles);
    session_->isovalue().request(-2.0); // a small sphere
    ASSERT_TRUE(queue_.runUntil([&] { return session_->frame()->isovalue == -2.0; }));
    EXPECT_EQ(session_->frame()->mergedCells, 1);
    // The limit was for that volume.
    openBall();
    ASSERT_TRUE(queue_.runUntil([&] { return session_->frame() && session_->frame()->isovalue == -5.0; }));
    EXPECT_EQ(session_->frame()->mergedCells, 1);
}

TEST_F(SessionTest, WhoeverShowsAFrameCanHoldTheNextMoveBeforeItBegins) {
    openBall();
    const auto subscription = session_->frameChanged().observe([&, post = queue_.poster()] {
        std::this_thread::sleep_for(std::chrono::milliseconds(20)); // time for a move that would not wait
        post([&] { session_->holdMoves(true); }); // as a view that asks for its picture first
    });
    session_->isovalue().request(-6.0);
    ASSERT_TRUE(queue_.runUntil([&] {
        session_->isovalue().request(session_->frame()->isovalue == -5.0 ? -6.0 : -7.0);
        return session_->frame()->isovalue == -6.0;
    }));
    EXPECT_FALSE(queue_.runUntil([&] { return session_->frame()->isovalue != -6.0; }, std::chrono::milliseconds(100)));
    session_->holdMoves(false);
    EXPECT_TRUE(queue_.runUntil([&] { return session_->frame()->isovalue == -7.0; }));
}

TEST_F(SessionTest, TheHandleDrivesWholeExtractionMeanwhile) {
    builder_->waits = true;
    openBall();
    const auto before = session_->frame()->stats.triangles;
    session_->isovalue().request(-3.0);
    EXPECT_TRUE(session_->isovalue().isLagging());
    ASSERT_TRUE(queue_.runUntil([&] { return !session_->isovalue().isLagging(); }));
    EXPECT_LT(session_->frame()->stats.triangles, before);
}

TEST_F(SessionTest, AFailedBuildIsToldAndCanBeStartedAgain) {
    openBall();
    ASSERT_TRUE(queue_.runUntil([&] { return session_->indexState() == IndexState::Failed; }));
    ASSERT_EQ(notices_.size(), 1u);
    EXPECT_EQ(notices_[0].code, ErrorCode::OutOfSpace);
    EXPECT_TRUE(session_->isSettled());
    session_->buildIndex();
    ASSERT_TRUE(queue_.runUntil([&] { return notices_.size() == 2; }));
    EXPECT_EQ(builder_->builds, 2);
}

/// A ball's index, with a byte changed where opening it does not look and the first move does.
std::filesystem::path damagedIndex(const test::TemporaryFolder& folder) {
    const auto path = folder / "damaged.isx";
    io::VolumeInfo info;
    const auto source = io::makeMemorySource(ballGrid(), std::move(info));
    EXPECT_TRUE(preprocess::buildIndex(*source, path, {}).isOk());
    test::damageFirstMove(path, -5.0);
    return path;
}

TEST_F(SessionTest, AFirstMoveThatFailsEndsTheWaiting) {
    OpenRequest request;
    request.path = damagedIndex(folder_);
    request.isovalue = -5.0;
    session_->open(request);
    ASSERT_TRUE(queue_.runUntil([&] { return !notices_.empty(); }));
    EXPECT_EQ(notices_[0].code, ErrorCode::Corruption);
    ASSERT_NE(session_->dataset(), nullptr);
    EXPECT_EQ(session_->frame(), nullptr);
    EXPECT_FALSE(session_->isMoving());
    EXPECT_TRUE(session_->isSettled());
    session_->isovalue().request(-5.5);
    EXPECT_TRUE(session_->isMoving()) << "the next one is waited for again";
}

/// An index of a ball; its topology is added when it is opened for the first time.
std::filesystem::path ballIndex(const test::TemporaryFolder& folder) {
    const auto path = folder / "ball.isx";
    const auto source = io::makeMemorySource(ballGrid(), io::VolumeInfo());
    preprocess::BuildOptions options;
    options.kind = index::IndexKind::Metacells;
    EXPECT_TRUE(preprocess::buildIndex(*source, path, options).isOk());
    return path;
}

TEST_F(SessionTest, TheFirstIsovalueGivesWayToTheBest) {
    OpenRequest request;
    request.path = ballIndex(folder_);
    session_->open(request);
    ASSERT_TRUE(queue_.runUntil([&] { return session_->topology().state() == TopologyState::Ready; }));
    const double first = session_->isovalue().requested();
    ASSERT_EQ(session_->suggestions().back(), (SuggestedIsovalue{first, kHistogramReason}));
    EXPECT_EQ(session_->firstIsovalue().reason(), kHistogramReason);
    const SuggestedIsovalue best = session_->suggestions().front();
    ASSERT_NE(best.isovalue, first);
    session_->improveFirstIsovalue();
    EXPECT_EQ(session_->isovalue().requested(), best.isovalue);
    EXPECT_EQ(session_->firstIsovalue().reason(), best.reason);
    session_->isovalue().request(first);
    EXPECT_EQ(session_->firstIsovalue().reason(), "");
    session_->improveFirstIsovalue();
    EXPECT_EQ(session_->isovalue().requested(), first);
    // The topology is stored now: the best is the first.
    session_->open(request);
    ASSERT_TRUE(queue_.runUntil([&] { return session_->firstIsovalue().isovalue().has_value(); }));
    EXPECT_EQ(session_->isovalue().requested(), best.isovalue);
    EXPECT_EQ(session_->firstIsovalue().reason(), best.reason);
    EXPECT_FALSE(session_->firstIsovalue().canImprove());
    session_->close();
    EXPECT_FALSE(session_->firstIsovalue().isovalue());
    EXPECT_TRUE(session_->suggestions().empty());
}

TEST_F(SessionTest, EventsAreAddedToAnIndexThatHasCountsOnly) {
    OpenRequest request;
    request.path = ballIndex(folder_);
    {
        const auto reader = index::IndexReader::open(request.path);
        ASSERT_TRUE(reader.isOk());
        const topology::TopologyCurve counts(topology::EventPages(), {}, true,
                                             false); // as a build with little memory leaves it
        ASSERT_TRUE(topology::storeTopology(*reader.value(), counts).isOk());
    }
    session_->open(request);
    ASSERT_TRUE(queue_.runUntil([&] { return session_->topology().state() == TopologyState::Ready; }));
    EXPECT_FALSE(session_->topology().hasEvents()) << "the counts serve meanwhile";
    ASSERT_TRUE(queue_.runUntil([&] { return session_->topology().hasEvents(); }));
    EXPECT_GT(session_->topology().eventCount(), 0u);
    session_->open(request);
    ASSERT_TRUE(queue_.runUntil([&] { return session_->topology().state() == TopologyState::Ready; }));
    EXPECT_TRUE(session_->topology().hasEvents()) << "they are stored now";
}

TEST_F(SessionTest, AnIsovalueAskedForStays) {
    OpenRequest request;
    request.path = ballIndex(folder_);
    request.isovalue = -5.0;
    for (int time = 0; time < 2; ++time) { // without a stored topology, and with one
        session_->open(request);
        ASSERT_TRUE(queue_.runUntil([&] { return session_->topology().state() == TopologyState::Ready; }));
        session_->improveFirstIsovalue();
        EXPECT_EQ(session_->isovalue().requested(), -5.0);
        EXPECT_EQ(session_->firstIsovalue().reason(), "");
        session_->close();
    }
}

TEST_F(SessionTest, ACancelledBuildIsNoError) {
    builder_->waits = true;
    openBall();
    session_->cancelJob(session_->jobs().entries().back().id);
    ASSERT_TRUE(queue_.runUntil([&] { return session_->indexState() == IndexState::Cancelled; }));
    EXPECT_TRUE(notices_.empty());
}

TEST_F(SessionTest, ABadFileKeepsTheOldSurface) {
    builder_->waits = true;
    openBall();
    OpenRequest request;
    request.sampleName = "missing";
    session_->open(request);
    ASSERT_TRUE(queue_.runUntil([&] { return !notices_.empty(); }));
    EXPECT_EQ(notices_[0].code, ErrorCode::NotFound);
    ASSERT_NE(session_->dataset(), nullptr);
    EXPECT_EQ(session_->dataset()->name, "ball");
    session_->isovalue().request(-4.0);
    EXPECT_TRUE(queue_.runUntil([&] { return session_->isovalue().displayed() == -4.0; }));
}

TEST_F(SessionTest, ChecksAndExportsTheSurfaceOnScreen) {
    builder_->waits = true;
    openBall();
    session_->checkMesh();
    EXPECT_TRUE(session_->isCheckingMesh());
    ASSERT_TRUE(queue_.runUntil([&] { return session_->certificate().has_value(); }));
    EXPECT_TRUE(session_->certificate()->report.isClosed);
    EXPECT_EQ(session_->certificate()->report.euler, 2);
    session_->exportMesh(folder_ / "ball.ply", session_->datasetGeneration());
    ASSERT_TRUE(queue_.runUntil([&] { return !notices_.empty(); }));
    EXPECT_EQ(notices_[0].severity, Notice::Severity::Information);
    EXPECT_TRUE(std::filesystem::exists(folder_ / "ball.ply"));
}

TEST_F(SessionTest, AnExportShowsItsCertificate) {
    builder_->waits = true;
    openBall();
    session_->exportMesh(folder_ / "ball.ply", session_->datasetGeneration());
    ASSERT_TRUE(queue_.runUntil([&] { return session_->certificate().has_value(); }));
    EXPECT_EQ(session_->certificate()->source, "ball");
    EXPECT_EQ(session_->certificate()->isovalue, -5.0);
    session_->close();
    EXPECT_FALSE(session_->certificate().has_value());
}

TEST_F(SessionTest, AnUnsoundMeshIsWrittenAndToldAsAnError) {
    builder_->waits = true;
    openBall("tiny");
    session_->exportMesh(folder_ / "tiny.ply", session_->datasetGeneration());
    ASSERT_TRUE(queue_.runUntil([&] { return !notices_.empty(); }));
    EXPECT_EQ(notices_[0].severity, Notice::Severity::Error);
    EXPECT_NE(notices_[0].detail.find("tiny.ply: "), std::string::npos);
    EXPECT_NE(notices_[0].detail.find("degenerate triangles"), std::string::npos);
    EXPECT_TRUE(std::filesystem::exists(folder_ / "tiny.ply"));
}

TEST_F(SessionTest, ExportRefusesAnUnknownSuffix) {
    builder_->waits = true;
    openBall();
    session_->exportMesh(folder_ / "ball.txt", session_->datasetGeneration());
    ASSERT_EQ(notices_.size(), 1u);
    EXPECT_EQ(notices_[0].severity, Notice::Severity::Error);
}

TEST_F(SessionTest, CloseForgetsEverything) {
    builder_->waits = true;
    openBall();
    session_->close();
    EXPECT_EQ(session_->dataset(), nullptr);
    EXPECT_EQ(session_->frame(), nullptr);
    EXPECT_FALSE(session_->isovalue().hasDomain());
    ASSERT_TRUE(queue_.runUntil([&] { return session_->isSettled(); }));
    EXPECT_TRUE(notices_.empty());
}

TEST_F(SessionTest, TheLastOpenWins) {
    builder_->waits = true;
    OpenRequest missing;
    missing.sampleName = "missing";
    session_->open(missing);
    openBall();
    queue_.runAll();
    EXPECT_TRUE(notices_.empty());
    EXPECT_EQ(session_->dataset()->name, "ball");
}

TEST_F(SessionTest, EndsWhileWorkRuns) {
    builder_->waits = true;
    openBall();
    session_->isovalue().request(-3.0);
    session_.reset();
    queue_.runAll();
}

} // namespace
} // namespace isoslider::model
