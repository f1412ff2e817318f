#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "ui/render/gl_driver.h"
#include "ui/render/gl_program.h"
#include "ui/render/line_program.h"
#include "ui/render/scene_view.h"

namespace isoslider::render {

/// Colours of what is in the scene, linear light. Those of what it stands in: see StageColours.
struct SceneColours {
    glm::vec3 front{0.80f, 0.70f, 0.54f}; ///< warm ivory
    glm::vec3 back{0.26f, 0.33f, 0.42f}; ///< slate: the side of higher values
    /// Of merged cells, by their level.
    std::array<glm::vec3, 4> levels{
        {{0.80f, 0.70f, 0.54f}, {0.13f, 0.42f, 0.85f}, {0.10f, 0.58f, 0.32f}, {0.82f, 0.26f, 0.50f}}};
    glm::vec4 highlight{1.0f, 0.035f, 0.02f, 0.86f};
    glm::vec3 spot{0.0f, 0.55f, 0.80f}; ///< cyan: apart from the red and from all levels
    glm::vec3 marker{0.25f, 0.90f, 1.0f}; ///< as seen
    glm::vec4 edges{0.012f, 0.02f, 0.035f, 0.8f};
};

/// World units; half the diagonal of the volume's box. 1 for a volume without extent.
double sceneRadius(const GridGeometry& geometry);
/// Index units of `grid` to world space moved so that the centre of `volume`, which it is of, is the origin.
glm::dmat4 indexToCentredWorld(const GridGeometry& grid, const GridGeometry& volume);

/// Draws background, bounding box, surface, the changed part of it and a spot into the bound framebuffer.
/// Made in initialize() and gone in release(); every call but the constructor needs the same context current.
class SceneRenderer {
public:
    /// Coarse: of a large surface, fewer triangles, and no marks of what changed.
    enum class Detail { Whole, Coarse };

    explicit SceneRenderer(std::shared_ptr<GlDriver> driver = std::make_shared<GlDriver>());
    ~SceneRenderer();

    /// False if the context has no OpenGL 3.3 core or a shader is refused: nothing will be drawn.
    bool initialize();
    /// Frees every GPU object; initialize() may follow in another context.
    void release();
    /// Forgets every GPU object without a call to OpenGL: for a context that is gone or cannot be made current.
    void abandon();

    /// A surface is uploaded once, at the first draw of it. `isStopped` is asked between parts of the surface: false if
    /// it answered true, and the picture is not whole.
    bool draw(const SceneView& view, Detail detail, const std::function<bool()>& isStopped = {});

    /// Bytes of the present surface, or of another one, if the card has no memory for it and it is not drawn; 0
    /// otherwise.
    std::uint64_t refusedBytes() const;
    /// Bytes of surfaces sent to the card since initialize().
    std::uint64_t uploadedBytes() const;

private:
    struct Resources;
    struct Matrices;
    struct OnCard;

    void setFrame(const SceneView& view);
    void drawBackground(const SceneView& view);
    void drawBox(const Matrices& matrices, const SceneView& view);
    void drawBoxLines(LineProgram& lines, const Matrices& matrices, const SceneView& view);
    void drawClipGuides(const Matrices& ofVolume, const SceneView& view);
    void drawMarker(const Spot& spot, const glm::dvec4& place, glm::ivec2 pixels);
    Matrices matricesOf(const GridGeometry& grid, const SceneView& view) const;
    /// All visible surfaces that the card has memory for, sent to it; the active one last.
    std::vector<OnCard> surfacesOf(const SceneView& view, Detail detail);
    void useProgram(QOpenGLShaderProgram& program, const OnCard& surface, const SceneView& view);
    void endProgram(QOpenGLShaderProgram& program);
    bool drawOpaque(const OnCard& surface, const SceneView& view, const std::function<bool()>& isStopped);
    /// What is drawn on the active surface.
    bool drawMarks(QOpenGLShaderProgram& program, const OnCard& surface, const SceneView& view,
                   const std::function<bool()>& isStopped);
    bool isAnyTransparent(const std::vector<OnCard>& surfaces) const;
    bool drawTransparent(const std::vector<OnCard>& surfaces, const Matrices& ofVolume, const SceneView& view,
                         Detail detail, const std::function<bool()>& isStopped);

    void uploadBox();

    std::shared_ptr<GlDriver> driver_; // before the resources, which use it to the last
    std::unique_ptr<Resources> resources_;
    std::shared_ptr<const extract::SurfaceFrame> frame_;
    GridGeometry volume_;
    SceneColours colours_;
    bool isBoxNew_ = false;
};

} // namespace isoslider::render
