#pragma once

#include <array>
#include <optional>
#include <string>

#include <glm/vec3.hpp>

#include "core/grid/grid_geometry.h"

namespace isoslider::model {

/// The world axis that a unit vector runs along, forwards or backwards; none if along no axis.
std::optional<int> worldAxisAlong(const glm::dvec3& direction);

/// What the axes of a volume's grid are called wherever the window names one. A grid whose axes run along those of the
/// world, in any order, forwards or backwards, has their names: X, Y and Z. Axes of any other grid are called i, j and
/// k, in the order of the file, so that none is taken for an axis of the world. O(1).
class AxisNames {
public:
    /// Of a grid with the axes of the world.
    AxisNames() = default;
    explicit AxisNames(const GridGeometry& geometry);

    /// Each axis of the grid runs along one of the world.
    bool areOfWorld() const { return areOfWorld_; }
    /// The same, in the order of the world's axes.
    bool areInOrder() const { return areOfWorld_ && world_ == std::array{0, 1, 2}; }
    /// The world axis that a grid axis comes nearest to; of the three each has another.
    int worldAxisOf(int gridAxis) const { return world_[static_cast<std::size_t>(gridAxis)]; }
    int gridAxisOf(int worldAxis) const;
    /// The grid axis in a list of all three: X, Y, Z or i, j, k.
    int gridAxisInRow(int row) const { return areOfWorld_ ? gridAxisOf(row) : row; }
    std::string nameOf(int gridAxis) const;

private:
    std::array<int, 3> world_{0, 1, 2}; ///< by grid axis
    bool areOfWorld_ = true;
};

/// A coordinate along an axis of the world: "-12.5", or, of a patient (left, posterior, superior), "R 12.5".
std::string coordinateText(int worldAxis, double value, bool isPatient, int digits);
/// "-32, 17, 46"; of a patient "R 32, P 17, S 46".
std::string placeText(const glm::dvec3& world, bool isPatient, int digits);
/// "X"; of a patient "R–L".
std::string worldAxisName(int worldAxis, bool isPatient);

} // namespace isoslider::model
