#include "ui/render/picture_target.h"

#include <algorithm>
#include <array>
#include <utility>

#include <glm/common.hpp>

#include "ui/render/gl_driver.h"

namespace isoslider::render {

PictureTarget::PictureTarget(Gl& gl, int samples) : gl_(gl) {
    GLint most = 0;
    gl_.glGetIntegerv(GL_MAX_SAMPLES, &most);
    samples_ = std::clamp(samples, 0, static_cast<int>(most));
    GLint side = 0, textureSide = 0;
    gl_.glGetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &side);
    gl_.glGetIntegerv(GL_MAX_TEXTURE_SIZE, &textureSide);
    std::array<GLint, 2> viewport{};
    gl_.glGetIntegerv(GL_MAX_VIEWPORT_DIMS, viewport.data());
    most_ = glm::min(glm::ivec2(viewport[0], viewport[1]), glm::ivec2(std::min(side, textureSide)));
    gl_.glGenRenderbuffers(1, &colour_);
    gl_.glGenRenderbuffers(1, &depth_);
    gl_.glGenFramebuffers(1, &drawn_);
    gl_.glGenFramebuffers(1, &resolved_);
    gl_.glGenFramebuffers(1, &stretchedTo_);
}

PictureTarget::~PictureTarget() {
    if (drawn_ == 0)
        return;
    gl_.glDeleteFramebuffers(1, &stretchedTo_);
    gl_.glDeleteTextures(1, &stretched_.name);
    gl_.glDeleteFramebuffers(1, &resolved_);
    gl_.glDeleteFramebuffers(1, &drawn_);
    gl_.glDeleteRenderbuffers(1, &depth_);
    gl_.glDeleteRenderbuffers(1, &colour_);
}

bool PictureTarget::bind(glm::ivec2 pixels) {
    const bool isTooLarge = pixels.x > most_.x || pixels.y > most_.y;
    if (isTooLarge || (pixels != pixels_ && !allocate(pixels))) {
        pixels_ = glm::ivec2(0);
        return false;
    }
    gl_.glBindFramebuffer(GL_FRAMEBUFFER, drawn_);
    return true;
}

bool PictureTarget::allocate(glm::ivec2 pixels) {
    forgetErrors(gl_);
    gl_.glBindFramebuffer(GL_FRAMEBUFFER, drawn_);
    const auto attach = [&](GLuint buffer, GLenum format, GLenum place) {
        gl_.glBindRenderbuffer(GL_RENDERBUFFER, buffer);
        gl_.glRenderbufferStorageMultisample(GL_RENDERBUFFER, samples_, format, pixels.x, pixels.y);
        gl_.glFramebufferRenderbuffer(GL_FRAMEBUFFER, place, GL_RENDERBUFFER, buffer);
    };
    attach(colour_, GL_RGBA8, GL_COLOR_ATTACHMENT0);
    attach(depth_, GL_DEPTH_COMPONENT24, GL_DEPTH_ATTACHMENT);
    gl_.glBindRenderbuffer(GL_RENDERBUFFER, 0);
    pixels_ = pixels;
    return gl_.glGetError() == GL_NO_ERROR && gl_.glCheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
}

void PictureTarget::allocate(PictureTexture& texture, glm::ivec2 pixels) {
    if (texture.name == 0)
        gl_.glGenTextures(1, &texture.name);
    if (texture.pixels == pixels)
        return;
    texture.pixels = pixels;
    gl_.glBindTexture(GL_TEXTURE_2D, texture.name);
    gl_.glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, pixels.x, pixels.y, 0, GL_RGBA, GL_UNSIGNED_BYTE, nullptr);
    gl_.glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR); // there are no smaller images of it
    gl_.glBindTexture(GL_TEXTURE_2D, 0);
}

void PictureTarget::resolve(PictureTexture& texture) {
    allocate(texture, pixels_);
    gl_.glBindFramebuffer(GL_READ_FRAMEBUFFER, drawn_);
    gl_.glBindFramebuffer(GL_DRAW_FRAMEBUFFER, resolved_);
    gl_.glFramebufferTexture2D(GL_DRAW_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, texture.name, 0);
    gl_.glBlitFramebuffer(0, 0, pixels_.x, pixels_.y, 0, 0, pixels_.x, pixels_.y, GL_COLOR_BUFFER_BIT, GL_NEAREST);
    gl_.glBindFramebuffer(GL_FRAMEBUFFER, drawn_);
}

QImage PictureTarget::read(const PictureTexture& texture, glm::ivec2 pixels) {
    gl_.glBindFramebuffer(GL_READ_FRAMEBUFFER, resolved_);
    if (pixels != texture.pixels) {
        allocate(stretched_, pixels);
        gl_.glBindFramebuffer(GL_DRAW_FRAMEBUFFER, stretchedTo_);
        gl_.glFramebufferTexture2D(GL_DRAW_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, stretched_.name, 0);
        gl_.glBlitFramebuffer(0, 0, texture.pixels.x, texture.pixels.y, 0, 0, pixels.x, pixels.y, GL_COLOR_BUFFER_BIT,
                              GL_LINEAR);
        gl_.glBindFramebuffer(GL_READ_FRAMEBUFFER, stretchedTo_);
    }
    QImage image(pixels.x, pixels.y, QImage::Format_RGB32);
    if (!image.isNull())
        gl_.glReadPixels(0, 0, pixels.x, pixels.y, GL_BGRA, GL_UNSIGNED_INT_8_8_8_8_REV, image.bits());
    gl_.glBindFramebuffer(GL_FRAMEBUFFER, drawn_);
    return std::move(image).mirrored();
}

} // namespace isoslider::render
