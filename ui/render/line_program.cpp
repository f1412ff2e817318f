#include "ui/render/line_program.h"

#include <utility>

#include "ui/render/gl_program.h"

namespace isoslider::render {
namespace {

constexpr float kLeastWide = 1.25f; // pixels; nearly one is one

} // namespace

bool LineProgram::initialize() {
    thin_ = loadProgram("line", "line", define_);
    return isReady();
}

QOpenGLShaderProgram& LineProgram::bind(const LineView& view) {
    const bool wantsWide = view.width >= kLeastWide;
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

} // namespace isoslider::render
