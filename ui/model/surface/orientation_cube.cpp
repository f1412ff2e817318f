#include "ui/model/surface/orientation_cube.h"

#include <cmath>

namespace isoslider::model {
namespace {

constexpr double kLeastFacing = 1e-3; // of a side seen from its edge nothing can be hit

} // namespace

int axisOf(StandardView side) {
    switch (side) {
        case StandardView::Right:
        case StandardView::Left: return 0;
        case StandardView::Front:
        case StandardView::Back: return 1;
        case StandardView::Top:
        case StandardView::Bottom: break;
    }
    return 2;
}

std::string sideName(StandardView side, bool isPatient) {
    const auto axis = static_cast<std::size_t>(axisOf(side));
    const bool isPositive = side == StandardView::Right || side == StandardView::Back || side == StandardView::Top;
    if (isPatient)
        return std::string(1, (isPositive ? "LPS" : "RAI")[axis]);
    return (isPositive ? "+" : "−") + std::string(1, "XYZ"[axis]);
}

std::vector<CubeSide> visibleSides(const glm::dquat& cameraToWorld) {
    const glm::dquat worldToCamera = glm::conjugate(cameraToWorld);
    std::vector<CubeSide> sides;
    for (const StandardView side : kStandardViews) {
        const glm::dquat straight = worldToCamera * standardOrientation(side);
        const glm::dvec3 outwards = straight * glm::dvec3(0.0, 0.0, 1.0);
        if (outwards.z > kLeastFacing)
            sides.push_back({side, outwards.z, glm::dvec2(outwards), glm::dvec2(straight * glm::dvec3(1.0, 0.0, 0.0)),
                             glm::dvec2(straight * glm::dvec3(0.0, 1.0, 0.0))});
    }
    return sides;
}

std::optional<StandardView> sideAt(const glm::dquat& cameraToWorld, glm::dvec2 place) {
    for (const CubeSide& side : visibleSides(cameraToWorld)) {
        const glm::dvec2 away = place - side.middle;
        const double area = side.right.x * side.up.y - side.right.y * side.up.x; // its `facing`: not 0
        const double along = (away.x * side.up.y - away.y * side.up.x) / area;
        const double upwards = (side.right.x * away.y - side.right.y * away.x) / area;
        if (std::abs(along) <= 1.0 && std::abs(upwards) <= 1.0)
            return side.side;
    }
    return std::nullopt;
}

} // namespace isoslider::model
