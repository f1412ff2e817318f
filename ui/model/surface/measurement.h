#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <glm/vec3.hpp>

namespace isoslider::model {

/// Places between which lengths are measured, in the order in which they were picked: two have a length between them,
/// three have two lengths and the angle where they meet. World units about the volume's centre.
using MeasuredPlaces = std::vector<glm::dvec3>;
inline constexpr std::size_t kMostMeasuredPlaces = 3;

/// With one more; after three it begins again with this one. The last one picked again changes nothing.
MeasuredPlaces withPlace(MeasuredPlaces places, const glm::dvec3& place);
/// At the second of three places, 0 to 180 degrees. None with fewer, or where one lies on the second.
std::optional<double> measuredAngle(const MeasuredPlaces& places);

} // namespace isoslider::model
