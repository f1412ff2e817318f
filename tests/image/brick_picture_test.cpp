// The surface as the graphics card makes it from vertex codes, against the same surface from arrays of floats.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <type_traits>
#include <utility>
#include <vector>

#include <QImage>
#include <QOffscreenSurface>
#include <QOpenGLContext>
#include <QOpenGLVersionFunctionsFactory>
#include <QTest>

#include <gtest/gtest.h>

#include <glm/geometric.hpp>

#include "core/extract/live/brick_picture.h"
#include "core/extract/slide_engine.h"
#include "preprocess/metacells/brick_list.h"
#include "tests/support/result_matchers.h"
#include "ui/render/brick_draft.h"
#include "ui/render/gl_support.h"
#include "ui/render/scene_renderer.h"
#include "ui/widgets/viewport/viewport_widget.h"

namespace isoslider::test {
namespace {

using extract::SurfaceFrame;

constexpr int kPoints = 44;

/// Waves with noise: all kinds of cells, also ambiguous ones with vertices inside. Spans -1 to 1, roughly.
std::shared_ptr<const ScalarGrid> roughWaves(double noise) {
    GridGeometry geometry;
    geometry.dims = {kPoints, kPoints, kPoints};
    geometry.spacing = {1.0, 1.25, 0.75};
    std::mt19937 random(5);
    std::uniform_real_distribution<float> chance(-1.0f, 1.0f);
    std::vector<float> values;
    for (int z = 0; z < kPoints; ++z)
        for (int y = 0; y < kPoints; ++y)
            for (int x = 0; x < kPoints; ++x)
                values.push_back(std::sin(0.31f * static_cast<float>(x)) * std::cos(0.27f * static_cast<float>(y)) +
                                 0.4f * std::sin(0.22f * static_cast<float>(z)) +
                                 static_cast<float>(noise) * chance(random));
    return std::make_shared<const ScalarGrid>(ScalarGrid::fromValues<float>(geometry, ScalarType::F32, values));
}

class BrickPictureTest : public ::testing::Test {
protected:
    void SetUp() override {
        if (!render::isOpenGlUsable())
            GTEST_SKIP() << "no OpenGL 3.3 here";
        viewport_ = makeViewport();
    }

    std::unique_ptr<widgets::ViewportWidget> makeViewport() {
        auto viewport = std::make_unique<widgets::ViewportWidget>();
        viewport->resize(500, 420);
        viewport->show();
        EXPECT_TRUE(QTest::qWaitForWindowExposed(viewport.get()));
        return viewport;
    }
    void open(double noise) {
        auto engine = preprocess::makeMemoryEngine(roughWaves(noise));
        ASSERT_THAT(engine, IsOk());
        engine_ = std::move(engine).value();
    }
    std::shared_ptr<SurfaceFrame> slideTo(double isovalue) {
        EXPECT_THAT(engine_->slideTo(isovalue), IsOk());
        auto frame = std::make_shared<SurfaceFrame>();
        engine_->copyFrame(*frame);
        EXPECT_NE(frame->bricks, nullptr);
        return frame;
    }
    static QImage grab(widgets::ViewportWidget& viewport, std::shared_ptr<const SurfaceFrame> frame) {
        viewport.changeCamera([&](model::Camera& camera) { camera.reset(render::sceneRadius(frame->geometry)); });
        viewport.setFrame(std::move(frame));
        return viewport.grabFramebuffer().convertToFormat(QImage::Format_RGB32);
    }
    static int largestDifference(const QImage& a, const QImage& b) {
        EXPECT_EQ(a.size(), b.size());
        int largest = 0;
        for (int y = 0; y < a.height(); ++y)
            for (int x = 0; x < a.width(); ++x) {
                const QRgb p = a.pixel(x, y), q = b.pixel(x, y);
                largest = std::max({largest, std::abs(qRed(p) - qRed(q)), std::abs(qGreen(p) - qGreen(q)),
                                    std::abs(qBlue(p) - qBlue(q))});
            }
        return largest;
    }
    static bool hasSurface(const QImage& image) {
        std::size_t warm = 0;
        for (int y = 0; y < image.height(); ++y)
            for (int x = 0; x < image.width(); ++x)
                warm += qRed(image.pixel(x, y)) > qBlue(image.pixel(x, y)) + 12;
        return warm > 5000;
    }

    std::unique_ptr<widgets::ViewportWidget> viewport_;
    std::unique_ptr<extract::SlideEngine> engine_;
};

TEST_F(BrickPictureTest, IsThatOfArrays) {
    for (const auto& [noise, bound] : {std::pair{0.0, 0.0}, std::pair{0.9, 0.0}, std::pair{0.0, 0.2}}) {
        open(noise);
        engine_->setMergeBound({extract::MergeBound::Measure::Distance, bound});
        for (const double isovalue : {0.1, 0.13, 0.4}) {
            const auto frame = slideTo(isovalue);
            auto arrays = std::make_shared<SurfaceFrame>(*frame);
            expandPicture(*arrays);
            ASSERT_EQ(arrays->bricks, nullptr);
            const QImage fromRecords = grab(*viewport_, frame), fromArrays = grab(*viewport_, arrays);
            EXPECT_TRUE(hasSurface(fromRecords));
            const int difference = largestDifference(fromRecords, fromArrays);
            RecordProperty("largest difference of pixels", difference);
            EXPECT_LE(difference, 2) << noise << " at " << isovalue;
        }
    }
}

/// The same waves as whole numbers of a type, about 0 if it has a sign.
template <class Sample>
std::shared_ptr<const ScalarGrid> wholeWaves(ScalarType type) {
    const auto waves = roughWaves(0.1);
    const float scale = sizeof(Sample) == 1 ? 70.0f : 9000.0f, zero = std::is_signed_v<Sample> ? 0.0f : 1.7f * scale;
    std::vector<Sample> values;
    for (const float value : waves->values<float>())
        values.push_back(static_cast<Sample>(std::lround(scale * value + zero)));
    return std::make_shared<const ScalarGrid>(ScalarGrid::fromValues<Sample>(waves->geometry(), type, values));
}

// The card has samples as keys of one or two bytes: each type has its own zero.
TEST_F(BrickPictureTest, IsThatOfArraysForWholeNumbers) {
    const auto check = [&](const std::shared_ptr<const ScalarGrid>& grid, double isovalue) {
        auto engine = preprocess::makeMemoryEngine(grid);
        ASSERT_THAT(engine, IsOk());
        engine_ = std::move(engine).value();
        const auto frame = slideTo(isovalue);
        ASSERT_EQ(frame->bricks->type(), grid->type());
        auto arrays = std::make_shared<SurfaceFrame>(*frame);
        expandPicture(*arrays);
        const QImage fromCodes = grab(*viewport_, frame);
        EXPECT_TRUE(hasSurface(fromCodes));
        EXPECT_LE(largestDifference(fromCodes, grab(*viewport_, arrays)), 2) << scalarTypeName(grid->type());
    };
    check(wholeWaves<std::uint8_t>(ScalarType::U8), 125.3);
    check(wholeWaves<std::int8_t>(ScalarType::I8), -6.4);
    check(wholeWaves<std::uint16_t>(ScalarType::U16), 16000.7);
    check(wholeWaves<std::int16_t>(ScalarType::I16), -811.2);
}

// Points of more bricks than one texture holds: in each brick a small octahedron.
TEST_F(BrickPictureTest, IsThatOfArraysOnSeveralPages) {
    constexpr int kSide = 200;
    GridGeometry geometry;
    geometry.dims = {kSide, kSide, kSide};
    std::vector<float> values(std::size_t{kSide} * kSide * kSide, 0.0f);
    for (int z = 4; z < kSide; z += extract::kCellSide)
        for (int y = 4; y < kSide; y += extract::kCellSide)
            for (int x = 4; x < kSide; x += extract::kCellSide)
                values[static_cast<std::size_t>(x + kSide * (y + kSide * z))] = 1.0f + 0.01f * static_cast<float>(x);
    auto engine = preprocess::makeMemoryEngine(
        std::make_shared<const ScalarGrid>(ScalarGrid::fromValues<float>(geometry, ScalarType::F32, values)));
    ASSERT_THAT(engine, IsOk());
    engine_ = std::move(engine).value();
    const auto frame = slideTo(0.2);
    ASSERT_GT(frame->bricks->pointLineEnd(), std::uint64_t{1} << 20);
    auto arrays = std::make_shared<SurfaceFrame>(*frame);
    expandPicture(*arrays);
    const QImage fromCodes = grab(*viewport_, frame);
    EXPECT_TRUE(hasSurface(fromCodes));
    EXPECT_LE(largestDifference(fromCodes, grab(*viewport_, arrays)), 2);
}

// Lines darken the surface; they are of the triangles, so fewer of them darken less.
TEST_F(BrickPictureTest, ShowsTheEdgesOfTriangles) {
    open(0.0);
    const auto brightnessOf = [&](bool showsEdges) {
        model::ViewOptions options;
        options.showsEdges = showsEdges;
        viewport_->setOptions(options);
        const QImage image = grab(*viewport_, slideTo(0.1));
        double sum = 0.0;
        for (int y = 0; y < image.height(); ++y)
            for (int x = 0; x < image.width(); ++x)
                sum += qGray(image.pixel(x, y));
        return sum;
    };
    const double plain = brightnessOf(false), all = brightnessOf(true);
    engine_->setMergeBound({extract::MergeBound::Measure::Distance, 0.3});
    const double merged = brightnessOf(true);
    EXPECT_LT(all, 0.9 * plain);
    EXPECT_GT(merged, all + 0.2 * (plain - all));
    EXPECT_LT(merged, plain);
}

TEST_F(BrickPictureTest, ColoursMergedCellsByTheirLevel) {
    open(0.0);
    const auto blueOverRed = [&](bool showsLevels, double error) {
        model::ViewOptions options;
        options.showsLevels = showsLevels;
        viewport_->setOptions(options);
        engine_->setMergeBound({extract::MergeBound::Measure::Distance, error});
        const QImage image = grab(*viewport_, slideTo(0.1));
        double sum = 0.0;
        for (int y = 0; y < image.height(); ++y)
            for (int x = 0; x < image.width(); ++x)
                sum += std::max(0, qBlue(image.pixel(x, y)) - qRed(image.pixel(x, y)) - 40);
        return sum;
    };
    EXPECT_EQ(blueOverRed(false, 0.1), blueOverRed(true, 0.0)) << "ivory, as long as nothing is merged";
    EXPECT_GT(blueOverRed(true, 0.1), blueOverRed(false, 0.1) + 10000.0) << "cells of two a side are blue";
}

// Bricks outside the view are left out; none that reaches into it may be.
TEST_F(BrickPictureTest, IsThatOfArraysWhereverTheViewEnds) {
    open(0.0);
    const auto frame = slideTo(0.1);
    auto arrays = std::make_shared<SurfaceFrame>(*frame);
    expandPicture(*arrays);
    int views = 0; // that are not of a gap in the surface
    for (const bool isPerspective : {false, true})
        for (const double zoom : {3.0, 9.0})
            for (const glm::dvec2 at : {glm::dvec2(0.0, 0.0), glm::dvec2(0.35, -0.2), glm::dvec2(-0.3, 0.4)}) {
                const auto grabAt = [&](std::shared_ptr<const SurfaceFrame> shown) {
                    viewport_->setFrame(std::move(shown));
                    viewport_->changeCamera([&](model::Camera& camera) {
                        camera.reset(render::sceneRadius(frame->geometry));
                        camera.setPerspective(isPerspective);
                        camera.zoom(zoom, at, 500.0 / 420.0);
                    });
                    return viewport_->grabFramebuffer().convertToFormat(QImage::Format_RGB32);
                };
                const QImage fromRecords = grabAt(frame);
                views += hasSurface(fromRecords);
                EXPECT_LE(largestDifference(fromRecords, grabAt(arrays)), 2) << zoom << " at " << at.x << ", " << at.y;
            }
    EXPECT_GE(views, 8) << "of 12";
}

// Bricks that changed are all that is sent; what the card then holds must be the whole surface all the same.
TEST_F(BrickPictureTest, FollowsASlide) {
    for (const double noise : {0.0, 0.3}) {
        open(noise);
        std::mt19937 random(11);
        double isovalue = 0.0;
        for (int step = 0; step < 30; ++step) {
            isovalue +=
                step % 10 == 9 ? 0.5 * (isovalue > 0 ? -1 : 1) : 0.01 * (static_cast<double>(random() % 9) - 4.0);
            const auto frame = slideTo(isovalue);
            const QImage slid = grab(*viewport_, frame);
            if (step % 6 != 0)
                continue;
            const auto fresh = makeViewport();
            EXPECT_TRUE(hasSurface(slid));
            ASSERT_EQ(largestDifference(slid, grab(*fresh, frame)), 0) << noise << ", step " << step;
        }
    }
}

TEST_F(BrickPictureTest, SendsBytesInProportionToTheChange) {
    open(0.0);
    const auto sentFor = [&](double isovalue) {
        const auto frame = slideTo(isovalue);
        const std::uint64_t before = viewport_->uploadedBytes();
        (void)grab(*viewport_, frame);
        return viewport_->uploadedBytes() - before;
    };
    const std::uint64_t whole = sentFor(0.1);
    ASSERT_GT(whole, 100'000u);
    // Nothing is crossed: one number in the shader. What little is sent are bricks with vertices inside cells.
    EXPECT_LT(sentFor(std::nextafter(0.1, 1.0)), whole / 50);
    // Bricks as small as the whole volume's 216 are soon touched; still few are.
    const std::uint64_t little = sentFor(0.1001), more = sentFor(0.101);
    EXPECT_LT(little, whole / 2);
    EXPECT_GT(more, little);
    EXPECT_LT(more, whole);
}

// What a brick's vertices refer to does not change while it stays, nor while it is away for a while: then only vertices
// and triangles are sent.
TEST_F(BrickPictureTest, SendsThePointsOfABrickOnce) {
    open(0.0);
    (void)grab(*viewport_, slideTo(0.1));
    for (const bool wasAway : {false, true}) {
        if (wasAway)
            (void)grab(*viewport_, slideTo(1.1));
        const auto frame = slideTo(0.1002);
        const auto before = viewport_->uploadedBytes();
        const QImage shown = grab(*viewport_, frame);
        // Where most of them are new, vertices and triangles are sent with what lies between their runs.
        const extract::BrickPicture<float>& bricks = *frame->bricks;
        const std::uint64_t triangles = bricks.vertexEnd() * sizeof(extract::VertexCode) +
                                        bricks.indexEnd() * sizeof(std::uint16_t) +
                                        bricks.innerEnd() * sizeof(extract::InnerRecord);
        std::uint64_t points = 0;
        for (const extract::PictureBrick& brick : bricks.bricks())
            points += bricks.bytesOf(brick, false, true);
        constexpr std::uint64_t kTables = 64 << 10;
        ASSERT_GT(points, 2 * (triangles + kTables));
        EXPECT_LT(viewport_->uploadedBytes() - before, triangles + kTables) << wasAway;
        EXPECT_EQ(largestDifference(shown, grab(*makeViewport(), frame)), 0);
    }
}

// Brick by brick: the card's positions and normals against those of the same formula on the processor.
TEST_F(BrickPictureTest, HasVerticesWithinOneUnitInTheLastPlace) {
    open(0.9);
    engine_->setMergeBound({extract::MergeBound::Measure::Scalar, 0.7});
    const auto frame = slideTo(0.2);
    ASSERT_GT(frame->stats.activeLeaves[1], 50u);
    const auto& picture = *frame->bricks;
    QOpenGLContext context;
    context.setFormat(render::viewportFormat());
    ASSERT_TRUE(context.create());
    QOffscreenSurface surface;
    surface.setFormat(context.format());
    surface.create();
    ASSERT_TRUE(context.makeCurrent(&surface));
    auto* gl = QOpenGLVersionFunctionsFactory::get<render::Gl>(&context);
    ASSERT_TRUE(gl != nullptr && gl->initializeOpenGLFunctions());
    QOpenGLShaderProgram program;
    ASSERT_TRUE(program.addShaderFromSourceFile(QOpenGLShader::Vertex,
                                                QStringLiteral(":/isoslider/shaders/surface_bricks.vert")));
    ASSERT_TRUE(program.addShaderFromSourceCode(
        QOpenGLShader::Fragment, "#version 330 core\nout vec4 colour;\nvoid main() { colour = vec4(1.0); }\n"));
    const char* outputs[] = {"gridPosition", "gridNormal"};
    gl->glTransformFeedbackVaryings(program.programId(), 2, outputs, GL_INTERLEAVED_ATTRIBS);
    ASSERT_TRUE(program.link()) << program.log().toStdString();

    GLuint array = 0, textures[4], buffers[7];
    gl->glGenVertexArrays(1, &array);
    gl->glGenTextures(4, textures);
    gl->glGenBuffers(7, buffers);
    gl->glBindVertexArray(array);
    program.bind();
    constexpr std::array<const char*, 4> kTextures{"places", "scalars", "normals", "inner"};
    for (std::size_t unit = 0; unit < kTextures.size(); ++unit)
        program.setUniformValue(kTextures[unit], static_cast<int>(unit));
    ASSERT_EQ(picture.type(), ScalarType::F32);
    program.setUniformValue("scalarBytes", 4);
    program.setUniformValue("zeroKey", 0);
    program.setUniformValue("isovalue", static_cast<float>(frame->isovalue));
    std::size_t onEdges = 0, inside = 0;
    float largestTurn = 0.0f;
    std::vector<extract::EdgeRecord<float>> room;
    for (const extract::PictureBrick& brick : picture.bricks()) {
        if (brick.indexCount == 0)
            continue;
        const auto records = picture.records(brick, room);
        const std::size_t count = records.size();
        gl->glBindBuffer(GL_ARRAY_BUFFER, buffers[0]);
        gl->glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(count * sizeof(extract::VertexCode)),
                         picture.codes(brick), GL_STREAM_DRAW);
        gl->glEnableVertexAttribArray(0);
        gl->glVertexAttribIPointer(0, 1, GL_UNSIGNED_SHORT, sizeof(extract::VertexCode), nullptr);
        const auto fill = [&](std::size_t unit, GLenum format, const void* data, std::size_t bytes) {
            gl->glBindBuffer(GL_TEXTURE_BUFFER, buffers[3 + unit]);
            gl->glBufferData(GL_TEXTURE_BUFFER, static_cast<GLsizeiptr>(bytes), data, GL_STREAM_DRAW);
            gl->glActiveTexture(static_cast<GLenum>(GL_TEXTURE0 + unit));
            gl->glBindTexture(GL_TEXTURE_BUFFER, textures[unit]);
            gl->glTexBuffer(GL_TEXTURE_BUFFER, format, buffers[3 + unit]);
        };
        const std::vector<std::array<std::uint32_t, 4>> places(
            (count + 31) / 32, {brick.place[0] | std::uint32_t{brick.place[1]} << 16, brick.place[2], 0, 0});
        fill(0, GL_RGBA32UI, places.data(), places.size() * sizeof places[0]);
        fill(1, GL_R32UI, picture.points(brick), sizeof(extract::BrickPoints<float>));
        fill(2, GL_R16UI, picture.points(brick), sizeof(extract::BrickPoints<float>));
        fill(3, GL_RGBA32UI, picture.inner(brick), brick.innerCount * sizeof(extract::InnerRecord));
        std::vector<glm::vec3> out(2 * count);
        gl->glBindBufferBase(GL_TRANSFORM_FEEDBACK_BUFFER, 0, buffers[2]);
        gl->glBufferData(GL_TRANSFORM_FEEDBACK_BUFFER, static_cast<GLsizeiptr>(out.size() * sizeof(glm::vec3)), nullptr,
                         GL_STREAM_READ);
        gl->glEnable(GL_RASTERIZER_DISCARD);
        gl->glBeginTransformFeedback(GL_POINTS);
        gl->glDrawArrays(GL_POINTS, 0, static_cast<GLsizei>(count));
        gl->glEndTransformFeedback();
        gl->glDisable(GL_RASTERIZER_DISCARD);
        gl->glGetBufferSubData(GL_TRANSFORM_FEEDBACK_BUFFER, 0, static_cast<GLsizeiptr>(out.size() * sizeof(glm::vec3)),
                               out.data());
        for (std::size_t k = 0; k < count; ++k) {
            const auto vertex = extract::vertexOf(records[k], brick.origin(), static_cast<float>(frame->isovalue));
            (records[k].isInside() ? inside : onEdges)++;
            for (int a = 0; a < 3; ++a) {
                const float expected = vertex.position[a];
                ASSERT_GE(out[2 * k][a], std::nextafter(expected, -1e9f)) << k;
                ASSERT_LE(out[2 * k][a], std::nextafter(expected, 1e9f)) << k;
            }
            largestTurn = std::max(largestTurn, glm::length(out[2 * k + 1] - vertex.normal));
        }
    }
    EXPECT_LT(largestTurn, 1e-6f) << "of normals";
    EXPECT_GT(onEdges, 10000u);
    EXPECT_GT(inside, 10u);
    EXPECT_EQ(gl->glGetError(), GLenum{GL_NO_ERROR});
    program.release();
    gl->glDeleteBuffers(7, buffers);
    gl->glDeleteTextures(4, textures);
    gl->glDeleteVertexArrays(1, &array);
    context.doneCurrent();
}

// What the surface of a draft is: every side of a triangle has its partner, but for those in the sides of the volume.
TEST_F(BrickPictureTest, ACoarseSurfaceHasNoCracks) {
    for (const double noise : {0.0, 0.9}) {
        open(noise);
        const auto frame = slideTo(0.2);
        const auto& picture = *frame->bricks;
        std::size_t whole = 0, before = std::numeric_limits<std::size_t>::max();
        for (const int blockCells : {2, 4, 8}) {
            using Place = std::array<float, 3>;
            std::map<std::pair<Place, Place>, int> sides;
            std::size_t triangles = 0;
            whole = 0;
            for (const extract::PictureBrick& brick : picture.bricks()) {
                if (brick.indexCount == 0)
                    continue;
                render::CoarseSurface coarse;
                render::coarsenBrick({{picture.codes(brick), brick.vertexCount},
                                      picture.inner(brick),
                                      {picture.indices(brick), brick.indexCount}},
                                     blockCells, coarse);
                std::vector<glm::vec3> places(coarse.vertices.size()), normals(coarse.vertices.size());
                expandSome(picture, brick, coarse.vertices, frame->isovalue, places.data(), normals.data());
                std::vector<extract::EdgeRecord<float>> room;
                const auto records = picture.records(brick, room);
                for (std::size_t k = 0; k < places.size(); ++k) {
                    const auto vertex = extract::vertexOf(records[coarse.vertices[k]], brick.origin(),
                                                          static_cast<float>(frame->isovalue));
                    ASSERT_EQ(places[k], vertex.position);
                    ASSERT_EQ(normals[k], vertex.normal);
                }
                const auto placeOf = [&](std::size_t i) {
                    const glm::vec3 place = places[coarse.indices[i]];
                    return Place{place.x, place.y, place.z};
                };
                for (std::size_t i = 0; i < coarse.indices.size(); ++i) {
                    const auto [low, high] = std::minmax({placeOf(i), placeOf(i % 3 == 2 ? i - 2 : i + 1)});
                    ++sides[{low, high}];
                }
                triangles += coarse.indices.size() / 3;
                whole += brick.indexCount / 3;
            }
            for (const auto& [side, count] : sides) {
                bool isInVolumeSide = false;
                for (std::size_t axis = 0; axis < 3; ++axis) {
                    // The last bricks end within; there the block that holds the side is merged.
                    const auto last = static_cast<float>(frame->geometry.dims[axis] - 1 - blockCells);
                    const float a = side.first[axis], b = side.second[axis];
                    isInVolumeSide = isInVolumeSide || (a == 0.0f && b == 0.0f) || (a >= last && b >= last);
                }
                ASSERT_TRUE(count % 2 == 0 || isInVolumeSide)
                    << side.first[0] << ' ' << side.first[1] << ' ' << side.first[2];
            }
            EXPECT_LT(triangles, whole / 2);
            EXPECT_LT(triangles, before);
            EXPECT_GT(triangles, whole / 100);
            before = triangles;
        }
    }
}

} // namespace
} // namespace isoslider::test
