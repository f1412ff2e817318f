#pragma once

#include <memory>
#include <optional>
#include <utility>

#include "core/grid/grid_geometry.h"
#include "ui/model/colouring/surface_colours.h"
#include "ui/render/gl_program.h"

namespace isoslider::render {

/// What programs with shaders/scalar_colour.glsl need: the textures of a field and of a map, and where a place lies in
/// them. Made, used and destroyed with one context current; nothing is on the card before the first is wanted.
class ColourUniforms {
public:
    explicit ColourUniforms(Gl& gl) : gl_(gl) {}
    ~ColourUniforms();
    ColourUniforms(const ColourUniforms&) = delete;
    ColourUniforms& operator=(const ColourUniforms&) = delete;

    /// Forgets everything on the GPU without a call to it: the context is gone.
    void abandon();
    /// Sends what is new to the card. A field that it has no memory for is not shown: surfaces have their plain colour.
    void upload(const model::SurfaceColours& colours);
    /// Of the bound program, for places in index units of `grid`, which is of `volume`.
    void set(QOpenGLShaderProgram& program, const model::SurfaceColours& colours, const GridGeometry& grid,
             const GridGeometry& volume);

private:
    void uploadMap(model::ColourMap map, bool isReversed);
    void uploadField();

    Gl& gl_;
    GLuint mapTexture_ = 0, fieldTexture_ = 0;
    std::optional<std::pair<model::ColourMap, bool>> map_; ///< on the card
    std::shared_ptr<const model::ColourField> field_; ///< the last that was sent
    bool isRefused_ = false; ///< the card has no memory for it
};

} // namespace isoslider::render
