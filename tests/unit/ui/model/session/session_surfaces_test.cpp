// Several surfaces of one volume: one slides, the others are pictures.
#include <atomic>
#include <cmath>
#include <thread>

#include <gtest/gtest.h>

#include "core/extract/live/brick_picture.h"
#include "core/volume_io/sources/volume_source.h"
#include "preprocess/build_index.h"
#include "preprocess/metacells/brick_list.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/ui/main_thread_queue.h"
#include "ui/model/session/session.h"

namespace isoslider::model {
namespace {

constexpr int kPoints = 32;

std::shared_ptr<const ScalarGrid> smallBallGrid() {
    GridGeometry geometry;
    geometry.dims = {kPoints, kPoints, kPoints};
    std::vector<float> values;
    for (int z = 0; z < kPoints; ++z)
        for (int y = 0; y < kPoints; ++y)
            for (int x = 0; x < kPoints; ++x)
                values.push_back(-std::hypot(static_cast<float>(x) - 15.3f, static_cast<float>(y) - 15.6f,
                                             static_cast<float>(z) - 15.1f));
    return std::make_shared<ScalarGrid>(ScalarGrid::fromValues<float>(geometry, ScalarType::F32, values));
}

class RealBuilder final : public IndexBuilder {
public:
    Status build(const std::shared_ptr<const ScalarGrid>& grid, const std::string&, const io::VolumeInfo&,
                 const std::filesystem::path& path, const JobControl& job) override {
        while (waits && !job.isStopRequested())
            std::this_thread::yield();
        preprocess::BuildOptions options;
        options.kind = index::IndexKind::Metacells;
        auto report = preprocess::buildIndex(*io::makeMemorySource(grid, io::VolumeInfo()), path, options, job);
        return report.isOk() ? Status{} : Status{report.error()};
    }
    Status buildFromFile(const std::filesystem::path&, const io::ReadOptions&, const std::string&,
                         const std::filesystem::path&, const JobControl&) override {
        return makeError(ErrorCode::InvalidArgument, "was given a file, not samples");
    }
    Result<std::unique_ptr<extract::SlideEngine>> engineInMemory(const std::shared_ptr<const ScalarGrid>& grid,
                                                                 const JobControl& job) override {
        return preprocess::makeMemoryEngine(grid, job);
    }
    std::atomic<bool> waits{false};
};

class SessionSurfacesTest : public ::testing::Test {
protected:
    SessionSurfacesTest() {
        SessionServices services;
        services.postToMain = queue_.poster();
        services.indexBuilder = builder_;
        services.cacheFolder = folder_ / "cache";
        services.sampleLoader = [](const std::string&, const JobControl&) -> Result<std::shared_ptr<const ScalarGrid>> {
            return smallBallGrid();
        };
        session_ = std::make_unique<Session>(std::move(services));
    }
    void open() {
        OpenRequest request;
        request.sampleName = "ball";
        request.isovalue = -10.0;
        session_->open(request);
        ASSERT_TRUE(queue_.runUntil([&] { return session_->frame() != nullptr && session_->isSettled(); }));
    }
    void settle() {
        ASSERT_TRUE(queue_.runUntil([&] { return session_->isSettled(); }));
    }
    SurfacesModel& surfaces() { return session_->surfaces(); }
    SurfaceId idAt(std::size_t place) { return surfaces().list().surfaces[place].id; }
    /// Adds one that slides at `isovalue`.
    void addAt(double isovalue) {
        session_->addSurface();
        session_->isovalue().request(isovalue);
        settle();
    }
    static std::vector<glm::vec3> placesOf(const extract::SurfaceFrame& frame) {
        extract::SurfaceFrame arrays = frame;
        expandPicture(arrays);
        std::vector<glm::vec3> places;
        for (const auto index : arrays.indices)
            places.push_back(arrays.positions[index]);
        std::sort(places.begin(), places.end(), [](const glm::vec3& a, const glm::vec3& b) {
            return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
        });
        return places;
    }

    test::TemporaryFolder folder_;
    test::MainThreadQueue queue_;
    std::shared_ptr<RealBuilder> builder_ = std::make_shared<RealBuilder>();
    std::unique_ptr<Session> session_;
};

TEST_F(SessionSurfacesTest, TheHandleIsThatOfTheActiveSurface) {
    open();
    ASSERT_EQ(surfaces().list().surfaces.size(), 1u);
    session_->isovalue().request(-9.0);
    EXPECT_EQ(surfaces().active()->isovalue, -9.0);
    addAt(-4.0);
    EXPECT_EQ(surfaces().list().surfaces[0].isovalue, -9.0);
    EXPECT_EQ(surfaces().list().surfaces[1].isovalue, -4.0);
    surfaces().activate(idAt(0));
    EXPECT_EQ(session_->isovalue().requested(), -9.0);
    settle();
    EXPECT_EQ(session_->frame()->isovalue, -9.0);
    surfaces().setIsovalue(-500.0); // out of range
    EXPECT_EQ(surfaces().active()->isovalue, session_->isovalue().min());
    EXPECT_EQ(session_->isovalue().requested(), session_->isovalue().min());
}

TEST_F(SessionSurfacesTest, AnInactiveSurfaceStaysAsItWasWhileAnotherSlides) {
    open();
    const auto places = placesOf(*session_->frame());
    addAt(-4.0);
    const auto kept = session_->pictureOf(idAt(0));
    ASSERT_NE(kept, nullptr);
    EXPECT_NE(kept->bricks->series(), session_->frame()->bricks->series()) << "in memory of its own";
    for (const double isovalue : {-5.0, -11.0, -3.0, -13.0}) {
        session_->isovalue().request(isovalue);
        settle();
    }
    EXPECT_EQ(session_->pictureOf(idAt(0)), kept) << "nothing is done for it";
    EXPECT_EQ(placesOf(*kept), places);
}

TEST_F(SessionSurfacesTest, ThePictureThatIsThereStandsInUntilTheLiveSurfaceHasMoved) {
    open();
    addAt(-4.0);
    const auto first = session_->pictureOf(idAt(0)), live = session_->frame();
    session_->holdMoves(true);
    surfaces().activate(idAt(0));
    EXPECT_EQ(session_->pictureOf(idAt(0)), first) << "no other shape in its colour";
    EXPECT_EQ(session_->pictureOf(idAt(1)), live);
    session_->holdMoves(false);
    settle();
    EXPECT_EQ(session_->pictureOf(idAt(0)), session_->frame());
    EXPECT_EQ(session_->frame()->isovalue, -10.0);
    EXPECT_EQ(session_->pictureOf(idAt(1))->isovalue, -4.0);
    EXPECT_NE(session_->pictureOf(idAt(1)), live);
    session_->holdMoves(true);
    session_->addSurface();
    EXPECT_EQ(session_->pictureOf(surfaces().list().active), nullptr) << "nothing is known of it";
    session_->holdMoves(false);
    settle();
    EXPECT_NE(session_->pictureOf(surfaces().list().active), nullptr);
}

TEST_F(SessionSurfacesTest, WhatHasNoPictureIsExtractedByAJobAndTheLiveSurfaceDoesNotMove) {
    open();
    const auto live = session_->frame();
    auto list = surfaces().list();
    list.surfaces.push_back({SurfaceId{50}, "Inner", -6.5, {1, 2, 3}, 0.5, true});
    list.surfaces.push_back({SurfaceId{51}, "Hidden", -3.5, {1, 2, 3}, 0.5, false});
    surfaces().setList(list);
    EXPECT_FALSE(session_->isSettled());
    settle();
    const auto inner = session_->pictureOf(SurfaceId{50});
    ASSERT_NE(inner, nullptr);
    EXPECT_EQ(inner->isovalue, -6.5);
    EXPECT_GT(inner->stats.triangles, 100u);
    EXPECT_EQ(session_->frame(), live);
    EXPECT_EQ(session_->pictureOf(SurfaceId{51}), nullptr) << "not before it is shown";
    surfaces().change(SurfaceId{51}, [](ListedSurface& surface) { surface.isVisible = true; });
    settle();
    EXPECT_EQ(session_->pictureOf(SurfaceId{51})->isovalue, -3.5);
    // The same as a slide to it.
    session_->isovalue().request(-6.5);
    settle();
    EXPECT_EQ(placesOf(*session_->frame()), placesOf(*inner));
}

TEST_F(SessionSurfacesTest, AnotherErrorAndAnotherIsovalueMakeThePictureAgain) {
    open();
    addAt(-4.0);
    const auto before = session_->pictureOf(idAt(0));
    session_->detail().setError({extract::MergeBound::Measure::Distance, 0.5});
    settle();
    const auto merged = session_->pictureOf(idAt(0));
    EXPECT_LT(merged->stats.triangles, before->stats.triangles);
    EXPECT_EQ(merged->mergeBound.limit, 0.5);
    surfaces().change(idAt(0), [](ListedSurface& surface) { surface.isovalue = -7.0; });
    settle();
    EXPECT_EQ(session_->pictureOf(idAt(0))->isovalue, -7.0);
}

// Only what slides, and only its picture: meshes, pieces and other surfaces are whole.
TEST_F(SessionSurfacesTest, WhatIsLookedAtIsAllThatSlides) {
    open();
    const auto whole = session_->frame();
    EXPECT_FALSE(whole->region);
    session_->lookAt(CropBox{{0, 0, 0}, {7, 31, 31}});
    EXPECT_TRUE(session_->isMoving());
    settle();
    const auto bounded = session_->frame();
    EXPECT_EQ(bounded->region, (BrickBox{{0, 0, 0}, {1, 3, 3}})) << "with the bricks beside";
    EXPECT_LT(bounded->stats.triangles, whole->stats.triangles * 3 / 4);
    EXPECT_GT(bounded->stats.triangles, whole->stats.triangles / 4);
    session_->lookAt(CropBox{{0, 0, 0}, {6, 31, 31}});
    EXPECT_FALSE(session_->isMoving()) << "the same bricks";
    session_->isovalue().request(-9.0);
    settle();
    EXPECT_TRUE(session_->frame()->region);
    EXPECT_EQ(session_->frame()->isovalue, -9.0);

    session_->checkMesh();
    settle();
    ASSERT_TRUE(session_->certificate());
    EXPECT_GT(session_->certificate()->report.triangles, session_->frame()->stats.triangles * 5 / 4);
    EXPECT_EQ(session_->certificate()->report.boundaryLoops, 0u);
    session_->isovalue().request(-9.5);
    settle();
    EXPECT_TRUE(session_->frame()->region) << "as before the mesh";

    session_->findPieces(true);
    ASSERT_TRUE(queue_.runUntil([&] { return session_->frame()->pieces != nullptr; }));
    EXPECT_FALSE(session_->frame()->region);
    EXPECT_EQ(session_->frame()->pieces->pieces().size(), 1u);
    session_->findPieces(false);
    session_->isovalue().request(-10.0);
    settle();
    EXPECT_TRUE(session_->frame()->region);

    addAt(-4.0);
    EXPECT_EQ(session_->pictureOf(idAt(0))->stats.triangles, whole->stats.triangles);
    EXPECT_FALSE(session_->pictureOf(idAt(0))->region) << "one that does not slide is whole";
    surfaces().activate(idAt(0));
    settle();
    session_->lookAt(std::nullopt);
    settle();
    EXPECT_FALSE(session_->frame()->region);
    EXPECT_EQ(placesOf(*session_->frame()), placesOf(*whole));
}

TEST_F(SessionSurfacesTest, SurfacesAddedBeforeThereIsAnIndexStay) {
    builder_->waits = true;
    OpenRequest request;
    request.sampleName = "ball";
    request.isovalue = -10.0;
    session_->open(request);
    ASSERT_TRUE(queue_.runUntil([&] { return session_->frame() != nullptr; }));
    session_->addSurface();
    ASSERT_TRUE(queue_.runUntil([&] { return !session_->isMoving(); }));
    const double isovalue = session_->isovalue().requested();
    builder_->waits = false;
    settle();
    EXPECT_TRUE(session_->frame()->isFromIndex);
    EXPECT_EQ(session_->frame()->isovalue, isovalue);
    EXPECT_EQ(session_->pictureOf(idAt(0))->isovalue, -10.0);
}

TEST_F(SessionSurfacesTest, ARemovedSurfaceIsForgottenAndAnotherVolumeHasOne) {
    open();
    addAt(-4.0);
    const std::weak_ptr<const extract::SurfaceFrame> kept = session_->pictureOf(idAt(0));
    const auto first = idAt(0);
    surfaces().remove(first);
    settle();
    EXPECT_EQ(session_->pictureOf(first), nullptr);
    EXPECT_TRUE(kept.expired());
    addAt(-6.0);
    session_->close();
    EXPECT_TRUE(surfaces().list().surfaces.empty());
    open();
    EXPECT_EQ(surfaces().list().surfaces.size(), 1u);
    EXPECT_EQ(surfaces().active()->isovalue, -10.0);
}

} // namespace
} // namespace isoslider::model
