#include "ui/render/scene_renderer.h"

#include <algorithm>
#include <array>

#include <QMatrix3x3>
#include <QMatrix4x4>
#include <QOpenGLVersionFunctionsFactory>
#include <QVector3D>
#include <QVector4D>

#include <glm/geometric.hpp>

#include "core/grid/world_normals.h"
#include "ui/render/ambient_occlusion.h"
#include "ui/render/array_buffers.h"
#include "ui/render/brick_buffers.h"
#include "ui/render/clip_guides.h"
#include "ui/render/colour_uniforms.h"
#include "ui/render/inactive_buffers.h"
#include "ui/render/slice_planes.h"
#include "ui/render/stage_colours.h"
#include "ui/render/transparent_layers.h"

namespace isoslider::render {
namespace {

constexpr int kBoxVertices = 24;
/// Drafts of larger surfaces are coarser, in blocks of so many cells.
constexpr std::array<std::pair<std::uint64_t, int>, 3> kDraftBlocks{{{1'500'000, 8}, {600'000, 4}, {120'000, 2}}};
constexpr double kLargestHighlight = 0.95; // of the surface: where all of it is new, red on it would state nothing
constexpr float kSpotCells = 1.5f; // around the middle
constexpr float kSpotShare = 0.9f; // of the surface's colour at full strength
constexpr float kMarkerPixels = 24.0f; // half the side of its square
constexpr float kInsideShare = 0.45f; // of a surface's colour, on the side of higher values; as for pieces

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

/// 1: it is drawn whole. What is transparent is drawn several times.
int draftBlockCells(const extract::SurfaceFrame& frame, const SurfaceLook& look) {
    const std::uint64_t drawn = frame.stats.triangles * (look.isOpaque() ? 1 : TransparentLayers::kMostDraftLayers);
    for (const auto& [more, cells] : kDraftBlocks)
        if (frame.bricks && drawn > more)
            return cells;
    return 1;
}

/// No program of what is opaque has these.
void setPeeling(QOpenGLShaderProgram& program) {
    program.setUniformValue("opaqueDepth", TransparentLayers::kOpaqueUnit);
    program.setUniformValue("peeledDepth", TransparentLayers::kPeeledUnit);
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
    SurfaceView surface;
    QMatrix4x4 modelToView;
    QMatrix4x4 boxToView;
    QMatrix4x4 viewToClip;
    QMatrix3x3 normalToView;
    glm::vec3 spot; ///< index units of the grid
    glm::dvec4 spotInWorld, spotInClip;
};

/// A surface, and how it is drawn.
struct SceneRenderer::OnCard {
    const extract::SurfaceFrame& frame;
    SurfaceBuffers& buffers; ///< with something to draw
    SurfaceLook look;
    bool isActive;
    bool isOfVolume;
    Matrices matrices;
};

struct SceneRenderer::Resources {
    Resources(Gl& functions, GlDriver& usedDriver)
        : gl(functions),
          driver(usedDriver),
          active(functions, usedDriver),
          inactive(functions, usedDriver),
          occlusion(functions),
          layers(functions),
          slices(functions, usedDriver),
          clipGuides(functions, usedDriver),
          colours(functions) {
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

    bool canPeel() const {
        return arraysPeelingProgram != nullptr && bricksPeelingProgram != nullptr && linesPeeling.isReady();
    }

    Gl& gl;
    GlDriver& driver;
    SurfaceBuffers active;
    InactiveBuffers inactive;
    AmbientOcclusion occlusion;
    TransparentLayers layers;
    SlicePlanes slices;
    ClipGuides clipGuides;
    ColourUniforms colours;
    bool isAbandoned = false;
    bool hasBox = false;
    GLuint emptyArray = 0;
    GLuint boxArray = 0;
    GLuint boxBuffer = 0;
    std::unique_ptr<QOpenGLShaderProgram> backgroundProgram;
    LineProgram lines;
    LineProgram linesPeeling{"PEELING"};
    std::unique_ptr<QOpenGLShaderProgram> markerProgram;
    std::unique_ptr<QOpenGLShaderProgram> arraysProgram;
    std::unique_ptr<QOpenGLShaderProgram> bricksProgram;
    std::unique_ptr<QOpenGLShaderProgram> arraysPeelingProgram, bricksPeelingProgram;
    WideEdgesProgram wideEdgesOfArrays{"surface"}, wideEdgesOfBricks{"surface_bricks"};
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
    resources_->lines.initialize();
    resources_->linesPeeling.initialize();
    resources_->markerProgram = loadProgram("marker");
    resources_->arraysProgram = loadProgram("surface");
    resources_->bricksProgram = loadProgram("surface_bricks", "surface");
    resources_->arraysPeelingProgram = loadProgram("surface", "surface", "PEELING");
    resources_->bricksPeelingProgram = loadProgram("surface_bricks", "surface", "PEELING");
    isBoxNew_ = true;
    if (resources_->backgroundProgram && resources_->lines.isReady() && resources_->markerProgram &&
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
    resources_->active.abandon();
    resources_->inactive.abandon();
    resources_->occlusion.abandon();
    resources_->layers.abandon();
    resources_->slices.abandon();
    resources_->clipGuides.abandon();
    resources_->colours.abandon();
    resources_.reset();
}

void SceneRenderer::setFrame(const SceneView& view) {
    const GridGeometry volume = view.volume.value_or(view.frame ? view.frame->geometry : volume_);
    isBoxNew_ = isBoxNew_ || volume != volume_;
    frame_ = view.frame;
    volume_ = volume;
    resources_->active.show(frame_, view.options.pieces);
    resources_->inactive.show(view.inactive);
    if (std::exchange(isBoxNew_, false))
        uploadBox();
}

std::uint64_t SceneRenderer::refusedBytes() const {
    return resources_ ? std::max(resources_->active.refusedBytes(), resources_->inactive.refusedBytes()) : 0;
}

std::uint64_t SceneRenderer::uploadedBytes() const {
    return resources_ ? resources_->active.uploadedBytes() + resources_->inactive.uploadedBytes() : 0;
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

SceneRenderer::Matrices SceneRenderer::matricesOf(const GridGeometry& grid, const SceneView& sceneView) const {
    const glm::ivec2 pixels = sceneView.pixels;
    const glm::dmat4 view = sceneView.camera.viewMatrix();
    Matrices matrices{};
    const glm::dmat4 projection = sceneView.camera.projectionMatrix(static_cast<double>(pixels.x) / pixels.y);
    const glm::dmat4 modelToView = view * indexToCentredWorld(grid, volume_);
    matrices.surface.modelToClip = projection * modelToView;
    matrices.modelToView = toQt(modelToView);
    matrices.boxToView = toQt(view * indexToCentredWorld(volume_, volume_));
    matrices.viewToClip = toQt(projection);
    matrices.normalToView = toQt(sceneView.camera.normalMatrix() * normalToWorld(grid));
    if (sceneView.spot) {
        matrices.spotInWorld = indexToCentredWorld(volume_, volume_) * glm::dvec4(sceneView.spot->place, 1.0);
        matrices.spotInClip = projection * view * matrices.spotInWorld;
        matrices.spot = glm::dvec3(glm::inverse(indexToCentredWorld(grid, volume_)) * matrices.spotInWorld);
    }
    matrices.surface.cuts = model::cutsOf(drawnClipping(sceneView.options.clipping, sceneView.caps), grid, volume_);
    return matrices;
}

bool SceneRenderer::draw(const SceneView& view, Detail detail, const std::function<bool()>& isStopped) {
    if (!resources_ || view.pixels.x <= 0 || view.pixels.y <= 0)
        return true;
    setFrame(view);
    resources_->colours.upload(view.colours);
    auto& gl = resources_->gl;
    gl.glViewport(0, 0, view.pixels.x, view.pixels.y);
    gl.glDepthMask(GL_TRUE);
    gl.glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    gl.glDisable(GL_CULL_FACE);
    drawBackground(view);
    if (!frame_ && view.inactive.empty())
        return true;
    const Matrices ofVolume = matricesOf(volume_, view);
    const std::vector<OnCard> surfaces = surfacesOf(view, detail);
    gl.glEnable(GL_DEPTH_TEST);
    gl.glDepthFunc(GL_LEQUAL);
    for (const OnCard& surface : surfaces)
        if (!drawOpaque(surface, view, isStopped))
            return false;
    if (view.options.stage.hasOcclusion && detail == Detail::Whole)
        resources_->occlusion.draw(view.pixels, view.camera);
    resources_->slices.draw(view.slices, volume_.dims,
                            {ofVolume.boxToView, ofVolume.viewToClip, view.lineWidth, view.pixels}, resources_->lines);
    if (frame_)
        drawClipGuides(ofVolume, view);
    if (isAnyTransparent(surfaces)) {
        if (!drawTransparent(surfaces, ofVolume, view, detail, isStopped))
            return false;
    } else if (view.options.showsBox && resources_->hasBox) {
        drawBox(ofVolume, view);
    }
    gl.glDisable(GL_DEPTH_TEST);
    if (view.spot && frame_)
        drawMarker(*view.spot, ofVolume.spotInClip, view.pixels);
    return true;
}

void SceneRenderer::drawBackground(const SceneView& view) {
    const StageColours staged = coloursOf(view.options.stage.background);
    auto& gl = resources_->gl;
    auto& program = *resources_->backgroundProgram;
    gl.glDisable(GL_DEPTH_TEST);
    gl.glDisable(GL_BLEND);
    program.bind();
    program.setUniformValue("bottomColour", toQt(view.plainBackground.value_or(staged.bottom)));
    program.setUniformValue("topColour", toQt(view.plainBackground.value_or(staged.top)));
    gl.glBindVertexArray(resources_->emptyArray);
    gl.glDrawArrays(GL_TRIANGLES, 0, 3);
    gl.glBindVertexArray(0);
    program.release();
}

void SceneRenderer::drawBox(const Matrices& matrices, const SceneView& view) {
    auto& gl = resources_->gl;
    gl.glEnable(GL_BLEND);
    // Alpha stays 1: the widget is composed as premultiplied, and a hole would overflow its colour.
    gl.glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
    drawBoxLines(resources_->lines, matrices, view);
    gl.glDisable(GL_BLEND);
}

void SceneRenderer::drawBoxLines(LineProgram& lines, const Matrices& matrices, const SceneView& view) {
    auto& gl = resources_->gl;
    auto& program = lines.bind({matrices.boxToView, matrices.viewToClip, view.lineWidth, view.pixels});
    setPeeling(program);
    program.setUniformValue("lineColour", toQt(coloursOf(view.options.stage.background).box));
    gl.glBindVertexArray(resources_->boxArray);
    gl.glDrawArrays(GL_LINES, 0, kBoxVertices);
    gl.glBindVertexArray(0);
    program.release();
}

void SceneRenderer::drawClipGuides(const Matrices& ofVolume, const SceneView& view) {
    const model::Clipping clipping = drawnClipping(view.options.clipping, view.caps);
    std::vector<ClipGuides::Fill> fills;
    if (view.look.isVisible)
        fills.push_back({static_cast<float>(frame_->isovalue), view.look.colour});
    for (const InactiveSurface& surface : view.inactive)
        if (surface.isOfVolume && surface.look.isVisible)
            fills.push_back({static_cast<float>(surface.frame->isovalue), surface.look.colour});
    // Alone, the first of all colours has a cap that is apart from it; beside others a cap says whose it is.
    for (ClipGuides::Fill& fill : fills)
        if (fills.size() > 1 && !fill.colour)
            fill.colour = colours_.front;
    std::stable_sort(fills.begin(), fills.end(), [](const auto& a, const auto& b) { return a.isovalue < b.isovalue; });
    const model::SurfaceColours colours = isColouredByField(view.options) ? view.colours : model::SurfaceColours();
    resources_->clipGuides.draw(clipping, view.caps,
                                {{ofVolume.boxToView, ofVolume.viewToClip, view.lineWidth, view.pixels},
                                 resources_->lines,
                                 volume_,
                                 fills,
                                 view.camera,
                                 resources_->colours,
                                 colours});
}

void SceneRenderer::drawMarker(const Spot& spot, const glm::dvec4& place, glm::ivec2 pixels) {
    if (!(place.w > 0.0)) // behind the viewer
        return;
    auto& gl = resources_->gl;
    auto& program = *resources_->markerProgram;
    const float halfPixels = kMarkerPixels * spot.pixelRatio;
    gl.glEnable(GL_BLEND);
    gl.glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA); // as for the box
    program.bind();
    program.setUniformValue("centre", static_cast<float>(place.x / place.w), static_cast<float>(place.y / place.w));
    program.setUniformValue("halfSize", 2.0f * halfPixels / static_cast<float>(pixels.x),
                            2.0f * halfPixels / static_cast<float>(pixels.y));
    program.setUniformValue("halfPixels", halfPixels);
    program.setUniformValue("pixelRatio", spot.pixelRatio);
    program.setUniformValue("markerColour", toQt(glm::vec4(colours_.marker, spot.strength)));
    gl.glBindVertexArray(resources_->emptyArray);
    gl.glDrawArrays(GL_TRIANGLE_STRIP, 0, 4);
    gl.glBindVertexArray(0);
    program.release();
    gl.glDisable(GL_BLEND);
}

std::vector<SceneRenderer::OnCard> SceneRenderer::surfacesOf(const SceneView& view, Detail detail) {
    std::vector<OnCard> surfaces;
    const auto add = [&](const extract::SurfaceFrame& frame, SurfaceBuffers& buffers, SurfaceLook look, bool isActive,
                         bool isOfVolume) {
        if (!look.isVisible)
            return;
        if (!resources_->canPeel())
            look.opacity = 1.0f; // better than not at all
        Matrices matrices = matricesOf(frame.geometry, view);
        const int blockCells = detail == Detail::Coarse ? draftBlockCells(frame, look) : 1;
        if (buffers.prepare(blockCells, matrices.surface))
            surfaces.push_back({frame, buffers, look, isActive, isOfVolume, std::move(matrices)});
    };
    for (const auto& entry : resources_->inactive.entries())
        add(*entry->surface.frame, entry->buffers, entry->surface.look, false, entry->surface.isOfVolume);
    if (frame_)
        add(*frame_, resources_->active, view.look, true, true);
    return surfaces;
}

void SceneRenderer::useProgram(QOpenGLShaderProgram& program, const OnCard& surface, const SceneView& view) {
    const Matrices& matrices = surface.matrices;
    const auto& options = view.options;
    const bool isActive = surface.isActive;
    const glm::vec3 front = surface.look.colour.value_or(colours_.front);
    const glm::vec3 back = surface.look.colour ? kInsideShare * front : colours_.back;
    // Triangles are counter-clockwise from outside in index space; a mirroring map turns them.
    resources_->gl.glFrontFace(surface.frame.geometry.isLeftHanded() ? GL_CW : GL_CCW);
    program.bind();
    surface.buffers.setUniforms(program);
    program.setUniformValue("modelToView", matrices.modelToView);
    program.setUniformValue("viewToClip", matrices.viewToClip);
    program.setUniformValue("normalToView", matrices.normalToView);
    program.setUniformValue("frontColour", toQt(front));
    program.setUniformValue("backColour", toQt(back));
    const bool isByField = isColouredByField(options, surface.isOfVolume);
    resources_->colours.set(program, isByField ? view.colours : model::SurfaceColours(), surface.frame.geometry,
                            volume_);
    program.setUniformValue("highlightColour", QVector4D());
    program.setUniformValue("spot", toQt(glm::vec4(matrices.spot, kSpotCells)));
    program.setUniformValue(
        "spotColour", toQt(glm::vec4(colours_.spot, view.spot && isActive ? kSpotShare * view.spot->strength : 0.0f)));
    std::array<QVector3D, 4> levels;
    std::transform(colours_.levels.begin(), colours_.levels.end(), levels.begin(),
                   [](const glm::vec3& colour) { return toQt(colour); });
    program.setUniformValueArray("levelColours", levels.data(), static_cast<int>(levels.size()));
    program.setUniformValue("tintShare", surface.buffers.isTinted() ? 1.0f : 0.0f);
    program.setUniformValue("levelShare", options.showsLevels && isActive ? 1.0f : 0.0f);
    const StageLights lights = lightsOf(options.stage.light);
    program.setUniformValue("keyDirection", toQt(lights.key));
    program.setUniformValue("lightShares", toQt(lights.shares));
    program.setUniformValue("perspective", view.camera.isPerspective() ? 1.0f : 0.0f);
    setCuts(resources_->gl, program, matrices.surface.cuts);
}

void SceneRenderer::endProgram(QOpenGLShaderProgram& program) {
    clearCuts(resources_->gl);
    program.release();
    resources_->gl.glFrontFace(GL_CCW);
}

bool SceneRenderer::drawOpaque(const OnCard& surface, const SceneView& view, const std::function<bool()>& isStopped) {
    const bool hasMarks = surface.isActive && (view.options.showsEdges || view.options.showsChanged);
    if (!surface.look.isOpaque() && !hasMarks)
        return true;
    auto& gl = resources_->gl;
    auto& program = surface.buffers.isOfBricks() ? *resources_->bricksProgram : *resources_->arraysProgram;
    useProgram(program, surface, view);
    bool isWhole = true;
    if (surface.look.isOpaque()) {
        if (surface.isActive && view.options.showsEdges) { // lines in the triangles' own planes need room behind them
            gl.glEnable(GL_POLYGON_OFFSET_FILL);
            gl.glPolygonOffset(1.0f, 1.0f);
        }
        isWhole = surface.buffers.draw(surface.matrices.surface, isStopped);
        gl.glDisable(GL_POLYGON_OFFSET_FILL);
    }
    if (isWhole && hasMarks)
        isWhole = drawMarks(program, surface, view, isStopped);
    endProgram(program);
    return isWhole;
}

bool SceneRenderer::drawMarks(QOpenGLShaderProgram& program, const OnCard& surface, const SceneView& view,
                              const std::function<bool()>& isStopped) {
    auto& gl = resources_->gl;
    const model::ViewOptions& options = view.options;
    const double changed = surface.buffers.changedShare();
    if (options.showsChanged && changed > 0.0 && changed < kLargestHighlight) {
        program.setUniformValue("highlightColour", toQt(colours_.highlight));
        gl.glEnable(GL_POLYGON_OFFSET_FILL);
        gl.glPolygonOffset(-1.0f, -1.0f);
        surface.buffers.drawChanged();
        gl.glDisable(GL_POLYGON_OFFSET_FILL);
    }
    if (!options.showsEdges)
        return true;
    auto& wideEdges = surface.buffers.isOfBricks() ? resources_->wideEdgesOfBricks : resources_->wideEdgesOfArrays;
    QOpenGLShaderProgram* const wide = isWideLine(view.lineWidth) ? wideEdges.get() : nullptr;
    QOpenGLShaderProgram& its = wide != nullptr ? *wide : program;
    if (wide != nullptr) {
        useProgram(its, surface, view);
        its.setUniformValue("viewportPixels", static_cast<float>(view.pixels.x), static_cast<float>(view.pixels.y));
        its.setUniformValue("lineWidth", view.lineWidth);
    }
    its.setUniformValue("highlightColour", toQt(colours_.edges));
    its.setUniformValue("spotColour", QVector4D());
    const GLenum offset = wide != nullptr ? GL_POLYGON_OFFSET_FILL : GL_POLYGON_OFFSET_LINE;
    gl.glPolygonMode(GL_FRONT_AND_BACK, wide != nullptr ? GL_FILL : GL_LINE);
    gl.glEnable(offset);
    gl.glPolygonOffset(-1.0f, -1.0f);
    const bool isWhole = surface.buffers.draw(surface.matrices.surface, isStopped);
    gl.glDisable(offset);
    gl.glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
    return isWhole;
}

bool SceneRenderer::isAnyTransparent(const std::vector<OnCard>& surfaces) const {
    return resources_->canPeel() && std::any_of(surfaces.begin(), surfaces.end(),
                                                [](const OnCard& surface) { return !surface.look.isOpaque(); });
}

// The box is transparent itself: its lines are before some surfaces and behind others.
bool SceneRenderer::drawTransparent(const std::vector<OnCard>& surfaces, const Matrices& ofVolume,
                                    const SceneView& view, Detail detail, const std::function<bool()>& isStopped) {
    float leastOpacity = 1.0f;
    for (const OnCard& surface : surfaces)
        leastOpacity = std::min(leastOpacity, surface.look.opacity);
    const auto drawAll = [&] {
        for (const OnCard& surface : surfaces) {
            if (surface.look.isOpaque())
                continue;
            auto& program =
                surface.buffers.isOfBricks() ? *resources_->bricksPeelingProgram : *resources_->arraysPeelingProgram;
            useProgram(program, surface, view);
            setPeeling(program);
            program.setUniformValue("opacity", surface.look.opacity);
            const bool isWhole = surface.buffers.draw(surface.matrices.surface, isStopped);
            endProgram(program);
            if (!isWhole)
                return false;
        }
        if (view.options.showsBox && resources_->hasBox)
            drawBoxLines(resources_->linesPeeling, ofVolume, view);
        return true;
    };
    const int layers = TransparentLayers::layersFor(leastOpacity, detail == Detail::Coarse);
    return resources_->layers.draw(view.pixels, layers, drawAll);
}

} // namespace isoslider::render
