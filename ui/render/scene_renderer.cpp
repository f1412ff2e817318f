#include "ui/render/scene_renderer.h"

#include <array>

#include <QMatrix3x3>
#include <QMatrix4x4>
#include <QOpenGLVersionFunctionsFactory>
#include <QVector3D>
#include <QVector4D>

#include <glm/geometric.hpp>

#include "ui/render/array_buffers.h"
#include "ui/render/brick_buffers.h"

namespace isoslider::render {
namespace {

constexpr int kBoxVertices = 24;
constexpr float kSpotCells = 1.5f; // around the middle
constexpr float kSpotShare = 0.9f; // of the surface's colour at full strength
constexpr float kMarkerPixels = 24.0f; // half the side of its square

QMatrix4x4 toQt(const glm::dmat4& matrix) {
    QMatrix4x4 result;
    for (int column = 0; column < 4; ++column)
        for (int row = 0; row < 4; ++row)
            result(row, column) = static_cast<float>(matrix[column][row]);
    return result;
}

QMatrix3x3 toQt(const glm::dmat3& matrix) {
    QMatrix3x3 result;
    for (int column = 0; column < 3; ++column)
        for (int row = 0; row < 3; ++row)
            result(row, column) = static_cast<float>(matrix[column][row]);
    return result;
}

QVector3D toQt(glm::vec3 v) { return {v.x, v.y, v.z}; }
QVector4D toQt(glm::vec4 v) { return {v.x, v.y, v.z, v.w}; }

glm::dvec3 lastPoint(const GridGeometry& geometry) {
    return glm::dvec3(geometry.dims[0], geometry.dims[1], geometry.dims[2]) - 1.0;
}

/// The twelve edges of the box [0, last], as point pairs.
std::array<glm::vec3, kBoxVertices> boxLines(glm::vec3 last) {
    std::array<glm::vec3, kBoxVertices> points{};
    std::size_t next = 0;
    for (int axis = 0; axis < 3; ++axis)
        for (int corner = 0; corner < 4; ++corner) {
            glm::vec3 begin(0.0f);
            begin[(axis + 1) % 3] = (corner & 1) != 0 ? last[(axis + 1) % 3] : 0.0f;
            begin[(axis + 2) % 3] = (corner & 2) != 0 ? last[(axis + 2) % 3] : 0.0f;
            glm::vec3 end = begin;
            end[axis] = last[axis];
            points[next++] = begin;
            points[next++] = end;
        }
    return points;
}

} // namespace

struct SceneRenderer::Matrices {
    glm::dmat4 modelToClip;
    QMatrix4x4 modelToView;
    QMatrix4x4 boxToView;
    QMatrix4x4 viewToClip;
    QMatrix3x3 normalToView;
    glm::vec3 spot; ///< index units of the frame
};

struct SceneRenderer::Resources {
    Resources(Gl& functions, GlDriver& usedDriver)
        : gl(functions), driver(usedDriver), arrays(functions, usedDriver), bricks(functions, usedDriver) {
        gl.glGenVertexArrays(1, &emptyArray);
        gl.glGenVertexArrays(1, &boxArray);
        boxBuffer = driver.makeBuffer(gl);
    }
    ~Resources() {
        if (isAbandoned)
            return;
        driver.freeBuffer(gl, boxBuffer);
        gl.glDeleteVertexArrays(1, &boxArray);
        gl.glDeleteVertexArrays(1, &emptyArray);
    }

    Gl& gl;
    GlDriver& driver;
    ArrayBuffers arrays; ///< of a frame with arrays
    BrickBuffers bricks; ///< of one with bricks
    bool isAbandoned = false;
    bool hasBox = false;
    GLuint emptyArray = 0;
    GLuint boxArray = 0;
    GLuint boxBuffer = 0;
    std::unique_ptr<QOpenGLShaderProgram> backgroundProgram;
    std::unique_ptr<QOpenGLShaderProgram> lineProgram;
    std::unique_ptr<QOpenGLShaderProgram> markerProgram;
    std::unique_ptr<QOpenGLShaderProgram> arraysProgram;
    std::unique_ptr<QOpenGLShaderProgram> bricksProgram;
};

double sceneRadius(const GridGeometry& geometry) {
    const double radius = 0.5 * glm::length(lastPoint(geometry) * geometry.spacing);
    return radius > 0.0 ? radius : 1.0;
}

glm::dmat4 indexToCentredWorld(const GridGeometry& grid, const GridGeometry& volume) {
    glm::dmat4 map = grid.indexToWorld();
    const glm::dvec3 toCentre = glm::dmat3(volume.indexToWorld()) * (0.5 * lastPoint(volume));
    // Equal origins cancel before anything is rounded, however far away they are.
    map[3] = glm::dvec4((grid.origin - volume.origin) - toCentre, 1.0);
    return map;
}

SceneRenderer::SceneRenderer(std::shared_ptr<GlDriver> driver) : driver_(std::move(driver)) {}
SceneRenderer::~SceneRenderer() = default;

bool SceneRenderer::initialize() {
    // What an earlier context left behind has names that are this context's by now.
    abandon();
    auto* gl = QOpenGLVersionFunctionsFactory::get<Gl>();
    if (gl == nullptr || !gl->initializeOpenGLFunctions())
        return false;
    resources_ = std::make_unique<Resources>(*gl, *driver_);
    resources_->backgroundProgram = loadProgram("background");
    resources_->lineProgram = loadProgram("line");
    resources_->markerProgram = loadProgram("marker");
    resources_->arraysProgram = loadProgram("surface");
    resources_->bricksProgram = loadProgram("surface_records", "surface");
    isFrameNew_ = true;
    if (resources_->backgroundProgram && resources_->lineProgram && resources_->markerProgram &&
        resources_->arraysProgram && resources_->bricksProgram)
        return true;
    resources_.reset();
    return false;
}

void SceneRenderer::release() { resources_.reset(); }

void SceneRenderer::abandon() {
    if (!resources_)
        return;
    resources_->isAbandoned = true;
    resources_->arrays.abandon();
    resources_->bricks.abandon();
    resources_.reset();
}

void SceneRenderer::setFrame(std::shared_ptr<const extract::SurfaceFrame> frame,
                             const std::optional<GridGeometry>& volume) {
    if (frame == frame_)
        return;
    frame_ = std::move(frame);
    if (frame_)
        volume_ = volume.value_or(frame_->geometry);
    isFrameNew_ = true;
}

void SceneRenderer::uploadIfNew() {
    if (!std::exchange(isFrameNew_, false))
        return;
    refusedBytes_ = 0;
    resources_->arrays.clear();
    if (!frame_)
        return resources_->bricks.clear();
    if (!uploadSurface())
        refusedBytes_ = extract::pictureBytes(*frame_);
    uploadBox();
}

bool SceneRenderer::uploadSurface() {
    // One kind at a time: the other's memory may be wanted.
    if (frame_->bricks && resources_->bricks.canHold(*frame_->bricks)) {
        resources_->arrays.freeMemory();
        return resources_->bricks.upload(*frame_->bricks);
    }
    resources_->bricks.freeMemory();
    if (!frame_->bricks)
        return resources_->arrays.upload(*frame_);
    extract::SurfaceFrame frame = *frame_; // an old card with small tables
    expandPicture(frame);
    return resources_->arrays.upload(frame);
}

std::uint64_t SceneRenderer::uploadedBytes() const {
    return resources_ ? resources_->arrays.uploadedBytes() + resources_->bricks.uploadedBytes() : 0;
}

void SceneRenderer::uploadBox() {
    auto& gl = resources_->gl;
    const auto lines = boxLines(glm::vec3(lastPoint(volume_)));
    gl.glBindVertexArray(resources_->boxArray);
    resources_->hasBox = driver_->allocate(gl, GL_ARRAY_BUFFER, resources_->boxBuffer, sizeof lines);
    if (resources_->hasBox)
        gl.glBufferSubData(GL_ARRAY_BUFFER, 0, sizeof lines, lines.data());
    gl.glBindBuffer(GL_ARRAY_BUFFER, resources_->boxBuffer);
    gl.glEnableVertexAttribArray(0);
    gl.glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, sizeof(glm::vec3), nullptr);
    gl.glBindVertexArray(0);
}

void SceneRenderer::draw(const model::Camera& camera, const model::ViewOptions& options, glm::ivec2 pixels) {
    if (!resources_ || pixels.x <= 0 || pixels.y <= 0)
        return;
    uploadIfNew();
    auto& gl = resources_->gl;
    gl.glViewport(0, 0, pixels.x, pixels.y);
    gl.glDepthMask(GL_TRUE);
    gl.glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    gl.glDisable(GL_CULL_FACE);
    drawBackground();
    if (!frame_)
        return;
    const glm::dmat4 view = camera.viewMatrix();
    Matrices matrices{};
    const glm::dmat4 projection = camera.projectionMatrix(static_cast<double>(pixels.x) / pixels.y);
    const glm::dmat4 modelToView = view * indexToCentredWorld(frame_->geometry, volume_);
    matrices.modelToClip = projection * modelToView;
    matrices.modelToView = toQt(modelToView);
    matrices.boxToView = toQt(view * indexToCentredWorld(volume_, volume_));
    matrices.viewToClip = toQt(projection);
    matrices.normalToView = toQt(glm::dmat3(view) * frame_->geometry.normalToWorld());
    const glm::dvec4 spot =
        spot_ ? indexToCentredWorld(volume_, volume_) * glm::dvec4(spot_->place, 1.0) : glm::dvec4();
    if (spot_)
        matrices.spot = glm::dvec3(glm::inverse(indexToCentredWorld(frame_->geometry, volume_)) * spot);
    gl.glEnable(GL_DEPTH_TEST);
    gl.glDepthFunc(GL_LEQUAL);
    drawSurface(matrices, camera.isPerspective(), options);
    if (options.showsBox && resources_->hasBox)
        drawBox(matrices);
    gl.glDisable(GL_DEPTH_TEST);
    if (spot_)
        drawMarker(projection * view * spot, pixels);
}

void SceneRenderer::drawBackground() {
    auto& gl = resources_->gl;
    auto& program = *resources_->backgroundProgram;
    gl.glDisable(GL_DEPTH_TEST);
    gl.glDisable(GL_BLEND);
    program.bind();
    program.setUniformValue("bottomColour", toQt(colours_.backgroundBottom));
    program.setUniformValue("topColour", toQt(colours_.backgroundTop));
    gl.glBindVertexArray(resources_->emptyArray);
    gl.glDrawArrays(GL_TRIANGLES, 0, 3);
    gl.glBindVertexArray(0);
    program.release();
}

void SceneRenderer::drawBox(const Matrices& matrices) {
    auto& gl = resources_->gl;
    auto& program = *resources_->lineProgram;
    gl.glEnable(GL_BLEND);
    // Alpha stays 1: the widget is composed as premultiplied, and a hole would overflow its colour.
    gl.glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
    program.bind();
    program.setUniformValue("modelToView", matrices.boxToView);
    program.setUniformValue("viewToClip", matrices.viewToClip);
    program.setUniformValue("lineColour", toQt(colours_.box));
    gl.glBindVertexArray(resources_->boxArray);
    gl.glDrawArrays(GL_LINES, 0, kBoxVertices);
    gl.glBindVertexArray(0);
    program.release();
    gl.glDisable(GL_BLEND);
}

void SceneRenderer::drawMarker(const glm::dvec4& place, glm::ivec2 pixels) {
    if (!(place.w > 0.0)) // behind the viewer
        return;
    auto& gl = resources_->gl;
    auto& program = *resources_->markerProgram;
    const float halfPixels = kMarkerPixels * spot_->pixelRatio;
    gl.glEnable(GL_BLEND);
    gl.glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA); // as for the box
    program.bind();
    program.setUniformValue("centre", static_cast<float>(place.x / place.w), static_cast<float>(place.y / place.w));
    program.setUniformValue("halfSize", 2.0f * halfPixels / static_cast<float>(pixels.x),
                            2.0f * halfPixels / static_cast<float>(pixels.y));
    program.setUniformValue("halfPixels", halfPixels);
    program.setUniformValue("pixelRatio", spot_->pixelRatio);
    program.setUniformValue("markerColour", toQt(glm::vec4(colours_.marker, spot_->strength)));
    gl.glBindVertexArray(resources_->emptyArray);
    gl.glDrawArrays(GL_TRIANGLE_STRIP, 0, 4);
    gl.glBindVertexArray(0);
    program.release();
    gl.glDisable(GL_BLEND);
}

void SceneRenderer::drawSurface(const Matrices& matrices, bool isPerspective, const model::ViewOptions& options) {
    auto& bricks = resources_->bricks;
    auto& arrays = resources_->arrays;
    if (bricks.isEmpty() && arrays.isEmpty())
        return;
    auto& gl = resources_->gl;
    const bool isOfBricks = !bricks.isEmpty();
    auto& program = isOfBricks ? *resources_->bricksProgram : *resources_->arraysProgram;
    // Triangles are counter-clockwise from outside in index space; a mirroring map turns them.
    gl.glFrontFace(frame_->geometry.isLeftHanded() ? GL_CW : GL_CCW);
    program.bind();
    if (isOfBricks) {
        program.setUniformValue("places", 0);
        program.setUniformValue("isovalue", static_cast<float>(frame_->isovalue));
    }
    program.setUniformValue("modelToView", matrices.modelToView);
    program.setUniformValue("viewToClip", matrices.viewToClip);
    program.setUniformValue("normalToView", matrices.normalToView);
    program.setUniformValue("frontColour", toQt(colours_.front));
    program.setUniformValue("backColour", toQt(colours_.back));
    program.setUniformValue("highlightColour", QVector4D());
    program.setUniformValue("spot", toQt(glm::vec4(matrices.spot, kSpotCells)));
    program.setUniformValue("spotColour", toQt(glm::vec4(colours_.spot, spot_ ? kSpotShare * spot_->strength : 0.0f)));
    std::array<QVector3D, 4> levels;
    std::transform(colours_.levels.begin(), colours_.levels.end(), levels.begin(),
                   [](const glm::vec3& colour) { return toQt(colour); });
    program.setUniformValueArray("levelColours", levels.data(), static_cast<int>(levels.size()));
    program.setUniformValue("levelShare", options.showsLevels ? 1.0f : 0.0f);
    program.setUniformValue("perspective", isPerspective ? 1.0f : 0.0f);
    if (options.showsEdges) { // lines in the triangles' own planes need room behind them
        gl.glEnable(GL_POLYGON_OFFSET_FILL);
        gl.glPolygonOffset(1.0f, 1.0f);
    }
    isOfBricks ? bricks.drawSurface(matrices.modelToClip) : arrays.drawSurface();
    gl.glDisable(GL_POLYGON_OFFSET_FILL);
    if (options.showsChanged && hasFewChanges()) {
        program.setUniformValue("highlightColour", toQt(colours_.highlight));
        gl.glEnable(GL_POLYGON_OFFSET_FILL);
        gl.glPolygonOffset(-1.0f, -1.0f);
        isOfBricks ? bricks.drawChanged() : arrays.drawChanged();
        gl.glDisable(GL_POLYGON_OFFSET_FILL);
    }
    if (options.showsEdges) {
        program.setUniformValue("highlightColour", toQt(colours_.edges));
        program.setUniformValue("spotColour", QVector4D());
        gl.glPolygonMode(GL_FRONT_AND_BACK, GL_LINE);
        gl.glEnable(GL_POLYGON_OFFSET_LINE);
        gl.glPolygonOffset(-1.0f, -1.0f);
        isOfBricks ? bricks.drawSurface(matrices.modelToClip) : arrays.drawSurface();
        gl.glDisable(GL_POLYGON_OFFSET_LINE);
        gl.glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
    }
    program.release();
    gl.glFrontFace(GL_CCW);
}

// Where all of the surface is new, red on all of it would state nothing.
bool SceneRenderer::hasFewChanges() const {
    constexpr double kLargestHighlight = 0.95;
    const auto& [changed, all] =
        resources_->bricks.isEmpty()
            ? std::pair(resources_->arrays.changedIndices(), resources_->arrays.surfaceIndices())
            : std::pair(frame_->bricks->changedIndices().size(), 3 * frame_->stats.triangles);
    return changed > 0 && static_cast<double>(changed) < kLargestHighlight * static_cast<double>(all);
}

} // namespace isoslider::render
