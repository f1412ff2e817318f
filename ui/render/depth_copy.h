#pragma once

#include <glm/vec2.hpp>

#include "ui/render/gl_program.h"

namespace isoslider::render {

/// The depths of a picture as a texture: those of a multisampled one can be read in no other way.
/// REQUIRES for every call but abandon() and the destructor after it: the context it was made in is current.
class DepthCopy {
public:
    explicit DepthCopy(Gl& gl) : gl_(gl) {}
    ~DepthCopy();
    DepthCopy(const DepthCopy&) = delete;
    DepthCopy& operator=(const DepthCopy&) = delete;

    /// Forgets everything on the GPU without a call to it: the context is gone.
    void abandon() { framebuffer_ = texture_ = 0; }
    /// Copies the lower left part of `picture`, a framebuffer, whose depths have 24 bits. False without memory for it,
    /// or a driver that has such textures. Leaves another framebuffer bound.
    bool copy(GLuint picture, glm::ivec2 pixels);
    /// Larger than the last copy where that was not the largest.
    GLuint texture() const { return texture_; }

private:
    bool allocate(glm::ivec2 room, GLenum format);
    void free();

    Gl& gl_;
    bool isBroken_ = false;
    glm::ivec2 room_{0}; ///< pixels of the texture
    GLenum format_ = 0;
    GLuint framebuffer_ = 0, texture_ = 0; ///< 0: there is none
};

} // namespace isoslider::render
