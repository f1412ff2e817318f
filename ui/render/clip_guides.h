#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <QMatrix4x4>

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "core/grid/grid_geometry.h"
#include "ui/model/slices/cap_samples.h"
#include "ui/model/slices/slice_options.h"
#include "ui/model/surface/camera.h"
#include "ui/model/surface/clipping.h"
#include "ui/render/colour_uniforms.h"
#include "ui/render/gl_driver.h"
#include "ui/render/line_program.h"

namespace isoslider::render {

/// What closes the surface on a clip plane.
struct CapScene {
    std::shared_ptr<const model::CapSamples> samples; ///< null: nothing
    model::ValueWindow window; ///< of its greys

    bool operator==(const CapScene&) const = default;
};

/// By place of the plane.
using CapScenes = std::array<CapScene, model::kClipPlanes>;

/// The clipping of a picture: that of the options, on the planes whose samples there are.
model::Clipping drawnClipping(const model::Clipping& wanted, const CapScenes& caps);

/// Has the bound program draw only what lies within `cuts`, until the next call. REQUIRES: at most kMostCuts.
void setCuts(Gl& gl, QOpenGLShaderProgram& program, std::span<const glm::dvec4> cuts);
/// No more clipping, whatever is drawn.
void clearCuts(Gl& gl);

/// Crop box and clip planes in the scene: the edges of the box, the borders of the planes, and their caps. Made, drawn
/// and destroyed with one context current; nothing is on the card before the first is drawn.
class ClipGuides {
public:
    /// A surface that caps close.
    struct Fill {
        float isovalue = 0.0f;
        std::optional<glm::vec3> colour; ///< linear light; none: that of the first of all colours
    };
    struct View {
        LineView seen; ///< its model: the volume's index units
        LineProgram& lines;
        const GridGeometry& volume;
        std::span<const Fill> fills; ///< ascending by isovalue: what lies within another one is drawn over it
        const model::Camera& camera;
        ColourUniforms& uniforms;
        const model::SurfaceColours& colours; ///< of the caps too, where there are any
    };
    ClipGuides(Gl& gl, GlDriver& driver);
    ~ClipGuides();
    ClipGuides(const ClipGuides&) = delete;
    ClipGuides& operator=(const ClipGuides&) = delete;

    /// Forgets everything on the GPU without a call to it: the context is gone.
    void abandon();
    void draw(const model::Clipping& clipping, const CapScenes& caps, const View& view);

private:
    bool initialize();
    bool fill(const std::vector<float>& data);
    void drawCap(const model::Clipping& clipping, std::size_t place, const CapScene& cap, const View& view);
    void drawLines(const model::Clipping& clipping, const View& view);
    bool uploadCap(GLuint texture, const model::CapSamples& samples);

    Gl& gl_;
    GlDriver& driver_;
    bool isReady_ = false, isBroken_ = false;
    std::unique_ptr<QOpenGLShaderProgram> capProgram_;
    GLuint array_ = 0, buffer_ = 0;
    struct Texture {
        GLuint name = 0;
        std::shared_ptr<const model::CapSamples> content; ///< sent to the card last
        bool isRefused = false; ///< the card has no memory for it
    };
    std::array<Texture, model::kClipPlanes> textures_; ///< of the caps
};

} // namespace isoslider::render
