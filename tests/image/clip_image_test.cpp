// Crop box, clip plane and its cap as they are drawn, against what geometry states they must be.
#include <algorithm>
#include <cmath>
#include <map>
#include <random>

#include <QImage>
#include <QOffscreenSurface>
#include <QOpenGLContext>
#include <QOpenGLVersionFunctionsFactory>
#include <QTest>

#include <gtest/gtest.h>

#include <glm/geometric.hpp>

#include "core/extract/full_extraction.h"
#include "core/extract/live/brick_picture.h"
#include "core/extract/slices/slice_sampler.h"
#include "core/extract/slices/trilinear_value.h"
#include "core/extract/slide_engine.h"
#include "preprocess/metacells/brick_list.h"
#include "tests/support/result_matchers.h"
#include "ui/render/brick_buffers.h"
#include "ui/render/gl_support.h"
#include "ui/render/scene_renderer.h"
#include "ui/widgets/viewport/viewport_widget.h"

namespace isoslider::test {
namespace {

using extract::SurfaceFrame;

constexpr int kClipPoints = 34;
constexpr double kIsovalue = 0.1;

/// Waves with some noise: many pieces that leave the volume, none of them smooth.
std::shared_ptr<const ScalarGrid> roughWaves(float noise, bool hasHole = false) {
    GridGeometry geometry;
    geometry.dims = {kClipPoints, kClipPoints, kClipPoints};
    geometry.spacing = {1.0, 1.25, 0.75};
    std::mt19937 random(5);
    std::uniform_real_distribution<float> chance(-1.0f, 1.0f);
    std::vector<float> values;
    for (int z = 0; z < kClipPoints; ++z)
        for (int y = 0; y < kClipPoints; ++y)
            for (int x = 0; x < kClipPoints; ++x) {
                const float value = std::sin(0.31f * static_cast<float>(x)) * std::cos(0.27f * static_cast<float>(y)) +
                                    0.4f * std::sin(0.22f * static_cast<float>(z)) + noise * chance(random);
                const bool isMissing = hasHole && std::abs(x - 20) < 4 && std::abs(y - 17) < 5 && std::abs(z - 15) < 6;
                values.push_back(isMissing ? std::nanf("") : value);
            }
    return std::make_shared<const ScalarGrid>(ScalarGrid::fromValues<float>(geometry, ScalarType::F32, values));
}

class ClipImageTest : public ::testing::Test {
protected:
    void SetUp() override {
        if (!render::isOpenGlUsable())
            GTEST_SKIP() << "no OpenGL 3.3 here";
        viewport_ = std::make_unique<widgets::ViewportWidget>();
        viewport_->resize(500, 420);
        viewport_->show();
        ASSERT_TRUE(QTest::qWaitForWindowExposed(viewport_.get()));
        options_.showsBox = false;
    }
    std::shared_ptr<SurfaceFrame> bricksOf(std::shared_ptr<const ScalarGrid> grid) {
        auto engine = preprocess::makeMemoryEngine(std::move(grid));
        EXPECT_THAT(engine, IsOk());
        engine_ = std::move(engine).value();
        EXPECT_THAT(engine_->slideTo(kIsovalue), IsOk());
        auto frame = std::make_shared<SurfaceFrame>();
        engine_->copyFrame(*frame);
        EXPECT_NE(frame->bricks, nullptr);
        return frame;
    }
    /// As arrays, of the triangles for which `isKept` holds of all corners.
    template <class IsKept>
    static std::shared_ptr<SurfaceFrame> arraysOf(const ScalarGrid& grid, IsKept&& isKept) {
        auto mesh = extract::extractFull(grid, kIsovalue).value();
        auto frame = std::make_shared<SurfaceFrame>();
        frame->geometry = grid.geometry();
        frame->isovalue = kIsovalue;
        for (std::size_t i = 0; i + 2 < mesh.triangles.size(); i += 3)
            if (isKept(mesh.positions[mesh.triangles[i]]) && isKept(mesh.positions[mesh.triangles[i + 1]]) &&
                isKept(mesh.positions[mesh.triangles[i + 2]]))
                frame->indices.insert(frame->indices.end(), &mesh.triangles[i], &mesh.triangles[i] + 3);
        frame->positions = std::move(mesh.positions);
        frame->normals = std::move(mesh.normals);
        frame->stats.triangles = frame->indices.size() / 3;
        return frame;
    }
    QImage grab(const std::shared_ptr<const SurfaceFrame>& frame, const model::Clipping& clipping,
                const render::CapScenes& caps = {}) {
        options_.clipping = clipping;
        viewport_->setOptions(options_);
        viewport_->setCaps(caps);
        viewport_->changeCamera([&](model::Camera& camera) { camera.reset(render::sceneRadius(frame->geometry)); });
        viewport_->setFrame(frame);
        return viewport_->grabFramebuffer().convertToFormat(QImage::Format_RGB32);
    }
    static render::CapScene capOf(const ScalarGrid& grid, const model::ClipPlane& plane) {
        const auto pixels = model::capPlaneOf(plane, grid.geometry(), 1);
        const auto samples =
            extract::makeSliceSampler(std::make_shared<const ScalarGrid>(grid))->sample(pixels, {}).value();
        return {std::make_shared<const model::CapSamples>(
                    model::capSamplesOf(plane, pixels, samples, grid.geometry().dims)),
                {-1.5, 1.5}};
    }
    static bool isNearBorder(const QImage& image, int x, int y) {
        for (int v = y - 1; v <= y + 1; ++v)
            for (int u = x - 1; u <= x + 1; ++u)
                if (qBlue(image.pixel(u, v)) > qRed(image.pixel(u, v)) + 40)
                    return true;
        return false;
    }
    /// Orange and blue lines of the guides; what is antialiased with them, too.
    static bool isNearGuide(const QImage& image, int x, int y) {
        for (int v = std::max(0, y - 1); v <= std::min(image.height() - 1, y + 1); ++v)
            for (int u = std::max(0, x - 1); u <= std::min(image.width() - 1, x + 1); ++u) {
                const QRgb p = image.pixel(u, v);
                if ((qRed(p) > 120 && qRed(p) > qBlue(p) + 60) || (qBlue(p) > 120 && qBlue(p) > qRed(p) + 50))
                    return true;
            }
        return false;
    }
    static std::size_t countDifferent(const QImage& clipped, const QImage& other) {
        std::size_t count = 0;
        for (int y = 0; y < clipped.height(); ++y)
            for (int x = 0; x < clipped.width(); ++x)
                count +=
                    std::abs(qGray(clipped.pixel(x, y)) - qGray(other.pixel(x, y))) > 8 && !isNearGuide(clipped, x, y);
        return count;
    }

    std::unique_ptr<widgets::ViewportWidget> viewport_;
    std::unique_ptr<extract::SlideEngine> engine_;
    model::ViewOptions options_;
};

TEST_F(ClipImageTest, ACropIsThePictureOfTheCellsInTheBox) {
    const auto grid = roughWaves(0.3f);
    model::Clipping clipping;
    clipping.isCropped = true;
    clipping.crop = model::CropBox{{3, 9, 0}, {21, 30, 17}};
    const auto cells = arraysOf(*grid, [&](const glm::vec3& place) {
        return place.x >= 3 && place.x <= 21 && place.y >= 9 && place.y <= 30 && place.z <= 17;
    });
    const QImage wanted = grab(cells, {});
    const auto whole = arraysOf(*grid, [](const glm::vec3&) { return true; });
    ASSERT_LT(cells->indices.size(), whole->indices.size() / 3);
    for (const auto& frame : {whole, bricksOf(grid)}) {
        EXPECT_LT(countDifferent(grab(frame, clipping), wanted), 30u) << (frame->bricks ? "bricks" : "arrays");
        EXPECT_GT(countDifferent(grab(frame, {}), wanted), 5000u) << "the test shows something";
    }
}

TEST_F(ClipImageTest, BricksOutsideTheBoxAreNotDrawnAtAll) {
    const auto frame = bricksOf(roughWaves(0.3f));
    QOpenGLContext context;
    context.setFormat(render::viewportFormat());
    ASSERT_TRUE(context.create());
    QOffscreenSurface surface;
    surface.setFormat(context.format());
    surface.create();
    ASSERT_TRUE(context.makeCurrent(&surface));
    auto* gl = QOpenGLVersionFunctionsFactory::get<render::Gl>(&context);
    ASSERT_TRUE(gl != nullptr && gl->initializeOpenGLFunctions());
    const auto program = render::loadProgram("surface_bricks", "surface");
    ASSERT_TRUE(program);
    render::GlDriver driver;
    render::BrickBuffers bricks(*gl, driver);
    ASSERT_TRUE(bricks.upload(*frame->bricks));
    glm::dmat4 toView(0.01); // all of it is in view
    toView[3][3] = 1.0;
    GLuint query = 0;
    gl->glGenQueries(1, &query);
    program->bind();
    bricks.setUniforms(*program);
    const auto trianglesDrawn = [&](const model::Clipping& clipping) {
        const auto cuts = model::cutsOf(clipping, frame->geometry, frame->geometry);
        gl->glBeginQuery(GL_PRIMITIVES_GENERATED, query);
        bricks.drawSurface(toView, cuts, {});
        gl->glEndQuery(GL_PRIMITIVES_GENERATED);
        GLuint count = 0;
        gl->glGetQueryObjectuiv(query, GL_QUERY_RESULT, &count);
        return std::uint64_t{count};
    };
    model::Clipping clipping;
    EXPECT_EQ(trianglesDrawn(clipping), frame->stats.triangles);
    clipping.isCropped = true;
    clipping.crop = model::CropBox{{9, 9, 0}, {15, 23, 33}}; // bricks 1; 1 and 2; all
    std::uint64_t inBox = 0;
    for (const extract::PictureBrick& brick : frame->bricks->bricks())
        if (brick.place[0] == 1 && (brick.place[1] == 1 || brick.place[1] == 2))
            inBox += brick.indexCount / 3;
    ASSERT_GT(inBox, 0u);
    EXPECT_EQ(trianglesDrawn(clipping), inBox);
    gl->glDeleteQueries(1, &query);
}

TEST_F(ClipImageTest, APlaneShowsWhatLiesBehindIt) {
    const auto grid = roughWaves(0.0f);
    const auto whole = bricksOf(grid);
    model::Clipping clipping;
    clipping.plane() = {true, {0.0, 1.0, 0.0}, 0.0, model::Cap::None}; // through grid points 16 and 17
    const auto half = arraysOf(*grid, [](const glm::vec3& place) { return place.y <= 16.5f; });
    const auto more = arraysOf(*grid, [](const glm::vec3& place) { return place.y <= 17.0f; });
    const QImage image = grab(whole, clipping);
    // Between the cells that lie behind it wholly and those that it cuts.
    const auto surface = [](const QImage& picture) {
        std::size_t count = 0;
        for (int y = 0; y < picture.height(); ++y)
            for (int x = 0; x < picture.width(); ++x)
                count += qGray(picture.pixel(x, y)) > 90 && !isNearGuide(picture, x, y);
        return count;
    };
    EXPECT_LT(countDifferent(image, grab(more, {})), surface(image) / 10);
    EXPECT_LE(surface(grab(half, {})) * 9, surface(image) * 10);
}

TEST_F(ClipImageTest, TheCapOfAPlaneEndsAtTheOtherOne) {
    const auto grid = roughWaves(0.0f);
    const auto frame = bricksOf(grid);
    const model::ClipPlane front{true, {0.0, -1.0, 0.0}, 0.0, model::Cap::Colour},
        side{true, {1.0, 0.0, 0.0}, 0.0, model::Cap::None};
    viewport_->setSurfaces({glm::vec3(0.8f, 0.02f, 0.02f)}, {});
    // The cap is lit evenly: its colour is that of most red pixels.
    const auto capped = [&](const model::Clipping& clipping, const render::CapScenes& caps) {
        const QImage image = grab(frame, clipping, caps);
        std::map<QRgb, std::size_t> counts;
        for (int y = 0; y < image.height(); ++y)
            for (int x = 0; x < image.width(); ++x)
                if (qRed(image.pixel(x, y)) > 100 && qRed(image.pixel(x, y)) > 3 * qGreen(image.pixel(x, y)))
                    ++counts[image.pixel(x, y)];
        std::size_t most = 0;
        for (const auto& [colour, count] : counts)
            most = std::max(most, count);
        return most;
    };
    model::Clipping one;
    one.planes[0] = front;
    const std::size_t whole = capped(one, {capOf(*grid, front)});
    EXPECT_GT(whole, 5000u);
    for (const std::size_t place : {0u, 1u}) {
        model::Clipping both;
        both.planes[place] = front;
        both.planes[1 - place] = side;
        render::CapScenes caps;
        caps[place] = capOf(*grid, front);
        const std::size_t half = capped(both, caps);
        EXPECT_LT(half, whole * 7 / 10) << place;
        EXPECT_GT(half, whole * 3 / 10) << place;
    }
}

TEST_F(ClipImageTest, TheCapHasTheColourOfTheInnermostSurfaceThatIsShown) {
    const auto grid = roughWaves(0.0f);
    model::Clipping clipping;
    clipping.plane() = {true, {0.0, -1.0, 0.0}, -0.8, model::Cap::Colour};
    const auto frame = bricksOf(grid);
    const render::SurfaceLook red{glm::vec3(0.8f, 0.02f, 0.02f)}, green{glm::vec3(0.02f, 0.8f, 0.02f)};
    auto inner = std::make_shared<SurfaceFrame>();
    const auto innerEngine = preprocess::makeMemoryEngine(grid);
    ASSERT_THAT(innerEngine, IsOk());
    ASSERT_THAT(innerEngine.value()->slideTo(0.25), IsOk());
    innerEngine.value()->copyFrame(*inner);
    render::InactiveSurface beside{model::SurfaceId{9}, inner, green, {}};
    struct Count {
        int red = 0, green = 0;
    };
    const auto count = [&](const render::SurfaceLook& look, std::vector<render::InactiveSurface> others) {
        viewport_->setSurfaces(look, std::move(others));
        const QImage image = grab(frame, clipping, {capOf(*grid, clipping.plane())});
        Count found; // the cap alone is lit evenly: most of it has one colour
        for (int y = 0; y < image.height(); ++y)
            for (int x = 0; x < image.width(); ++x) {
                const QColor pixel = image.pixelColor(x, y);
                found.red += pixel.red() > 100 && pixel.red() > 3 * pixel.green();
                found.green += pixel.green() > 100 && pixel.green() > 3 * pixel.red();
            }
        return found;
    };
    const Count one = count(red, {}), both = count(red, {beside});
    EXPECT_EQ(one.green, 0);
    EXPECT_GT(both.green, 1000);
    EXPECT_LT(both.red, one.red - 1000) << "the inner one's cap is drawn over the outer one's";
    // The first of all colours is no other one where there is another surface.
    const auto isIvory = [](const QColor& pixel) { // hue of it, whatever the light
        const double greenShare = pixel.greenF() / pixel.redF(), blueShare = pixel.blueF() / pixel.redF();
        return std::abs(std::pow(greenShare, 2.2) - 0.70 / 0.80) < 0.04 &&
               std::abs(std::pow(blueShare, 2.2) - 0.54 / 0.80) < 0.04;
    };
    viewport_->setSurfaces({}, {beside});
    const QImage image = grab(frame, clipping, {capOf(*grid, clipping.plane())});
    std::map<QRgb, int> counts;
    for (int y = 0; y < image.height(); ++y)
        for (int x = 0; x < image.width(); ++x)
            counts[image.pixel(x, y)] += isIvory(image.pixelColor(x, y));
    int evenly = 0;
    for (const auto& [colour, number] : counts)
        evenly = std::max(evenly, number);
    EXPECT_GT(evenly, 1000) << "pixels of one colour, as a cap has";
    beside.look.isVisible = false;
    EXPECT_EQ(count(red, {beside}).green, 0);
    beside.look.isVisible = true;
    beside.isOfVolume = false;
    EXPECT_LT(count(red, {beside}).green, both.green / 2) << "the samples on the plane are those of this volume";
    render::SurfaceLook hidden = red;
    hidden.isVisible = false;
    beside.isOfVolume = true;
    const Count without = count(hidden, {beside});
    EXPECT_EQ(without.red, 0);
    EXPECT_GT(without.green, 1000);
}

TEST_F(ClipImageTest, TheCapIsWhereTheInterpolantReachesTheIsovalue) {
    for (const bool hasHole : {false, true})
        for (const glm::dvec3& direction : {glm::dvec3(0.0, -1.0, 0.0), glm::dvec3(0.5, -1.0, 0.6)}) {
            const auto grid = roughWaves(0.25f, hasHole);
            model::Clipping clipping;
            clipping.plane() = {true, glm::normalize(direction), -0.8, model::Cap::Colour};
            const auto frame = bricksOf(grid);
            const QImage image = grab(frame, clipping, {capOf(*grid, clipping.plane())});
            const auto cuts = model::cutsOf(clipping, frame->geometry, frame->geometry);
            const float* const values = grid->values<float>().data();
            const auto sampleAt = [&](std::int64_t x, std::int64_t y, std::int64_t z) {
                return values[x + kClipPoints * (y + kClipPoints * z)];
            };
            int inside = 0, outside = 0, missing = 0, wrong = 0;
            const double ratio = static_cast<double>(viewport_->width()) / image.width();
            for (int y = 2; y < image.height() - 2; y += 3)
                for (int x = 2; x < image.width() - 2; x += 3) {
                    const auto line = viewport_->lineOfSight(QPointF(x + 0.5, y + 0.5) * ratio);
                    const auto side = [&](const glm::dvec3& p) { return glm::dot(glm::dvec3(cuts[0]), p) + cuts[0].w; };
                    const double a = side(line->first), b = side(line->second);
                    if (a * b >= 0.0)
                        continue;
                    const glm::dvec3 place = line->first + (line->second - line->first) * (a / (a - b));
                    const auto cell = extract::cellOf(place, grid->geometry().dims);
                    const QRgb pixel = image.pixel(x, y);
                    const bool isCap = qRed(pixel) > 120 && qRed(pixel) > 1.45 * qBlue(pixel);
                    if (!cell.isInside || isNearBorder(image, x, y))
                        continue;
                    const float value = extract::trilinearValue(cell, sampleAt);
                    if (std::isnan(value)) {
                        ++missing;
                        wrong += isCap;
                    } else if (std::abs(value - kIsovalue) > 0.08) { // farther than the texture's pixels may be off
                        ++(value > kIsovalue ? inside : outside);
                        wrong += isCap != (value > kIsovalue);
                    }
                }
            EXPECT_GT(inside, 800);
            EXPECT_GT(outside, 800);
            EXPECT_EQ(missing > 100, hasHole);
            // Beside missing samples the cap ends up to a pixel of its texture early.
            EXPECT_LT(wrong, (inside + outside) / (hasHole ? 100 : 400))
                << hasHole << " of " << inside << " and " << outside;
        }
}

TEST_F(ClipImageTest, TheCapShowsSamplesInGrey) {
    const auto grid = roughWaves(0.0f);
    model::Clipping clipping;
    clipping.plane() = {true, {0.0, -1.0, 0.0}, 0.0, model::Cap::Values};
    auto cap = capOf(*grid, clipping.plane());
    cap.window = {kIsovalue, 1.0};
    const QImage image = grab(bricksOf(grid), clipping, {cap});
    std::size_t grey = 0, bright = 0;
    for (int y = 0; y < image.height(); ++y)
        for (int x = 0; x < image.width(); ++x) {
            const QRgb p = image.pixel(x, y);
            if (qRed(p) == qGreen(p) && qGreen(p) == qBlue(p)) {
                ++grey;
                bright += qRed(p) > 128;
            }
        }
    EXPECT_GT(grey, 5000u);
    EXPECT_GT(bright, 300u);
}

} // namespace
} // namespace isoslider::test
