#pragma once

#include <QImage>

#include <glm/vec2.hpp>

#include "ui/render/gl_program.h"

namespace isoslider::render {

/// A finished picture. Contexts that share with the one it was made in can read its texture.
struct PictureTexture {
    GLuint name = 0;
    glm::ivec2 pixels{0};
};

/// Where a picture is drawn to off screen: samples that are averaged into a texture. REQUIRES for every call, the
/// destructor included: the context it was made in is current.
class PictureTarget {
public:
    /// With so many samples a pixel where the driver has them.
    PictureTarget(Gl& gl, int samples);
    ~PictureTarget();
    PictureTarget(const PictureTarget&) = delete;
    PictureTarget& operator=(const PictureTarget&) = delete;

    /// Forgets everything on the GPU without a call to it, and makes no other: the context is gone.
    void abandon() { drawn_ = 0; }
    /// Binds it as the framebuffer to draw to. False if there is no memory for it, or it is larger than the card draws.
    bool bind(glm::ivec2 pixels);
    /// Brings what was drawn into the texture, which becomes as large, and is made first where its name is 0.
    void resolve(PictureTexture& texture);
    /// What is in the texture, stretched to so many pixels, upper row first.
    QImage read(const PictureTexture& texture, glm::ivec2 pixels);

private:
    bool allocate(glm::ivec2 pixels);
    void allocate(PictureTexture& texture, glm::ivec2 pixels);

    Gl& gl_;
    int samples_;
    glm::ivec2 most_{0}; ///< pixels
    glm::ivec2 pixels_{0};
    GLuint colour_ = 0, depth_ = 0; ///< renderbuffers
    GLuint drawn_ = 0, resolved_ = 0; ///< framebuffers
    PictureTexture stretched_;
    GLuint stretchedTo_ = 0; ///< framebuffer
};

} // namespace isoslider::render
