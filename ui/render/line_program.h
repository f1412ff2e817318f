#pragma once

#include <memory>

#include <QMatrix4x4>
#include <QOpenGLShaderProgram>

#include <glm/vec2.hpp>

namespace isoslider::render {

/// How lines are seen.
struct LineView {
    const QMatrix4x4& modelToView;
    const QMatrix4x4& viewToClip;
    float width; ///< pixels
    glm::ivec2 pixels; ///< of the picture
};

/// Whether a line of this width, in pixels, wants a rectangle: nearly one is one.
constexpr bool isWideLine(float width) { return width >= 1.25f; }

/// Draws lines of any width. OpenGL without its old functions has those of one pixel only, which in a picture of many
/// pixels nobody sees: wider ones are made rectangles.
class LineProgram {
public:
    /// `define`: as loadProgram() takes it.
    explicit LineProgram(const char* define = nullptr) : define_(define) {}
    /// False if the driver refuses. REQUIRES: a current context, as below.
    bool initialize();
    bool isReady() const { return thin_ != nullptr; }
    /// Binds it, for lines and loops of lines; the colour is to be set. REQUIRES: isReady().
    QOpenGLShaderProgram& bind(const LineView& view);

private:
    const char* define_;
    std::unique_ptr<QOpenGLShaderProgram> thin_;
    std::unique_ptr<QOpenGLShaderProgram> wide_; ///< made when it is first wanted; null if the driver refuses
    bool isWideTried_ = false;
};

/// Draws the edges of triangles as wide as lines: a program as that of the triangles, with `lineWidth` and
/// `viewportPixels` besides.
class WideEdgesProgram {
public:
    /// `vertex`: the shader that makes the vertices.
    explicit WideEdgesProgram(const char* vertex) : vertex_(vertex) {}
    /// Made when it is first wanted; null if the driver refuses. REQUIRES: a current context.
    QOpenGLShaderProgram* get();

private:
    const char* vertex_;
    std::unique_ptr<QOpenGLShaderProgram> program_;
    bool isTried_ = false;
};

} // namespace isoslider::render
