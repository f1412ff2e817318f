#include "ui/render/depth_copy.h"

#include <glm/common.hpp>

namespace isoslider::render {
namespace {

/// The format of its depths, which a copy of them must have.
GLenum depthFormatOf(Gl& gl) {
    GLint kind = GL_NONE;
    gl.glGetFramebufferAttachmentParameteriv(GL_READ_FRAMEBUFFER, GL_STENCIL_ATTACHMENT,
                                             GL_FRAMEBUFFER_ATTACHMENT_OBJECT_TYPE, &kind);
    return kind == GL_NONE ? GL_DEPTH_COMPONENT24 : GL_DEPTH24_STENCIL8;
}

} // namespace

DepthCopy::~DepthCopy() {
    if (framebuffer_ != 0)
        free();
}

void DepthCopy::free() {
    gl_.glDeleteFramebuffers(1, &framebuffer_);
    gl_.glDeleteTextures(1, &texture_);
    framebuffer_ = texture_ = 0;
}

bool DepthCopy::allocate(glm::ivec2 room, GLenum format) {
    free();
    room_ = room;
    format_ = format;
    gl_.glGenFramebuffers(1, &framebuffer_);
    gl_.glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
    gl_.glGenTextures(1, &texture_);
    gl_.glBindTexture(GL_TEXTURE_2D, texture_);
    const bool hasStencil = format == GL_DEPTH24_STENCIL8;
    gl_.glTexImage2D(GL_TEXTURE_2D, 0, static_cast<GLint>(format), room.x, room.y, 0,
                     hasStencil ? GL_DEPTH_STENCIL : GL_DEPTH_COMPONENT, hasStencil ? GL_UNSIGNED_INT_24_8 : GL_FLOAT,
                     nullptr);
    gl_.glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    gl_.glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    gl_.glFramebufferTexture2D(GL_FRAMEBUFFER, hasStencil ? GL_DEPTH_STENCIL_ATTACHMENT : GL_DEPTH_ATTACHMENT,
                               GL_TEXTURE_2D, texture_, 0);
    gl_.glBindTexture(GL_TEXTURE_2D, 0);
    const GLenum none = GL_NONE;
    gl_.glDrawBuffers(1, &none);
    gl_.glReadBuffer(GL_NONE);
    return gl_.glCheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
}

bool DepthCopy::copy(GLuint picture, glm::ivec2 pixels) {
    gl_.glBindFramebuffer(GL_READ_FRAMEBUFFER, picture);
    const GLenum format = depthFormatOf(gl_);
    // Drafts have fewer pixels: they are copied to a part of what there is.
    if (framebuffer_ == 0 || glm::max(room_, pixels) != room_ || format != format_)
        isBroken_ = !allocate(glm::max(room_, pixels), format);
    if (isBroken_)
        return false;
    gl_.glBindFramebuffer(GL_READ_FRAMEBUFFER, picture);
    gl_.glBindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer_);
    gl_.glBlitFramebuffer(0, 0, pixels.x, pixels.y, 0, 0, pixels.x, pixels.y, GL_DEPTH_BUFFER_BIT, GL_NEAREST);
    return true;
}

} // namespace isoslider::render
