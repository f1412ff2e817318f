#include "ui/render/clip_guides.h"

#include <array>
#include <cmath>

#include <QVector2D>
#include <QVector3D>
#include <QVector4D>

#include <glm/geometric.hpp>

#include "ui/render/plane_points.h"
#include "ui/render/slice_planes.h"

namespace isoslider::render {
namespace {

constexpr int kBoxPoints = 24;
const QVector4D kCropColour(0.98f, 0.66f, 0.30f, 0.95f); // as seen; apart from the volume's box
const QVector4D kPlaneColour(0.45f, 0.80f, 0.98f, 0.95f);
const QVector4D kOtherPlaneColour(0.45f, 0.80f, 0.98f, 0.45f); // of the plane that is not moved
const QVector3D kCapColour(0.66f, 0.33f, 0.17f); // linear light: the surface's hue, darker and warmer
constexpr float kCapShare = 0.6f; // of the colour of any other surface: darker than its outside
constexpr float kCapLight = 0.75f; // as a surface that faces the light

void addBox(std::vector<float>& data, const model::CropBox& box) {
    for (int axis = 0; axis < 3; ++axis)
        for (int corner = 0; corner < 4; ++corner)
            for (const bool isEnd : {false, true}) {
                glm::dvec3 place(0.0);
                const std::array<bool, 3> isHigh{isEnd, (corner & 1) != 0, (corner & 2) != 0};
                for (int next = 0; next < 3; ++next) {
                    const auto a = static_cast<std::size_t>((axis + next) % 3);
                    place[static_cast<int>(a)] =
                        static_cast<double>(isHigh[static_cast<std::size_t>(next)] ? box.high[a] : box.low[a]);
                }
                addPoint(data, place);
            }
}

/// Where the plane leaves the box.
int addBorder(std::vector<float>& data, const model::ClipPlane& plane, const model::CropBox& box,
              const GridGeometry& volume) {
    extract::SlicePlane pixels = model::capPlaneOf(plane, volume, 1);
    const glm::dvec3 low(box.low[0], box.low[1], box.low[2]);
    pixels.origin -= low;
    GridDims dims{};
    for (std::size_t a = 0; a < 3; ++a)
        dims[a] = box.high[a] - box.low[a] + 1;
    const auto border = borderOf(pixels, dims);
    for (const glm::vec3& point : border)
        addPoint(data, low + glm::dvec3(point));
    return static_cast<int>(border.size());
}

bool isCapped(const model::ClipPlane& plane, const CapScene& cap) {
    return plane.isOn && plane.cap != model::Cap::None && cap.samples != nullptr;
}

model::CropBox drawnBox(const model::Clipping& clipping, const GridGeometry& volume) {
    return clipping.isCropped ? model::cropWithin(clipping.crop, volume.dims) : model::wholeBox(volume.dims);
}

} // namespace

model::Clipping drawnClipping(const model::Clipping& wanted, const CapScenes& caps) {
    model::Clipping drawn = wanted;
    for (std::size_t place = 0; place < caps.size(); ++place)
        if (isCapped(drawn.planes[place], caps[place])) {
            drawn.planes[place].normal = caps[place].samples->of.normal;
            drawn.planes[place].offset = caps[place].samples->of.offset;
        }
    return drawn;
}

void setCuts(Gl& gl, QOpenGLShaderProgram& program, std::span<const glm::dvec4> cuts) {
    std::array<QVector4D, model::kMostCuts> values;
    for (std::size_t i = 0; i < cuts.size(); ++i)
        values[i] = QVector4D(static_cast<float>(cuts[i].x), static_cast<float>(cuts[i].y),
                              static_cast<float>(cuts[i].z), static_cast<float>(cuts[i].w));
    program.setUniformValue("cutCount", static_cast<int>(cuts.size()));
    if (!cuts.empty())
        program.setUniformValueArray("cuts", values.data(), static_cast<int>(cuts.size()));
    for (std::size_t i = 0; i < model::kMostCuts; ++i) {
        const auto plane = static_cast<GLenum>(GL_CLIP_DISTANCE0 + i);
        i < cuts.size() ? gl.glEnable(plane) : gl.glDisable(plane);
    }
}

void clearCuts(Gl& gl) {
    for (std::size_t i = 0; i < model::kMostCuts; ++i)
        gl.glDisable(static_cast<GLenum>(GL_CLIP_DISTANCE0 + i));
}

ClipGuides::ClipGuides(Gl& gl, GlDriver& driver) : gl_(gl), driver_(driver) {}

ClipGuides::~ClipGuides() {
    if (array_ == 0)
        return;
    driver_.freeBuffer(gl_, buffer_);
    gl_.glDeleteVertexArrays(1, &array_);
    for (const Texture& texture : textures_)
        gl_.glDeleteTextures(1, &texture.name);
}

void ClipGuides::abandon() { array_ = 0; }

bool ClipGuides::initialize() {
    if (isReady_ || isBroken_)
        return isReady_;
    capProgram_ = loadProgram("cap");
    isReady_ = capProgram_ != nullptr;
    isBroken_ = !isReady_;
    if (!isReady_)
        return false;
    gl_.glGenVertexArrays(1, &array_);
    for (Texture& texture : textures_)
        gl_.glGenTextures(1, &texture.name);
    buffer_ = driver_.makeBuffer(gl_);
    return true;
}

bool ClipGuides::fill(const std::vector<float>& data) {
    const std::size_t bytes = data.size() * sizeof(float);
    gl_.glBindVertexArray(array_);
    if (!driver_.allocate(gl_, GL_ARRAY_BUFFER, buffer_, bytes))
        return false;
    gl_.glBufferSubData(GL_ARRAY_BUFFER, 0, static_cast<GLsizeiptr>(bytes), data.data());
    constexpr GLsizei kStride = kFloatsPerPoint * sizeof(float);
    gl_.glEnableVertexAttribArray(0);
    gl_.glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, kStride, nullptr);
    gl_.glEnableVertexAttribArray(1);
    gl_.glVertexAttribPointer(1, 2, GL_FLOAT, GL_FALSE, kStride, reinterpret_cast<const void*>(3 * sizeof(float)));
    return true;
}

bool ClipGuides::uploadCap(GLuint texture, const model::CapSamples& samples) {
    gl_.glBindTexture(GL_TEXTURE_2D, texture);
    gl_.glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    gl_.glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    gl_.glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    gl_.glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    forgetErrors(gl_);
    gl_.glTexImage2D(GL_TEXTURE_2D, 0, GL_RG32F, samples.plane.width, samples.plane.height, 0, GL_RG, GL_FLOAT,
                     samples.pixels.data());
    return gl_.glGetError() == GL_NO_ERROR;
}

void ClipGuides::draw(const model::Clipping& clipping, const CapScenes& caps, const View& view) {
    if (!clipping.clipsAnything() || !initialize()) {
        for (Texture& texture : textures_)
            texture.content.reset();
        return;
    }
    for (std::size_t place = 0; place < caps.size(); ++place)
        if (isCapped(clipping.planes[place], caps[place]))
            drawCap(clipping, place, caps[place], view);
    drawLines(clipping, view);
    gl_.glBindVertexArray(0);
}

void ClipGuides::drawCap(const model::Clipping& clipping, std::size_t place, const CapScene& cap, const View& view) {
    Texture& texture = textures_[place];
    const glm::dvec3 facing = glm::normalize(view.camera.normalMatrix() * clipping.planes[place].normal);
    const float light = 0.6f + 0.4f * static_cast<float>(std::abs(facing.z)); // the more the plane faces the viewer
    gl_.glActiveTexture(GL_TEXTURE0);
    gl_.glBindTexture(GL_TEXTURE_2D, texture.name);
    if (texture.content != cap.samples) {
        texture.content = cap.samples; // also where it is refused: not at every picture again
        texture.isRefused = !uploadCap(texture.name, *cap.samples);
    }
    std::vector<float> quad;
    addQuad(quad, cap.samples->plane);
    if (!texture.isRefused && fill(quad)) {
        QOpenGLShaderProgram& program = *capProgram_;
        program.bind();
        program.setUniformValue("modelToView", view.seen.modelToView);
        program.setUniformValue("viewToClip", view.seen.viewToClip);
        program.setUniformValue("samples", 0);
        program.setUniformValue("capLight", kCapLight * light);
        view.uniforms.set(program, view.colours, view.volume, view.volume);
        program.setUniformValue("greyWindow",
                                QVector2D(static_cast<float>(cap.window.low), static_cast<float>(cap.window.width())));
        program.setUniformValue("valueShare", clipping.planes[place].cap == model::Cap::Values ? 1.0f : 0.0f);
        // Values continue beyond the volume's sides and the other plane, the cap does not.
        model::Clipping others = clipping;
        others.isCropped = true;
        others.crop = drawnBox(clipping, view.volume);
        others.planes[place].isOn = false;
        setCuts(gl_, program, model::cutsOf(others, view.volume, view.volume));
        for (const Fill& fill : view.fills) {
            const QVector3D colour =
                fill.colour ? kCapShare * QVector3D(fill.colour->r, fill.colour->g, fill.colour->b) : kCapColour;
            program.setUniformValue("isovalue", fill.isovalue);
            program.setUniformValue("capColour", colour * light);
            gl_.glDrawArrays(GL_TRIANGLE_STRIP, 0, kQuadPoints);
        }
        clearCuts(gl_);
        program.release();
    }
    gl_.glBindTexture(GL_TEXTURE_2D, 0);
}

// Behind the surface they are hidden by it.
void ClipGuides::drawLines(const model::Clipping& clipping, const View& view) {
    std::vector<float> data;
    const model::CropBox box = drawnBox(clipping, view.volume);
    addBox(data, box);
    std::array<int, model::kClipPlanes> borders{};
    for (std::size_t place = 0; place < borders.size(); ++place)
        if (clipping.planes[place].isOn)
            borders[place] = addBorder(data, clipping.planes[place], box, view.volume);
    if (!fill(data))
        return;
    auto& program = view.lines.bind(view.seen);
    if (clipping.isCropped) {
        program.setUniformValue("lineColour", kCropColour);
        gl_.glDrawArrays(GL_LINES, 0, kBoxPoints);
    }
    int first = kBoxPoints;
    for (std::size_t place = 0; place < borders.size(); ++place) {
        program.setUniformValue("lineColour", place == clipping.active ? kPlaneColour : kOtherPlaneColour);
        gl_.glDrawArrays(GL_LINE_LOOP, first, borders[place]);
        first += borders[place];
    }
    program.release();
}

} // namespace isoslider::render
