#include "core/volume_io/formats/slice_line.h"

#include <algorithm>

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

namespace isoslider::io {
namespace {

struct Line {
    glm::dvec2 start{0.0}, slope{0.0};
    double distanceOf(const glm::dvec3& place) const {
        return glm::length(glm::dvec2(place) - start - slope * place.z);
    }
};

Line medianLine(std::span<const glm::dvec3> places) {
    Line line;
    for (int axis = 0; axis < 2; ++axis) {
        std::vector<double> slopes, starts;
        for (std::size_t i = 1; i < places.size(); ++i)
            slopes.push_back((places[i][axis] - places[i - 1][axis]) / (places[i].z - places[i - 1].z));
        line.slope[axis] = lowerMedian(std::move(slopes));
        for (const glm::dvec3& place : places)
            starts.push_back(place[axis] - line.slope[axis] * place.z);
        line.start[axis] = lowerMedian(std::move(starts));
    }
    return line;
}

std::size_t farthestFrom(const Line& line, std::span<const glm::dvec3> places, double tolerance) {
    const auto farthest = std::max_element(places.begin(), places.end(), [&](const glm::dvec3& a, const glm::dvec3& b) {
        return line.distanceOf(a) < line.distanceOf(b);
    });
    return line.distanceOf(*farthest) > tolerance ? static_cast<std::size_t>(farthest - places.begin()) : places.size();
}

} // namespace

double lowerMedian(std::vector<double> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

std::size_t findOffLine(std::span<const glm::dvec3> places, double tolerance) {
    // Positions are rounded in files: over a long distance the ends give the direction of the line best. Only if some
    // place is off that line, it is asked which: then the ends themselves are in doubt.
    const Line ofEnds{glm::dvec2(places.front()),
                      glm::dvec2(places.back() - places.front()) / (places.back().z - places.front().z)};
    if (farthestFrom(ofEnds, places, tolerance) == places.size())
        return places.size();
    return farthestFrom(medianLine(places), places, tolerance);
}

} // namespace isoslider::io
