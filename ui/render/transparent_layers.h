#pragma once

#include <array>
#include <functional>
#include <memory>

#include <glm/vec2.hpp>

#include "ui/render/depth_copy.h"
#include "ui/render/gl_program.h"

namespace isoslider::render {

/// Transparency that is right from all sides, by depth peeling.
///
/// What is transparent is drawn once for each layer: a fragment counts if it lies behind the layer before and before
/// all that is opaque, and of those the depth test keeps the nearest. Layers are blended front to back. So each pixel
/// is the exact blend of the first so many surfaces along its line of sight, in whatever order bricks, triangles and
/// surfaces are drawn. Weighted blended transparency would take one pass instead of several, but only guesses at the
/// order: a red skin over white bone would look the same as bone over skin. Sorting triangles would not be right where
/// surfaces cross, lists of fragments need more than OpenGL 3.3. A query ends the peeling where nothing is left, and
/// after so many layers that what is behind them counts for less than a grey level, or kMostLayers: what lies behind
/// those is missing. Layers have one sample a pixel: rims of transparent surfaces are not smoothed.
///
/// Blends what is seen, not linear light: opacity then looks as in a drawing program.
/// REQUIRES for every call but abandon() and the destructor after it: the context it was made in is current.
class TransparentLayers {
public:
    static constexpr int kMostLayers = 8, kMostDraftLayers = 3;
    /// Where the programs of what is drawn find the depths of what is opaque, and of the layer before.
    static constexpr int kOpaqueUnit = 1, kPeeledUnit = 2;

    /// After so many of them, what is behind counts for less than a grey level.
    static int layersFor(float leastOpacity, bool isDraft);

    explicit TransparentLayers(Gl& gl) : gl_(gl), opaque_(gl) {}
    ~TransparentLayers();
    TransparentLayers(const TransparentLayers&) = delete;
    TransparentLayers& operator=(const TransparentLayers&) = delete;

    /// Forgets everything on the GPU without a call to it: the context is gone.
    void abandon();
    /// Brings layers over the picture in the bound framebuffer, whose depths have 24 bits. `drawAll` draws all that is
    /// transparent with programs made with "PEELING", once a layer; false if it was stopped. Without memory for the
    /// layers, or a driver that has them, nothing is drawn. False if it was stopped.
    bool draw(glm::ivec2 pixels, int layers, const std::function<bool()>& drawAll);

private:
    struct Target {
        GLuint framebuffer = 0, colour = 0, depth = 0; ///< textures; 0: it has none
    };

    bool prepare(glm::ivec2 pixels);
    bool allocate(Target& target, GLenum colour, GLenum depth);
    void free(Target& target);
    void bind(const Target& target);
    bool drawLayer(const Target& layer, const Target& before, const std::function<bool()>& drawAll);
    void compose(GLuint texture);

    Gl& gl_;
    bool isBroken_ = false;
    glm::ivec2 room_{0}; ///< pixels of the targets
    DepthCopy opaque_;
    Target blended_;
    std::array<Target, 2> layers_; ///< in turn
    GLuint query_ = 0, emptyArray_ = 0;
    std::unique_ptr<QOpenGLShaderProgram> composing_;
};

} // namespace isoslider::render
