#include "ui/render/line_program.h"

#include <utility>

#include "ui/render/gl_program.h"

namespace isoslider::render {

bool LineProgram::initialize() {
    thin_ = loadProgram("line", "line", define_);
    return isReady();
}

QOpenGLShaderProgram& LineProgram::bind(const LineView& view) {
    const bool wantsWide = isWideLine(view.width);
    if (wantsWide && !std::exchange(isWideTried_, true))
        wide_ = loadProgram("line", "line", define_, "line");
    const bool isWide = wantsWide && wide_ != nullptr;
    QOpenGLShaderProgram& program = isWide ? *wide_ : *thin_;
    program.bind();
    program.setUniformValue("modelToView", view.modelToView);
    program.setUniformValue("viewToClip", view.viewToClip);
    if (isWide) {
        program.setUniformValue("viewportPixels", static_cast<float>(view.pixels.x), static_cast<float>(view.pixels.y));
        program.setUniformValue("lineWidth", view.width);
    }
    return program;
}

QOpenGLShaderProgram* WideEdgesProgram::get() {
    if (!std::exchange(isTried_, true))
        program_ = loadProgram(vertex_, "surface", "WIDE_EDGES", "edges");
    return program_.get();
}

} // namespace isoslider::render
