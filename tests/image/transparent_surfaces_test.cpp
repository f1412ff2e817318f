// Transparent surfaces in one picture: the exact blend, as rays that are followed through all triangles have it, from
// all sides and whatever the order of the surfaces.
#include <algorithm>
#include <cmath>
#include <numbers>

#include <QImage>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "core/extract/live/brick_picture.h"
#include "core/extract/slide_engine.h"
#include "core/grid/world_normals.h"
#include "preprocess/metacells/brick_list.h"
#include "tests/support/result_matchers.h"
#include "ui/render/gl_support.h"
#include "ui/render/scene_renderer.h"
#include "ui/render/scene_thread.h"
#include "ui/render/transparent_layers.h"

namespace isoslider::test {
namespace {

using extract::SurfaceFrame;
using FramePointer = std::shared_ptr<const SurfaceFrame>;

constexpr int kLayerPoints = 40;
constexpr glm::ivec2 kPixels(320, 260);
constexpr int kTolerance = 3; // grey levels
const model::SurfaceColour kRed{230, 80, 60}, kBlue{86, 150, 222}, kGreen{98, 186, 120};

/// Two balls that are one below 3 or so, and further inside two.
std::shared_ptr<const ScalarGrid> twoBalls() {
    GridGeometry geometry;
    geometry.dims = {kLayerPoints, kLayerPoints, kLayerPoints};
    geometry.spacing = {1.0, 1.2, 0.9};
    std::vector<float> values;
    for (int z = 0; z < kLayerPoints; ++z)
        for (int y = 0; y < kLayerPoints; ++y)
            for (int x = 0; x < kLayerPoints; ++x) {
                const auto ball = [&](float middle, float radius) {
                    return radius - std::hypot(static_cast<float>(x) - middle, static_cast<float>(y) - 19.3f,
                                               static_cast<float>(z) - 20.7f);
                };
                values.push_back(std::max(ball(13.2f, 10.0f), ball(26.1f, 11.5f)));
            }
    return std::make_shared<const ScalarGrid>(ScalarGrid::fromValues<float>(geometry, ScalarType::F32, values));
}

render::SurfaceLook look(const model::SurfaceColour& colour, double opacity) {
    model::ListedSurface surface;
    surface.colour = colour;
    surface.opacity = opacity;
    return render::lookOf(surface);
}

struct Hit {
    double depth;
    glm::vec3 colour; ///< as seen
    float opacity;
    double steepness; ///< 0 where the ray only touches the triangle
};

/// The exact picture, pixel by pixel: what resources/shaders/surface.frag shades, sorted along the line of sight.
class Reference {
public:
    Reference(const render::SceneView& view) : view_(view) {}

    void add(const SurfaceFrame& frame, const render::SurfaceLook& look) {
        Surface surface;
        SurfaceFrame arrays = frame;
        expandPicture(arrays);
        const glm::dmat4 toView =
            view_.camera.viewMatrix() * render::indexToCentredWorld(frame.geometry, frame.geometry);
        const glm::dmat3 normalToView = glm::dmat3(view_.camera.viewMatrix()) * normalToWorld(frame.geometry);
        for (const glm::vec3& position : arrays.positions)
            surface.positions.emplace_back(toView * glm::dvec4(position, 1.0));
        for (const glm::vec3& normal : arrays.normals)
            surface.normals.push_back(normalToView * glm::dvec3(normal));
        surface.indices = arrays.indices;
        surface.look = look;
        surfaces_.push_back(std::move(surface));
    }
    std::vector<Hit> hits(int x, int y) const {
        const double aspect = static_cast<double>(kPixels.x) / kPixels.y;
        const glm::dmat4 toView = glm::inverse(view_.camera.projectionMatrix(aspect));
        const auto at = [&](double depth) {
            const glm::dvec4 place =
                toView * glm::dvec4((x + 0.5) / kPixels.x * 2.0 - 1.0, 1.0 - (y + 0.5) / kPixels.y * 2.0, depth, 1.0);
            return glm::dvec3(place) / place.w;
        };
        const glm::dvec3 from = at(-1.0), along = at(1.0) - from;
        std::vector<Hit> hits;
        for (const Surface& surface : surfaces_)
            for (std::size_t i = 0; i + 2 < surface.indices.size(); i += 3)
                intersect(surface, i, from, along, hits);
        std::sort(hits.begin(), hits.end(), [](const Hit& a, const Hit& b) { return a.depth < b.depth; });
        return hits;
    }
    static glm::vec3 blend(const std::vector<Hit>& hits, glm::vec3 background) {
        glm::vec3 colour(0.0f);
        float through = 1.0f;
        for (const Hit& hit : hits) {
            colour += through * hit.opacity * hit.colour;
            through *= 1.0f - hit.opacity;
        }
        return colour + through * background;
    }

private:
    struct Surface {
        std::vector<glm::dvec3> positions, normals; ///< view space
        std::vector<std::uint32_t> indices;
        render::SurfaceLook look;
    };

    void intersect(const Surface& surface, std::size_t first, const glm::dvec3& from, const glm::dvec3& along,
                   std::vector<Hit>& hits) const {
        const auto a = surface.indices[first], b = surface.indices[first + 1], c = surface.indices[first + 2];
        const glm::dvec3 ab = surface.positions[b] - surface.positions[a],
                         ac = surface.positions[c] - surface.positions[a], p = glm::cross(along, ac);
        const double det = glm::dot(ab, p);
        if (det == 0.0)
            return;
        const glm::dvec3 fromA = from - surface.positions[a], q = glm::cross(fromA, ab);
        const double u = glm::dot(fromA, p) / det, v = glm::dot(along, q) / det, t = glm::dot(ac, q) / det;
        if (u < 0.0 || v < 0.0 || u + v > 1.0 || t <= 0.0 || t >= 1.0)
            return;
        const glm::dvec3 normal = (1.0 - u - v) * surface.normals[a] + u * surface.normals[b] + v * surface.normals[c];
        const double towards = -glm::dot(glm::normalize(glm::cross(ab, ac)), glm::normalize(along));
        hits.push_back(
            {t, shade(surface.look, from + t * along, normal, towards > 0.0), surface.look.opacity, std::abs(towards)});
    }
    glm::vec3 shade(const render::SurfaceLook& look, const glm::dvec3& place, const glm::dvec3& given,
                    bool isFront) const {
        const glm::vec3 toViewer =
            view_.camera.isPerspective() ? glm::normalize(-glm::vec3(place)) : glm::vec3(0.0f, 0.0f, 1.0f);
        const glm::vec3 normal = (isFront ? 1.0f : -1.0f) * glm::vec3(glm::normalize(given));
        const glm::vec3 base = *look.colour * (isFront ? 1.0f : 0.45f);
        const glm::vec3 keyDirection = glm::normalize(glm::vec3(-0.45f, 0.62f, 0.75f));
        const glm::vec3 fillDirection = glm::normalize(glm::vec3(0.75f, -0.45f, 0.35f));
        const auto part = [&](const glm::vec3& direction) { return std::max(glm::dot(normal, direction), 0.0f); };
        const float sky = 0.5f + 0.5f * normal.y;
        glm::vec3 light = glm::vec3(0.055f) + 0.05f * sky * glm::vec3(0.9f, 0.95f, 1.0f);
        light += 0.62f * part(keyDirection) * glm::vec3(1.0f, 0.97f, 0.92f) + 0.26f * part(toViewer);
        light += 0.10f * part(fillDirection) * glm::vec3(0.75f, 0.85f, 1.0f);
        const float shine = std::pow(part(glm::normalize(keyDirection + toViewer)), 48.0f) * 0.16f +
                            std::pow(part(toViewer), 90.0f) * 0.05f;
        const glm::vec3 lit = base * light + glm::vec3(shine) * (isFront ? 1.0f : 0.3f);
        return glm::pow(glm::min(lit, glm::vec3(1.0f)), glm::vec3(1.0f / 2.2f));
    }

    const render::SceneView& view_;
    std::vector<Surface> surfaces_;
};

class TransparentSurfacesTest : public ::testing::Test {
protected:
    void SetUp() override {
        if (!render::isOpenGlUsable())
            GTEST_SKIP() << "no OpenGL 3.3 here";
        scene_ = std::make_unique<render::SceneThread>(nullptr, std::make_shared<render::GlDriver>(), [] {});
        auto engine = preprocess::makeMemoryEngine(twoBalls());
        ASSERT_THAT(engine, IsOk());
        engine_ = std::move(engine).value();
    }
    /// A copy: the engine moves on.
    FramePointer frameAt(double isovalue) {
        EXPECT_THAT(engine_->slideTo(isovalue), IsOk());
        SurfaceFrame frame;
        engine_->copyFrame(frame);
        auto separate = std::make_shared<SurfaceFrame>(frame);
        separate->bricks = extract::separateCopy(*frame.bricks);
        separate->geometry = engine_->info().geometry;
        separate->isovalue = isovalue;
        return separate;
    }
    static render::SceneView viewOf(const FramePointer& frame, double turn, double tilt, bool isPerspective) {
        render::SceneView view;
        view.pixels = kPixels;
        view.volume = frame->geometry;
        view.options.showsBox = false;
        view.camera.reset(render::sceneRadius(frame->geometry));
        view.camera.setPerspective(isPerspective);
        view.camera.orbit(turn, tilt);
        view.camera.zoom(1.5, {0.0, 0.0}, static_cast<double>(kPixels.x) / kPixels.y);
        return view;
    }
    QImage draw(const render::SceneView& view) {
        scene_->waitFor(scene_->ask(view, {.mustBeWhole = true, .asImage = true}));
        return scene_->take().image;
    }
    /// Of the pixels that rays tell apart from their neighbours: those where a ray grazes a triangle are left out, for
    /// the rounding of corners to parts of a pixel decides what is met there.
    struct Compared {
        int pixels = 0, layers = 0, wrong = 0, largest = 0;
    };
    Compared compare(const render::SceneView& view, const Reference& reference) {
        auto empty = view;
        empty.look.isVisible = false;
        empty.inactive.clear();
        empty.frame = nullptr;
        const QImage background = draw(empty), picture = draw(view);
        Compared compared;
        for (int y = 1; y < kPixels.y; y += 5)
            for (int x = 1; x < kPixels.x; x += 5) {
                const auto hits = reference.hits(x, y);
                if (std::any_of(hits.begin(), hits.end(), [](const Hit& hit) { return hit.steepness < 0.15; }))
                    continue;
                const QColor behind = background.pixelColor(x, y), seen = picture.pixelColor(x, y);
                const glm::vec3 exact =
                    255.0f * Reference::blend(hits, {behind.redF(), behind.greenF(), behind.blueF()});
                const glm::vec3 away = glm::abs(exact - glm::vec3(seen.red(), seen.green(), seen.blue()));
                const int most = static_cast<int>(std::lround(std::max({away.x, away.y, away.z})));
                compared.pixels += !hits.empty();
                compared.layers = std::max(compared.layers, static_cast<int>(hits.size()));
                compared.wrong += most > kTolerance;
                compared.largest = std::max(compared.largest, most);
            }
        return compared;
    }

    std::unique_ptr<render::SceneThread> scene_;
    std::unique_ptr<extract::SlideEngine> engine_;
};

TEST_F(TransparentSurfacesTest, NestedSurfacesAreTheExactBlendFromAllSides) {
    const auto outer = frameAt(1.0), inner = frameAt(6.0);
    const auto outerLook = look(kRed, 0.4), innerLook = look(kBlue, 0.6);
    int mostLayers = 0;
    for (const auto& [turn, tilt] : {std::pair(0.0, 0.0), {1.3, 0.2}, {3.0, -0.5}, {-1.8, 0.9}})
        for (const bool isPerspective : {true, false}) {
            auto view = viewOf(outer, turn, tilt, isPerspective);
            view.frame = outer;
            view.look = outerLook;
            view.inactive = {{model::SurfaceId{2}, inner, innerLook}};
            Reference reference(view);
            reference.add(*outer, outerLook);
            reference.add(*inner, innerLook);
            const auto compared = compare(view, reference);
            EXPECT_GT(compared.pixels, 250);
            EXPECT_LE(compared.wrong, compared.pixels / 100) << "largest difference " << compared.largest;
            mostLayers = std::max(mostLayers, compared.layers);
        }
    EXPECT_EQ(mostLayers, 6) << "two balls behind each other in a third";
}

TEST_F(TransparentSurfacesTest, WhatIsOpaqueHidesWhatIsBehind) {
    const auto outer = frameAt(1.0), inner = frameAt(6.0);
    auto view = viewOf(outer, 0.7, 0.4, true);
    view.frame = inner;
    view.look = look(kGreen, 1.0);
    view.inactive = {{model::SurfaceId{2}, outer, look(kRed, 0.3)}};
    Reference reference(view);
    reference.add(*inner, view.look);
    reference.add(*outer, view.inactive[0].look);
    const auto compared = compare(view, reference);
    EXPECT_GT(compared.pixels, 250);
    EXPECT_LE(compared.wrong, compared.pixels / 40)
        << "rims of the opaque one are smoothed; largest " << compared.largest;
}

TEST_F(TransparentSurfacesTest, ThePictureDoesNotDependOnTheOrderNorOnWhichOneSlides) {
    const std::vector<render::InactiveSurface> all{{model::SurfaceId{1}, frameAt(0.5), look(kRed, 0.3)},
                                                   {model::SurfaceId{2}, frameAt(4.0), look(kGreen, 0.5)},
                                                   {model::SurfaceId{3}, frameAt(7.0), look(kBlue, 0.7)}};
    auto view = viewOf(all[0].frame, 0.9, 0.3, true);
    view.frame = all[0].frame;
    view.look = all[0].look;
    view.inactive = {all[1], all[2]};
    const QImage first = draw(view);
    std::swap(view.inactive[0], view.inactive[1]);
    EXPECT_EQ(draw(view), first);
    view.frame = all[2].frame;
    view.look = all[2].look;
    view.inactive = {all[1], all[0]};
    EXPECT_EQ(draw(view), first);
    view.inactive[0].look.isVisible = false;
    EXPECT_NE(draw(view), first);
}

TEST_F(TransparentSurfacesTest, AnInactiveSurfaceIsSentOnceAndArraysLookLikeBricks) {
    const auto outer = frameAt(1.0), inner = frameAt(6.0);
    auto arrays = std::make_shared<SurfaceFrame>(*inner);
    expandPicture(*arrays);
    auto view = viewOf(outer, 0.4, 0.2, true);
    view.frame = outer;
    view.look = look(kRed, 0.4);
    view.inactive = {{model::SurfaceId{2}, inner, look(kBlue, 0.6)}};
    const QImage first = draw(view);
    const auto sent = scene_->uploadedBytes();
    view.camera.orbit(0.3, 0.0);
    view.inactive[0].look = look(kGreen, 0.5);
    (void)draw(view);
    EXPECT_EQ(scene_->uploadedBytes(), sent) << "neither a turn nor a colour sends geometry";
    view.camera.orbit(-0.3, 0.0);
    view.inactive[0] = {model::SurfaceId{2}, arrays, look(kBlue, 0.6)};
    const QImage second = draw(view);
    EXPECT_GT(scene_->uploadedBytes(), sent);
    int different = 0;
    for (int y = 0; y < first.height(); ++y)
        for (int x = 0; x < first.width(); ++x)
            different += std::abs(qGray(first.pixel(x, y)) - qGray(second.pixel(x, y))) > 3;
    EXPECT_LT(different, first.width() * first.height() / 500);
}

TEST_F(TransparentSurfacesTest, TheBoxIsSeenBeforeAndThroughThem) {
    const auto outer = frameAt(-3.0);
    auto view = viewOf(outer, 0.0, 0.0, true);
    view.frame = outer;
    view.look = look(kRed, 0.5);
    const QImage without = draw(view);
    view.options.showsBox = true;
    const QImage with = draw(view);
    auto boxAlone = view;
    boxAlone.look.isVisible = false;
    const QImage alone = draw(boxAlone);
    boxAlone.options.showsBox = false;
    const QImage nothing = draw(boxAlone);
    int before = 0, through = 0, darker = 0;
    for (int y = 0; y < kPixels.y; ++y)
        for (int x = 0; x < kPixels.x; ++x) {
            const auto grey = [&](const QImage& image) { return qGray(image.pixel(x, y)); };
            const bool isOnSurface = std::abs(grey(without) - grey(nothing)) > 8;
            const int line = grey(alone) - grey(nothing), lineOver = grey(with) - grey(without);
            darker += lineOver < -6;
            before += isOnSurface && lineOver > 30;
            through += isOnSurface && line > 30 && lineOver > 4 && lineOver < line / 2;
        }
    EXPECT_EQ(darker, 0) << "lines are light";
    EXPECT_GT(before, 20);
    EXPECT_GT(through, 20);
}

TEST_F(TransparentSurfacesTest, OnlySurfacesOfTheVolumeHaveTheColoursOfItsField) {
    const auto frame = frameAt(1.0);
    auto view = viewOf(frame, 0.4, 0.2, true);
    view.inactive = {{model::SurfaceId{2}, frame, look(kBlue, 1.0)}};
    const auto isDrawnByField = [&] {
        view.colours = {};
        const QImage own = draw(view);
        view.colours = {.by = model::ColourBy::X, .range = {0.0, kLayerPoints - 1.0}};
        return draw(view) != own;
    };
    for (const float opacity : {1.0f, 0.5f}) {
        view.options = {};
        view.inactive[0].look.opacity = opacity;
        view.inactive[0].isOfVolume = true;
        EXPECT_TRUE(isDrawnByField());
        view.options.pieces.isColoured = true;
        EXPECT_FALSE(isDrawnByField()) << "beside coloured pieces";
        view.options.pieces.isColoured = false;
        view.options.showsLevels = true;
        EXPECT_FALSE(isDrawnByField()) << "beside colours of merged cells";
        view.options.showsLevels = false;
        view.inactive[0].isOfVolume = false;
        EXPECT_FALSE(isDrawnByField()) << "of a second volume";
    }
}

TEST(TransparentLayers, PeelsNoMoreThanCanBeSeen) {
    using render::TransparentLayers;
    EXPECT_EQ(TransparentLayers::layersFor(1.0f, false), 1);
    EXPECT_EQ(TransparentLayers::layersFor(0.9f, false), 3);
    EXPECT_EQ(TransparentLayers::layersFor(0.1f, false), TransparentLayers::kMostLayers);
    EXPECT_EQ(TransparentLayers::layersFor(0.1f, true), TransparentLayers::kMostDraftLayers);
}

} // namespace
} // namespace isoslider::test
