#pragma once

#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "core/grid/grid_geometry.h"

namespace isoslider::model {

enum class StandardView { Front, Back, Right, Left, Top, Bottom };

/// From camera axes to world axes.
glm::dquat standardOrientation(StandardView view);

/// What of a camera is worth keeping. In world units about the volume's centre.
struct CameraPose {
    glm::dquat orientation{1.0, 0.0, 0.0, 0.0}; ///< camera axes to world axes
    glm::dvec3 target{0.0};
    double distance = 1.0; ///< from the target to the eye
    bool isPerspective = true;
    glm::dvec3 pivot{0.0}; ///< what orbit() turns about

    bool operator==(const CameraPose&) const = default;
};

/// How far a corner of a grid of these dimensions lies from the origin of the space that `fromIndex` leads to.
double reachOf(const GridDims& dims, const glm::dmat4& fromIndex);

/// On the way from one pose to another, `part` from 0 to 1; the distance changes by equal factors in equal parts.
/// REQUIRES: both are poses of cameras.
CameraPose poseBetween(const CameraPose& from, const CameraPose& to, double part);

/// Where the viewer stands. World space is centred: the volume's centre is (0, 0, 0), its bounding
/// sphere has sceneRadius(). Screen positions are in [-1, 1], y up, x scaled like y by the caller's
/// aspect (width / height). Everything is in double; the renderer rounds the product.
/// What is shown may be stretched: target, eye and directions are of the space that is shown, and viewMatrix() leads
/// from the world into it.
class Camera {
public:
    /// Shows a scene of this radius whole: a patient from the front, head up, anything else from above and the side.
    void reset(double sceneRadius, bool isPatient = false);
    /// Whole scene, direction kept; turns about its middle from now on.
    void fit();
    /// World space is shown through this map, with a bounding sphere of that radius. What was in the middle stays
    /// there. REQUIRES: it can be inverted.
    void setStretch(const glm::dmat3& toShown, double sceneRadius);
    void setStandardView(StandardView view);
    /// Draws what lies within this distance of the centre as well, in the space that is shown; less than the scene's
    /// radius changes nothing.
    void setReach(double reach) { reach_ = reach; }
    double reach() const { return reach_; }

    /// Turns about the pivot: the volume's centre, or what a pose was made around; radians to the right and upwards, as
    /// the pointer moves.
    void orbit(double rightRadians, double upRadians);
    /// Moves the scene with the pointer: a screen step of (dx, dy) moves the target plane by it.
    void pan(glm::dvec2 screenStep, double aspect);
    /// Comes closer by `factor` > 1; what lies under `screen` on the target plane stays there.
    void zoom(double factor, glm::dvec2 screen, double aspect);
    void setPerspective(bool isPerspective) { isPerspective_ = isPerspective; }

    /// A ball shown whole from the present direction, in a view of any aspect, with its middle as the pivot.
    CameraPose poseAround(glm::dvec3 middle, double radius, double aspect) const;

    CameraPose pose() const { return {orientation_, target_, distance_, isPerspective_, pivot_}; }
    /// False, and nothing is changed, if a number is not finite, the orientation is null or the distance is not
    /// positive. Comes no closer and goes no farther than zoom().
    bool setPose(const CameraPose& pose);

    bool isPerspective() const { return isPerspective_; }
    double sceneRadius() const { return sceneRadius_; }
    double distance() const { return distance_; }
    glm::dvec3 target() const { return target_; }
    glm::dvec3 right() const;
    glm::dvec3 up() const;
    /// From the target towards the viewer.
    glm::dvec3 backward() const;
    glm::dvec3 eye() const { return target_ + backward() * distance_; }
    glm::dquat orientation() const { return orientation_; }

    const glm::dmat3& stretch() const { return stretch_; }
    /// Unit normal, in world space, of the planes that face the viewer.
    glm::dvec3 facingNormal() const;

    glm::dmat4 viewMatrix() const;
    /// Normals of the world into view space, not of unit length.
    glm::dmat3 normalMatrix() const;
    /// Finite for any aspect: of what is none, as of a view without height, it is that of a square.
    glm::dmat4 projectionMatrix(double aspect) const;
    /// World units from the centre to the top of the view, on the target plane.
    double halfHeight() const;

private:
    double sceneRadius_ = 1.0;
    double reach_ = 0.0;
    double distance_ = 3.0;
    glm::dvec3 target_{0.0}, pivot_{0.0};
    glm::dquat orientation_{1.0, 0.0, 0.0, 0.0}; ///< camera axes to world axes
    glm::dmat3 stretch_{1.0}; ///< from the world to what is shown
    bool isPerspective_ = true;
};

} // namespace isoslider::model
