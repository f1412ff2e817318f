#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include <glm/gtc/quaternion.hpp>
#include <glm/vec2.hpp>

#include "ui/model/surface/camera.h"

namespace isoslider::model {

// A cube along the world's axes shows where the viewer stands. A side of it is named by the standard view that shows
// this side straight on.

inline constexpr std::array<StandardView, 6> kStandardViews{StandardView::Front, StandardView::Back,
                                                            StandardView::Right, StandardView::Left,
                                                            StandardView::Top,   StandardView::Bottom};

/// The world axis across a side: 0, 1 or 2.
int axisOf(StandardView side);
/// "+X" or "−X" by the axis and the way it points there; a patient's direction (R, L, A, P, I, S) where the world is
/// one's.
std::string sideName(StandardView side, bool isPatient);

/// A side that can be seen, in parallel projection. Places on the screen: (0, 0) is the cube's middle, 1 half its edge;
/// y up.
struct CubeSide {
    StandardView side = StandardView::Front;
    double facing = 1.0; ///< cosine of the angle between its normal and the line of sight; 1: seen straight on
    glm::dvec2 middle{0.0};
    glm::dvec2 right{1.0, 0.0}, up{0.0, 1.0}; ///< from the middle to two edges; words on the side run along `right`
};

/// One to three, none behind another.
std::vector<CubeSide> visibleSides(const glm::dquat& cameraToWorld);
/// The side that is seen at a place on the screen.
std::optional<StandardView> sideAt(const glm::dquat& cameraToWorld, glm::dvec2 place);

} // namespace isoslider::model
