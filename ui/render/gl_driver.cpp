#include "ui/render/gl_driver.h"

#include <QOpenGLContext>

namespace isoslider::render {
namespace {

constexpr int kMostErrors = 16; // a lost context may report one for ever

/// True if one of the errors so far was because memory is missing.
bool takeOutOfMemory(Gl& gl) {
    bool isOutOfMemory = false;
    for (int i = 0; i < kMostErrors; ++i) {
        const GLenum error = gl.glGetError();
        if (error == GL_NO_ERROR)
            break;
        isOutOfMemory = isOutOfMemory || error == GL_OUT_OF_MEMORY;
    }
    return isOutOfMemory;
}

} // namespace

void forgetErrors(Gl& gl) { takeOutOfMemory(gl); }

GLuint GlDriver::makeBuffer(Gl& gl) {
    GLuint buffer = 0;
    gl.glGenBuffers(1, &buffer);
    return buffer;
}

void GlDriver::freeBuffer(Gl& gl, GLuint buffer) { gl.glDeleteBuffers(1, &buffer); }

bool GlDriver::allocate(Gl& gl, GLenum target, GLuint buffer, std::size_t bytes) {
    forgetErrors(gl);
    gl.glBindBuffer(target, buffer);
    gl.glBufferData(target, static_cast<GLsizeiptr>(bytes), nullptr, GL_STREAM_DRAW);
    return !takeOutOfMemory(gl);
}

bool GlDriver::isLost(QOpenGLContext& context) {
    // Of a context that is not current nothing can be asked; one without a surface yet is not lost.
    if (!context.isValid() || QOpenGLContext::currentContext() != &context)
        return !context.isValid();
    using ResetStatus = GLenum(QOPENGLF_APIENTRYP)();
    for (const auto& [extension, function] : {std::pair{"GL_KHR_robustness", "glGetGraphicsResetStatus"},
                                              std::pair{"GL_ARB_robustness", "glGetGraphicsResetStatusARB"}}) {
        if (!context.hasExtension(extension))
            continue;
        if (const auto status = reinterpret_cast<ResetStatus>(context.getProcAddress(function)))
            return status() != GL_NO_ERROR;
    }
    return false;
}

} // namespace isoslider::render
