#include "ui/model/surface/measurement.h"

#include <cmath>

#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

namespace isoslider::model {

MeasuredPlaces withPlace(MeasuredPlaces places, const glm::dvec3& place) {
    if (!places.empty() && places.back() == place)
        return places;
    if (places.size() >= kMostMeasuredPlaces)
        places.clear();
    places.push_back(place);
    return places;
}

std::optional<double> measuredAngle(const MeasuredPlaces& places) {
    if (places.size() < kMostMeasuredPlaces)
        return std::nullopt;
    const glm::dvec3 one = places[0] - places[1], other = places[2] - places[1];
    const auto hasDirection = [](const glm::dvec3& v) { return glm::length(v) > 0.0 && std::isfinite(glm::length(v)); };
    if (!hasDirection(one) || !hasDirection(other))
        return std::nullopt;
    const glm::dvec3 a = glm::normalize(one), b = glm::normalize(other);
    // Exact near 0 and 180 degrees, where an arc cosine is not.
    return glm::degrees(std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)));
}

} // namespace isoslider::model
