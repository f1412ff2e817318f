#pragma once

#include <glm/gtc/quaternion.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace isoslider::model {

enum class StandardView { Front, Back, Right, Left, Top, Bottom };

/// What of a camera is worth keeping. In world units about the volume's centre.
struct CameraPose {
    glm::dquat orientation{1.0, 0.0, 0.0, 0.0}; ///< camera axes to world axes
    glm::dvec3 target{0.0};
    double distance = 1.0; ///< from the target to the eye
    bool isPerspective = true;
};

/// On the way from one pose to another, `part` from 0 to 1; the distance changes by equal factors in equal parts.
/// REQUIRES: both are poses of cameras.
CameraPose poseBetween(const CameraPose& from, const CameraPose& to, double part);

/// Where the viewer stands. World space is centred: the volume's centre is (0, 0, 0), its bounding
/// sphere has sceneRadius(). Screen positions are in [-1, 1], y up, x scaled like y by the caller's
/// aspect (width / height). Everything is in double; the renderer rounds the product.
class Camera {
public:
    /// Shows a scene of this radius whole, from the default direction.
    void reset(double sceneRadius);
    /// Whole scene, direction kept.
    void fit();
    void setStandardView(StandardView view);

    /// Turns about the volume's centre; radians to the right and upwards, as the pointer moves.
    void orbit(double rightRadians, double upRadians);
    /// Moves the scene with the pointer: a screen step of (dx, dy) moves the target plane by it.
    void pan(glm::dvec2 screenStep, double aspect);
    /// Comes closer by `factor` > 1; what lies under `screen` on the target plane stays there.
    void zoom(double factor, glm::dvec2 screen, double aspect);
    void setPerspective(bool isPerspective) { isPerspective_ = isPerspective; }

    CameraPose pose() const { return {orientation_, target_, distance_, isPerspective_}; }
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

    glm::dmat4 viewMatrix() const;
    /// Finite for any aspect: of what is none, as of a view without height, it is that of a square.
    glm::dmat4 projectionMatrix(double aspect) const;
    /// World units from the centre to the top of the view, on the target plane.
    double halfHeight() const;

private:
    double sceneRadius_ = 1.0;
    double distance_ = 3.0;
    glm::dvec3 target_{0.0};
    glm::dquat orientation_{1.0, 0.0, 0.0, 0.0}; ///< camera axes to world axes
    bool isPerspective_ = true;
};

} // namespace isoslider::model
