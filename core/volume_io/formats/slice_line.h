#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

namespace isoslider::io {

/// The lower of the two in the middle of an even number. REQUIRES: not empty.
double lowerMedian(std::vector<double> values);

/// The place farthest off the line that most places lie on, or their number if all are within `tolerance` of one. x and
/// y are across the slices, z is along them, ascending from the first place at 0. Slices may be unevenly spaced, and
/// any of them, the first and the last too, may be the one that is off.
std::size_t findOffLine(std::span<const glm::dvec3> places, double tolerance);

} // namespace isoslider::io
