#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include <QMatrix4x4>

#include <glm/vec3.hpp>

#include "core/grid/grid_geometry.h"
#include "ui/model/slices/slice_model.h"
#include "ui/render/gl_driver.h"
#include "ui/render/line_program.h"
#include "ui/render/slice_scene.h"

namespace isoslider::render {

/// Where the plane of a slice leaves the volume's box: the corners of a convex polygon, in order. None if it misses.
std::vector<glm::vec3> borderOf(const extract::SlicePlane& plane, const GridDims& dims);

/// Slices as textures on planes, with their borders and contours. Made, drawn and destroyed with one context current;
/// nothing is on the card before the first slice is.
class SlicePlanes {
public:
    SlicePlanes(Gl& gl, GlDriver& driver);
    ~SlicePlanes();
    SlicePlanes(const SlicePlanes&) = delete;
    SlicePlanes& operator=(const SlicePlanes&) = delete;

    /// Forgets everything on the GPU without a call to it: the context is gone.
    void abandon();
    void draw(const SliceScene& scene, const GridDims& dims, const LineView& view, LineProgram& lines);

private:
    struct Plane {
        std::shared_ptr<const model::SliceShades> shades; ///< these two were sent to the card last
        std::shared_ptr<const model::SliceContour> contour;
        std::shared_ptr<const model::SliceShades> inTexture; ///< null: none
        GLuint texture = 0;
        GLuint array = 0;
        GLuint buffer = 0;
        bool isRefused = false; ///< the card has no memory for it
        int borderPoints = 0;
    };

    bool initialize();
    void resize(std::size_t count);
    void free(Plane& plane);
    void upload(const SliceInScene& slice, const GridDims& dims, Plane& plane);
    void uploadTexture(Plane& plane);
    bool fill(Plane& plane, const std::vector<float>& data);
    void uploadCrosshair(const SliceScene& scene, const GridDims& dims);
    void drawCrosshair(const SliceScene& scene, QOpenGLShaderProgram& program);
    void drawLines(const SliceScene& scene, const LineView& view, LineProgram& lines);

    Gl& gl_;
    GlDriver& driver_;
    bool isReady_ = false, isBroken_ = false;
    std::unique_ptr<QOpenGLShaderProgram> planeProgram_;
    std::vector<Plane> planes_;
    Plane lines_; ///< of the crosshair
    std::optional<glm::dvec3> crosshair_; ///< that is on the card
};

} // namespace isoslider::render
