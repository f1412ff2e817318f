#pragma once

#include <array>
#include <memory>

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>

#include "ui/model/surface/camera.h"
#include "ui/render/depth_copy.h"
#include "ui/render/gl_program.h"

namespace isoslider::render {

/// Darkens hollows, gaps and what lies close behind something, as if light came from all sides: what is seen of a
/// surface then tells its relief, which lamps alone do not.
///
/// Works on the depths of a finished picture, so its cost follows the pixels, not the triangles. At half the
/// resolution, the places around each pixel that stand above its tangent plane count the more the closer they are
/// (obscurance after McGuire, Osman, Bukowski and Hennessy, "The Alchemy Screen-Space Ambient Obscurance Algorithm",
/// 2011), in a pattern that repeats every 4 pixels; two passes over 4 pixels each take the pattern away, and none of
/// them mixes what lies at different distances. What is not in the picture darkens nothing. REQUIRES for every call but
/// abandon() and the destructor after it: the context it was made in is current.
class AmbientOcclusion {
public:
    explicit AmbientOcclusion(Gl& gl) : gl_(gl), depths_(gl) {}
    ~AmbientOcclusion();
    AmbientOcclusion(const AmbientOcclusion&) = delete;
    AmbientOcclusion& operator=(const AmbientOcclusion&) = delete;

    /// Forgets everything on the GPU without a call to it: the context is gone.
    void abandon();
    /// Darkens what has been drawn into the bound framebuffer, whose depths have 24 bits, as `camera` sees it. Things
    /// darken what is around them as far as kReach of half the view's height. Without memory, or a driver that has what
    /// it takes, nothing changes.
    void draw(glm::ivec2 pixels, const model::Camera& camera);

    static constexpr double kReach = 0.12;

private:
    struct Target {
        GLuint framebuffer = 0, texture = 0;
    };

    bool prepare(glm::ivec2 half);
    bool allocate(Target& target, GLenum format);
    void free(Target& target);
    void fill(const Target* target, QOpenGLShaderProgram& program, std::array<GLuint, 3> textures);
    void takePictures(glm::ivec2 pixels, glm::ivec2 half, const glm::dmat4& viewToClip, double radius);

    Gl& gl_;
    DepthCopy depths_;
    bool isBroken_ = false;
    glm::ivec2 room_{0}; ///< pixels of the targets
    Target distances_, open_, smoothed_; ///< of half the pixels along each side
    GLuint emptyArray_ = 0, picture_ = 0;
    std::unique_ptr<QOpenGLShaderProgram> distance_, occlusion_, smoothing_, darkening_;
};

} // namespace isoslider::render
