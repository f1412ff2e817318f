// A draft of a surface: fewer triangles that are sent alone, in the same colours and within the same cuts as all of it.
#include <cmath>
#include <cstdlib>
#include <limits>

#include <QImage>
#include <QOffscreenSurface>
#include <QOpenGLContext>
#include <QOpenGLVersionFunctionsFactory>

#include <gtest/gtest.h>

#include "core/extract/live/brick_picture.h"
#include "core/extract/slide_engine.h"
#include "preprocess/metacells/brick_list.h"
#include "tests/gui/faulty_driver.h"
#include "tests/support/result_matchers.h"
#include "ui/render/gl_support.h"
#include "ui/render/picture_target.h"
#include "ui/render/scene_renderer.h"

namespace isoslider::test {
namespace {

using extract::SurfaceFrame;
using Detail = render::SceneRenderer::Detail;

constexpr int kBallPoints = 64;
constexpr glm::ivec2 kDraftPixels(400, 320);

/// Four balls of different sizes, apart from each other below 0.
std::shared_ptr<const ScalarGrid> fourBalls() {
    GridGeometry geometry;
    geometry.dims = {kBallPoints, kBallPoints, kBallPoints};
    std::vector<float> values;
    for (int z = 0; z < kBallPoints; ++z)
        for (int y = 0; y < kBallPoints; ++y)
            for (int x = 0; x < kBallPoints; ++x) {
                float value = -100.0f;
                for (int ball = 0; ball < 4; ++ball)
                    value = std::max(value, 11.0f + static_cast<float>(ball) -
                                                std::hypot(static_cast<float>(x) - (ball % 2 == 0 ? 16.3f : 46.1f),
                                                           static_cast<float>(y) - (ball < 2 ? 16.2f : 46.4f),
                                                           static_cast<float>(z) - 31.4f));
                values.push_back(value);
            }
    return std::make_shared<const ScalarGrid>(ScalarGrid::fromValues<float>(geometry, ScalarType::F32, values));
}

class DraftImageTest : public ::testing::Test {
protected:
    void SetUp() override {
        if (!render::isOpenGlUsable())
            GTEST_SKIP() << "no OpenGL 3.3 here";
        context_.setFormat(render::viewportFormat());
        ASSERT_TRUE(context_.create());
        surface_.setFormat(context_.format());
        surface_.create();
        ASSERT_TRUE(context_.makeCurrent(&surface_));
        gl_ = QOpenGLVersionFunctionsFactory::get<render::Gl>(&context_);
        ASSERT_TRUE(gl_ != nullptr && gl_->initializeOpenGLFunctions());
        ASSERT_TRUE(renderer_.initialize());
        target_.emplace(*gl_, 0);
        auto engine = preprocess::makeMemoryEngine(fourBalls());
        ASSERT_THAT(engine, IsOk());
        engine_ = std::move(engine).value();
        view_.pixels = kDraftPixels;
        view_.options.showsBox = false;
        slideTo(0.0);
        view_.camera.reset(render::sceneRadius(view_.frame->geometry));
    }
    void TearDown() override {
        if (gl_ == nullptr)
            return;
        gl_->glDeleteTextures(1, &texture_.name);
        target_.reset();
        renderer_.release();
        context_.doneCurrent();
    }

    /// Makes the surface pass for one of so many triangles that drafts of it are coarse.
    void slideTo(double isovalue) {
        ASSERT_THAT(engine_->slideTo(isovalue), IsOk());
        auto frame = std::make_shared<SurfaceFrame>();
        engine_->copyFrame(*frame, {.pieces = true});
        ASSERT_TRUE(frame->bricks != nullptr && frame->pieces != nullptr);
        frame->stats.triangles = 200'000;
        view_.frame = std::move(frame);
    }
    QImage draw(Detail detail) {
        EXPECT_TRUE(target_->bind(kDraftPixels));
        EXPECT_TRUE(renderer_.draw(view_, detail));
        target_->resolve(texture_);
        EXPECT_EQ(gl_->glGetError(), GLenum{GL_NO_ERROR});
        return target_->read(texture_, kDraftPixels).convertToFormat(QImage::Format_RGB32);
    }
    /// The mean over all pixels and channels, in grey levels.
    static double difference(const QImage& a, const QImage& b) {
        double sum = 0.0;
        for (int y = 0; y < a.height(); ++y)
            for (int x = 0; x < a.width(); ++x) {
                const QRgb p = a.pixel(x, y), q = b.pixel(x, y);
                sum += std::abs(qRed(p) - qRed(q)) + std::abs(qGreen(p) - qGreen(q)) + std::abs(qBlue(p) - qBlue(q));
            }
        return sum / (3.0 * a.width() * a.height());
    }
    /// Draws a draft, and all of it: they are alike, and both differ from the picture before.
    void expectAlike(const QImage& before) {
        const QImage draft = draw(Detail::Coarse), whole = draw(Detail::Whole);
        EXPECT_LT(difference(draft, whole), 1.5);
        EXPECT_GT(difference(draft, whole), 0.0) << "there was no draft";
        EXPECT_GT(difference(draft, before), 3.0);
        EXPECT_GT(difference(whole, before), 3.0);
    }

    QOpenGLContext context_;
    QOffscreenSurface surface_;
    render::Gl* gl_ = nullptr;
    std::shared_ptr<FaultyDriver> driver_ = std::make_shared<FaultyDriver>();
    render::SceneRenderer renderer_{driver_};
    std::optional<render::PictureTarget> target_;
    render::PictureTexture texture_;
    std::unique_ptr<extract::SlideEngine> engine_;
    render::SceneView view_;
};

TEST_F(DraftImageTest, FollowsTheSurfaceAndTheCameraAndSendsLittle) {
    QImage before(kDraftPixels.x, kDraftPixels.y, QImage::Format_RGB32);
    before.fill(Qt::black);
    (void)draw(Detail::Coarse);
    const std::uint64_t ofDraft = renderer_.uploadedBytes();
    expectAlike(before);
    EXPECT_LT(3 * ofDraft, renderer_.uploadedBytes() - ofDraft) << "the draft needs nothing of the whole surface";
    before = draw(Detail::Whole);
    slideTo(6.0);
    expectAlike(before);
    before = draw(Detail::Whole);
    view_.camera.orbit(0.9, 0.3);
    expectAlike(before);
}

TEST_F(DraftImageTest, IsNotSentAgainForTheSameView) {
    const QImage first = draw(Detail::Coarse);
    const std::uint64_t sent = renderer_.uploadedBytes();
    EXPECT_EQ(difference(draw(Detail::Coarse), first), 0.0);
    EXPECT_EQ(renderer_.uploadedBytes(), sent);
}

TEST_F(DraftImageTest, HasTheColoursOfPiecesAndHidesThem) {
    QImage before = draw(Detail::Whole);
    view_.options.pieces.isColoured = true;
    expectAlike(before);
    before = draw(Detail::Whole);
    view_.options.pieces.largest = 2;
    expectAlike(before);
    before = draw(Detail::Whole);
    view_.options.pieces = {};
    expectAlike(before);
}

TEST_F(DraftImageTest, HasTheColoursOfLevels) {
    engine_->setMergeBound({extract::MergeBound::Measure::Distance, 0.3});
    slideTo(0.001);
    const QImage before = draw(Detail::Whole);
    view_.options.showsLevels = true;
    expectAlike(before);
}

TEST_F(DraftImageTest, StaysWithinTheCropBox) {
    const QImage before = draw(Detail::Whole);
    view_.options.clipping.isCropped = true;
    view_.options.clipping.crop = model::CropBox{{0, 0, 0}, {31, 63, 40}};
    expectAlike(before);
}

TEST_F(DraftImageTest, OfASurfaceBesideTheOneThatSlides) {
    QImage before = draw(Detail::Whole);
    render::InactiveSurface beside;
    beside.frame = view_.frame;
    beside.look.colour = glm::vec3(0.1f, 0.3f, 0.8f);
    view_.inactive = {beside};
    view_.frame = nullptr;
    expectAlike(before);
    before = draw(Detail::Whole);
    view_.inactive.front().hiddenPieces.largest = 1;
    expectAlike(before);
}

TEST_F(DraftImageTest, ACardWithoutMemoryForItRefusesIt) {
    const QImage before = draw(Detail::Coarse);
    slideTo(5.0);
    driver_->memoryBytes = driver_->usedBytes() / 2;
    const QImage none = draw(Detail::Coarse);
    EXPECT_EQ(renderer_.refusedBytes(), extract::pictureBytes(*view_.frame));
    EXPECT_GT(difference(none, before), 3.0) << "rather nothing than another surface";
    driver_->memoryBytes = std::numeric_limits<std::size_t>::max();
    expectAlike(none);
    EXPECT_EQ(renderer_.refusedBytes(), 0u);
}

} // namespace
} // namespace isoslider::test
