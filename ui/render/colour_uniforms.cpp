#include "ui/render/colour_uniforms.h"

#include <array>
#include <vector>

#include <QVector2D>
#include <QVector4D>

#include <glm/mat4x4.hpp>
#include <glm/matrix.hpp>
#include <glm/vec4.hpp>

#include "ui/render/gl_driver.h"

namespace isoslider::render {
namespace {

using model::ColourBy;

constexpr int kMapColours = 256;
enum ShaderKind { kPlain, kLinear, kDistance, kField }; // as in scalar_colour.glsl

QVector4D row(const glm::dmat4& matrix, int line) {
    return {static_cast<float>(matrix[0][line]), static_cast<float>(matrix[1][line]),
            static_cast<float>(matrix[2][line]), static_cast<float>(matrix[3][line])};
}

/// From index units of the volume to texture coordinates.
glm::dmat4 toTexture(const model::ColourField& field) {
    glm::dmat4 map(1.0);
    for (int axis = 0; axis < 3; ++axis) {
        const double texels = static_cast<double>(field.dims[static_cast<std::size_t>(axis)] * field.step);
        map[axis][axis] = 1.0 / (texels * static_cast<double>(field.gridStep));
        map[3][axis] = 0.5 / texels;
    }
    return map;
}

} // namespace

ColourUniforms::~ColourUniforms() {
    if (mapTexture_ != 0)
        gl_.glDeleteTextures(1, &mapTexture_);
    if (fieldTexture_ != 0)
        gl_.glDeleteTextures(1, &fieldTexture_);
}

void ColourUniforms::abandon() { mapTexture_ = fieldTexture_ = 0; }

void ColourUniforms::upload(const model::SurfaceColours& colours) {
    if (colours.by != ColourBy::One && map_ != std::pair(colours.map, colours.isReversed))
        uploadMap(colours.map, colours.isReversed);
    if (colours.field == field_)
        return;
    field_ = colours.field;
    if (fieldTexture_ != 0)
        gl_.glDeleteTextures(1, &fieldTexture_); // its memory first
    fieldTexture_ = 0;
    isRefused_ = false;
    if (field_)
        uploadField();
}

void ColourUniforms::uploadMap(model::ColourMap map, bool isReversed) {
    map_ = {map, isReversed};
    const auto colours = model::coloursOf(map, isReversed, kMapColours);
    if (mapTexture_ == 0)
        gl_.glGenTextures(1, &mapTexture_);
    gl_.glActiveTexture(GL_TEXTURE0 + kColourMapUnit);
    gl_.glBindTexture(GL_TEXTURE_2D, mapTexture_);
    for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
        gl_.glTexParameteri(GL_TEXTURE_2D, filter, GL_LINEAR);
    for (const GLenum wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
        gl_.glTexParameteri(GL_TEXTURE_2D, wrap, GL_CLAMP_TO_EDGE);
    gl_.glTexImage2D(GL_TEXTURE_2D, 0, GL_RGB16F, kMapColours, 1, 0, GL_RGB, GL_FLOAT, colours.data());
    gl_.glBindTexture(GL_TEXTURE_2D, 0);
    gl_.glActiveTexture(GL_TEXTURE0);
}

void ColourUniforms::uploadField() {
    gl_.glGenTextures(1, &fieldTexture_);
    gl_.glActiveTexture(GL_TEXTURE0 + kScalarFieldUnit);
    gl_.glBindTexture(GL_TEXTURE_3D, fieldTexture_);
    for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
        gl_.glTexParameteri(GL_TEXTURE_3D, filter, GL_LINEAR);
    for (const GLenum wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R})
        gl_.glTexParameteri(GL_TEXTURE_3D, wrap, GL_CLAMP_TO_EDGE);
    forgetErrors(gl_);
    gl_.glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
    gl_.glTexImage3D(GL_TEXTURE_3D, 0, GL_R32F, static_cast<GLsizei>(field_->dims[0]),
                     static_cast<GLsizei>(field_->dims[1]), static_cast<GLsizei>(field_->dims[2]), 0, GL_RED, GL_FLOAT,
                     field_->texels.data());
    isRefused_ = gl_.glGetError() != GL_NO_ERROR;
    gl_.glBindTexture(GL_TEXTURE_3D, 0);
    gl_.glActiveTexture(GL_TEXTURE0);
}

void ColourUniforms::set(QOpenGLShaderProgram& program, const model::SurfaceColours& colours, const GridGeometry& grid,
                         const GridGeometry& volume) {
    ShaderKind kind = kPlain;
    glm::dmat4 rows(1.0);
    const double width = colours.range.high - colours.range.low;
    glm::dvec2 scale(1.0 / width, -colours.range.low / width);
    switch (colours.by) {
        case ColourBy::One: break;
        case ColourBy::X:
        case ColourBy::Y:
        case ColourBy::Z: { // places on the map already: an origin far away must not cost digits
            const int axis = static_cast<int>(colours.by) - static_cast<int>(ColourBy::X);
            const glm::dmat4 toWorld = grid.indexToWorld();
            for (int column = 0; column < 4; ++column)
                rows[column][0] = (toWorld[column][axis] - (column == 3 ? colours.range.low : 0.0)) / width;
            scale = {1.0, 0.0};
            kind = kLinear;
            break;
        }
        case ColourBy::Middle: {
            const glm::dvec3 last(volume.dims[0] - 1, volume.dims[1] - 1, volume.dims[2] - 1);
            rows = grid.indexToWorld();
            rows[3] = glm::dvec4((grid.origin - volume.origin) - glm::dmat3(volume.indexToWorld()) * (0.5 * last), 1.0);
            kind = kDistance;
            break;
        }
        case ColourBy::Gradient:
        case ColourBy::Field:
            if (!field_ || isRefused_)
                break;
            rows = toTexture(*field_) * glm::inverse(volume.indexToWorld()) * grid.indexToWorld();
            scale = {(field_->max - field_->min) / width, (field_->min - colours.range.low) / width};
            kind = kField;
            break;
    }
    const std::array<QVector4D, 3> lines{row(rows, 0), row(rows, 1), row(rows, 2)};
    program.setUniformValue("scalarKind", static_cast<int>(kind));
    program.setUniformValueArray("scalarRows", lines.data(), static_cast<int>(lines.size()));
    program.setUniformValue("scalarScale", QVector2D(static_cast<float>(scale.x), static_cast<float>(scale.y)));
    gl_.glActiveTexture(GL_TEXTURE0 + kScalarFieldUnit);
    gl_.glBindTexture(GL_TEXTURE_3D, kind == kField ? fieldTexture_ : 0);
    gl_.glActiveTexture(GL_TEXTURE0 + kColourMapUnit);
    gl_.glBindTexture(GL_TEXTURE_2D, kind == kPlain ? 0 : mapTexture_);
    gl_.glActiveTexture(GL_TEXTURE0);
}

} // namespace isoslider::render
