#include "ui/model/surface/axis_names.h"

#include <algorithm>
#include <cmath>

#include "ui/model/isovalue/number_text.h"

namespace isoslider::model {
namespace {

constexpr double kAlong = 1.0 - 1e-9; // cosine of the angle between an axis of the grid and one of the world

/// The world axis that each axis of the grid comes nearest to, each but once.
std::array<int, 3> nearestWorldAxes(const GridGeometry& geometry) {
    std::array<int, 3> world{-1, -1, -1};
    std::array<bool, 3> isTaken{};
    for (int round = 0; round < 3; ++round) {
        double best = -1.0;
        std::size_t axis = 0, of = 0;
        for (std::size_t a = 0; a < 3; ++a)
            for (std::size_t w = 0; w < 3; ++w) {
                const double along = std::abs(geometry.direction[static_cast<int>(a)][static_cast<int>(w)]);
                if (world[a] < 0 && !isTaken[w] && along > best) {
                    best = along;
                    axis = a;
                    of = w;
                }
            }
        world[axis] = static_cast<int>(of);
        isTaken[of] = true;
    }
    return world;
}

} // namespace

std::optional<int> worldAxisAlong(const glm::dvec3& direction) {
    for (int world = 0; world < 3; ++world)
        if (std::abs(direction[world]) >= kAlong)
            return world;
    return std::nullopt;
}

AxisNames::AxisNames(const GridGeometry& geometry)
    : world_(nearestWorldAxes(geometry)),
      areOfWorld_(worldAxisAlong(geometry.direction[0]) && worldAxisAlong(geometry.direction[1]) &&
                  worldAxisAlong(geometry.direction[2])) {}

int AxisNames::gridAxisOf(int worldAxis) const {
    return static_cast<int>(std::find(world_.begin(), world_.end(), worldAxis) - world_.begin());
}

std::string AxisNames::nameOf(int gridAxis) const {
    return {areOfWorld_ ? "XYZ"[worldAxisOf(gridAxis)] : "ijk"[gridAxis]};
}

std::string coordinateText(int worldAxis, double value, bool isPatient, int digits) {
    if (!isPatient)
        return valueText(value, digits);
    const char letter = (value < 0.0 ? "RAI" : "LPS")[worldAxis];
    return std::string(1, letter) + " " + valueText(std::abs(value), digits);
}

std::string placeText(const glm::dvec3& world, bool isPatient, int digits) {
    std::string text;
    for (int axis = 0; axis < 3; ++axis)
        text += (axis > 0 ? ", " : "") + coordinateText(axis, world[axis], isPatient, digits);
    return text;
}

std::string worldAxisName(int worldAxis, bool isPatient) {
    static constexpr std::array<const char*, 3> kPatientAxes{"R–L", "A–P", "I–S"};
    return isPatient ? std::string(kPatientAxes[static_cast<std::size_t>(worldAxis)])
                     : std::string(1, "XYZ"[worldAxis]);
}

} // namespace isoslider::model
