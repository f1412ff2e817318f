#pragma once

#include <array>
#include <memory>
#include <optional>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "core/extract/surface_frame.h"
#include "ui/model/surface/camera.h"
#include "ui/model/surface/view_state.h"
#include "ui/render/gl_driver.h"

namespace isoslider::render {

/// Colours of the scene, linear light but for the background, which is as seen.
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
    glm::vec4 box{0.78f, 0.82f, 0.88f, 0.38f};
    glm::vec3 backgroundBottom{0.085f, 0.092f, 0.105f};
    glm::vec3 backgroundTop{0.225f, 0.240f, 0.265f};
};

/// A place that is pointed out: a ring on it that is seen through the surface, and the surface around it highlighted.
struct Spot {
    glm::dvec3 place{0.0}; ///< grid index units of the volume
    float strength = 1.0f; ///< 0 to 1: how much both cover what is below
    float pixelRatio = 1.0f; ///< of the screen

    bool operator==(const Spot&) const = default;
};

/// World units; half the diagonal of the volume's box. 1 for a volume without extent.
double sceneRadius(const GridGeometry& geometry);
/// Index units of `grid` to world space moved so that the centre of `volume`, which it is of, is the origin.
glm::dmat4 indexToCentredWorld(const GridGeometry& grid, const GridGeometry& volume);

/// Draws background, bounding box, surface, the changed part of it and a spot into the bound framebuffer.
/// Made in initialize() and gone in release(); every call but the constructor, setFrame and setSpot needs
/// the same context current.
class SceneRenderer {
public:
    explicit SceneRenderer(std::shared_ptr<GlDriver> driver = std::make_shared<GlDriver>());
    ~SceneRenderer();

    /// False if the context has no OpenGL 3.3 core or a shader is refused: nothing will be drawn.
    bool initialize();
    /// Frees every GPU object; initialize() may follow in another context.
    void release();
    /// Forgets every GPU object without a call to OpenGL: for a context that is gone or cannot be made current.
    void abandon();

    /// The surface to draw from now on; null for none. Uploaded at the next draw, once. `volume` is what its
    /// grid is of, if that is larger: a preview does not reach all the ends. Its box is drawn, its centre is
    /// the origin.
    void setFrame(std::shared_ptr<const extract::SurfaceFrame> frame, const std::optional<GridGeometry>& volume = {});

    void setSpot(const std::optional<Spot>& spot) { spot_ = spot; }

    void draw(const model::Camera& camera, const model::ViewOptions& options, glm::ivec2 pixels);

    /// Bytes of the present surface, if the card has no memory for it and it is not drawn; 0 otherwise.
    std::uint64_t refusedBytes() const { return refusedBytes_; }
    /// Bytes of surfaces sent to the card since initialize().
    std::uint64_t uploadedBytes() const;

private:
    struct Resources;
    struct Matrices;

    void uploadIfNew();
    void drawBackground();
    void drawBox(const Matrices& matrices);
    void drawMarker(const glm::dvec4& place, glm::ivec2 pixels);
    void drawSurface(const Matrices& matrices, bool isPerspective, const model::ViewOptions& options);

    bool uploadSurface();
    void uploadBox();
    bool hasFewChanges() const;

    std::shared_ptr<GlDriver> driver_; // before the resources, which use it to the last
    std::unique_ptr<Resources> resources_;
    std::shared_ptr<const extract::SurfaceFrame> frame_;
    GridGeometry volume_;
    std::optional<Spot> spot_;
    SceneColours colours_;
    bool isFrameNew_ = false;
    std::uint64_t refusedBytes_ = 0;
};

} // namespace isoslider::render
