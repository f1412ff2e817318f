#include "ui/render/slice_planes.h"

#include <algorithm>
#include <cmath>

#include <QVector4D>

#include <glm/geometric.hpp>

#include "ui/render/plane_points.h"

namespace isoslider::render {
namespace {

QVector4D lineColour(const glm::vec3& colour, float alpha) { return {colour.x, colour.y, colour.z, alpha}; }

} // namespace

std::vector<glm::vec3> borderOf(const extract::SlicePlane& plane, const GridDims& dims) {
    const glm::dvec3 last(dims[0] - 1, dims[1] - 1, dims[2] - 1);
    const glm::dvec3 normal = glm::normalize(plane.normal());
    const auto sideOf = [&](const glm::dvec3& p) {
        const double side = glm::dot(normal, p - plane.origin);
        return std::abs(side) < 1e-7 ? 0.0 : side;
    };
    std::vector<glm::dvec3> points;
    for (int axis = 0; axis < 3; ++axis)
        for (int corner = 0; corner < 4; ++corner) {
            glm::dvec3 begin(0.0);
            begin[(axis + 1) % 3] = (corner & 1) != 0 ? last[(axis + 1) % 3] : 0.0;
            begin[(axis + 2) % 3] = (corner & 2) != 0 ? last[(axis + 2) % 3] : 0.0;
            glm::dvec3 end = begin;
            end[axis] = last[axis];
            const double a = sideOf(begin), b = sideOf(end);
            if (a == 0.0)
                points.push_back(begin);
            if (b == 0.0)
                points.push_back(end);
            if (a * b < 0.0)
                points.push_back(begin + (end - begin) * (a / (a - b)));
        }
    glm::dvec3 middle(0.0);
    for (const auto& p : points)
        middle += p / static_cast<double>(points.size());
    const glm::dvec3 right = glm::normalize(plane.right), up = glm::cross(normal, right);
    const auto angleOf = [&](const glm::dvec3& p) {
        return std::atan2(glm::dot(p - middle, up), glm::dot(p - middle, right));
    };
    std::sort(points.begin(), points.end(),
              [&](const glm::dvec3& a, const glm::dvec3& b) { return angleOf(a) < angleOf(b); });
    std::vector<glm::vec3> border;
    for (const auto& p : points) // a corner of the box is on three edges
        if (border.empty() || glm::distance(glm::vec3(p), border.back()) > 1e-4f)
            border.emplace_back(p);
    if (border.size() > 1 && glm::distance(border.front(), border.back()) <= 1e-4f)
        border.pop_back();
    return border.size() < 3 ? std::vector<glm::vec3>() : border;
}

SlicePlanes::SlicePlanes(Gl& gl, GlDriver& driver) : gl_(gl), driver_(driver) {}

SlicePlanes::~SlicePlanes() {
    resize(0);
    free(lines_);
}

void SlicePlanes::abandon() {
    planes_.clear();
    lines_ = {};
    crosshair_.reset();
}

void SlicePlanes::free(Plane& plane) {
    if (plane.texture != 0)
        gl_.glDeleteTextures(1, &plane.texture);
    if (plane.array != 0)
        gl_.glDeleteVertexArrays(1, &plane.array);
    if (plane.buffer != 0)
        driver_.freeBuffer(gl_, plane.buffer);
    plane = {};
}

void SlicePlanes::resize(std::size_t count) {
    while (planes_.size() > count) {
        free(planes_.back());
        planes_.pop_back();
    }
    planes_.resize(count);
}

bool SlicePlanes::initialize() {
    if (isReady_ || isBroken_)
        return isReady_;
    planeProgram_ = loadProgram("slice");
    isReady_ = planeProgram_ != nullptr;
    isBroken_ = !isReady_;
    return isReady_;
}

bool SlicePlanes::fill(Plane& plane, const std::vector<float>& data) {
    if (plane.array == 0) {
        gl_.glGenVertexArrays(1, &plane.array);
        plane.buffer = driver_.makeBuffer(gl_);
    }
    gl_.glBindVertexArray(plane.array);
    const std::size_t bytes = data.size() * sizeof(float);
    const bool isThere = driver_.allocate(gl_, GL_ARRAY_BUFFER, plane.buffer, bytes);
    if (isThere) {
        gl_.glBufferSubData(GL_ARRAY_BUFFER, 0, static_cast<GLsizeiptr>(bytes), data.data());
        constexpr GLsizei kStride = kFloatsPerPoint * sizeof(float);
        gl_.glEnableVertexAttribArray(0);
        gl_.glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, kStride, nullptr);
        gl_.glEnableVertexAttribArray(1);
        gl_.glVertexAttribPointer(1, 2, GL_FLOAT, GL_FALSE, kStride, reinterpret_cast<const void*>(3 * sizeof(float)));
    }
    gl_.glBindVertexArray(0);
    return isThere;
}

void SlicePlanes::upload(const SliceInScene& slice, const GridDims& dims, Plane& plane) {
    if (plane.shades == slice.shades && plane.contour == slice.contour)
        return; // also where it was refused: not at every picture again
    plane.shades = slice.shades;
    plane.contour = slice.contour;
    const auto& shades = *slice.shades;
    std::vector<float> data;
    addQuad(data, shades.plane);
    const auto border = borderOf(shades.plane, dims);
    for (const glm::vec3& point : border)
        addPoint(data, point);
    if (slice.contour)
        for (const glm::vec3& point : slice.contour->points)
            addPoint(data, point);
    plane.borderPoints = static_cast<int>(border.size());
    plane.isRefused = !fill(plane, data);
    if (plane.isRefused || plane.inTexture == slice.shades)
        return;
    uploadTexture(plane);
}

void SlicePlanes::uploadTexture(Plane& plane) {
    const auto& shades = *plane.shades;
    if (plane.texture == 0)
        gl_.glGenTextures(1, &plane.texture);
    gl_.glBindTexture(GL_TEXTURE_2D, plane.texture);
    gl_.glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    gl_.glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    gl_.glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    gl_.glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    forgetErrors(gl_);
    gl_.glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, shades.plane.width, shades.plane.height, 0, GL_BGRA,
                     GL_UNSIGNED_INT_8_8_8_8_REV, shades.pixels.data());
    plane.isRefused = gl_.glGetError() != GL_NO_ERROR;
    plane.inTexture = plane.isRefused ? nullptr : plane.shades;
    gl_.glBindTexture(GL_TEXTURE_2D, 0);
}

void SlicePlanes::uploadCrosshair(const SliceScene& scene, const GridDims& dims) {
    if (!scene.crosshair || crosshair_ == scene.crosshair)
        return;
    crosshair_ = scene.crosshair;
    std::vector<float> data;
    for (int axis = 0; axis < 3; ++axis) {
        glm::vec3 begin(*scene.crosshair), end(*scene.crosshair);
        begin[axis] = 0.0f;
        end[axis] = static_cast<float>(dims[static_cast<std::size_t>(axis)] - 1);
        addPoint(data, begin);
        addPoint(data, end);
    }
    lines_.isRefused = !fill(lines_, data);
    if (lines_.isRefused) // so few bytes are tried again
        crosshair_.reset();
}

void SlicePlanes::draw(const SliceScene& scene, const GridDims& dims, const LineView& view, LineProgram& lines) {
    if (scene.isEmpty()) {
        resize(0);
        free(lines_);
        crosshair_.reset();
        return;
    }
    if (!initialize())
        return;
    resize(scene.slices.size());
    for (std::size_t i = 0; i < planes_.size(); ++i)
        upload(scene.slices[i], dims, planes_[i]);
    uploadCrosshair(scene, dims);
    planeProgram_->bind();
    planeProgram_->setUniformValue("modelToView", view.modelToView);
    planeProgram_->setUniformValue("viewToClip", view.viewToClip);
    planeProgram_->setUniformValue("shades", 0);
    gl_.glActiveTexture(GL_TEXTURE0);
    gl_.glEnable(GL_POLYGON_OFFSET_FILL); // lines in the plane are in front of it, from either side
    gl_.glPolygonOffset(1.0f, 1.0f);
    for (const Plane& plane : planes_)
        if (!plane.isRefused) {
            gl_.glBindTexture(GL_TEXTURE_2D, plane.texture);
            gl_.glBindVertexArray(plane.array);
            gl_.glDrawArrays(GL_TRIANGLE_STRIP, 0, kQuadPoints);
        }
    gl_.glDisable(GL_POLYGON_OFFSET_FILL);
    gl_.glBindTexture(GL_TEXTURE_2D, 0);
    gl_.glBindVertexArray(0);
    planeProgram_->release();
    drawLines(scene, view, lines);
}

void SlicePlanes::drawLines(const SliceScene& scene, const LineView& view, LineProgram& lines) {
    auto& program = lines.bind(view);
    for (std::size_t i = 0; i < planes_.size(); ++i) {
        const Plane& plane = planes_[i];
        if (plane.isRefused)
            continue;
        gl_.glBindVertexArray(plane.array);
        program.setUniformValue("lineColour", lineColour(scene.slices[i].colour, 1.0f));
        gl_.glDrawArrays(GL_LINE_LOOP, kQuadPoints, plane.borderPoints);
        int drawn = 0;
        for (const auto& part : plane.contour ? plane.contour->parts : std::vector<model::SliceContour::Part>()) {
            const glm::vec3 seen(part.colour[0], part.colour[1], part.colour[2]);
            const int end = static_cast<int>(part.pointEnd);
            program.setUniformValue("lineColour", lineColour(seen / 255.0f, 1.0f));
            gl_.glDrawArrays(GL_LINES, kQuadPoints + plane.borderPoints + drawn, end - drawn);
            drawn = end;
        }
    }
    drawCrosshair(scene, program);
    gl_.glBindVertexArray(0);
    program.release();
}

// Faint where something is in front of it.
void SlicePlanes::drawCrosshair(const SliceScene& scene, QOpenGLShaderProgram& program) {
    if (!scene.crosshair || lines_.isRefused)
        return;
    gl_.glBindVertexArray(lines_.array);
    gl_.glEnable(GL_BLEND);
    gl_.glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA); // as for the box
    for (const float alpha : {0.22f, 0.9f}) {
        alpha < 0.5f ? gl_.glDisable(GL_DEPTH_TEST) : gl_.glEnable(GL_DEPTH_TEST);
        for (int axis = 0; axis < 3; ++axis) {
            program.setUniformValue("lineColour", lineColour(scene.axisColours[static_cast<std::size_t>(axis)], alpha));
            gl_.glDrawArrays(GL_LINES, 2 * axis, 2);
        }
    }
    gl_.glDisable(GL_BLEND);
}

} // namespace isoslider::render
