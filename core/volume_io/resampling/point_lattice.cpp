#include "core/volume_io/resampling/point_lattice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "core/volume_io/resampling/rectilinear_resampler.h"

namespace isoslider::io {
namespace {

double farthestOf(std::span<const glm::dvec3> points) {
    double farthest = 0.0;
    for (const glm::dvec3& p : points)
        farthest = std::max({farthest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    return farthest;
}

} // namespace

double latticeTolerance(double step, double farthest) {
    constexpr double kMost = 0.01; // of a step, however coarse the coordinates
    const double rounding = farthest * static_cast<double>(std::numeric_limits<float>::epsilon());
    return std::max(kEvenTolerance * step, std::min(kMost * step, rounding));
}

std::optional<GridGeometry> latticeOf(std::span<const glm::dvec3> points, const GridDims& dims) {
    if (std::min({dims[0], dims[1], dims[2]}) < 2 || points.size() != static_cast<std::size_t>(pointCount(dims)))
        return std::nullopt;
    const std::array<std::int64_t, 3> strides{1, dims[0], dims[0] * dims[1]};
    GridGeometry geometry;
    geometry.dims = dims;
    geometry.origin = points[0];
    std::array<glm::dvec3, 3> steps;
    double least = std::numeric_limits<double>::infinity();
    for (int axis = 0; axis < 3; ++axis) {
        const auto i = static_cast<std::size_t>(axis);
        const auto last = static_cast<std::size_t>(strides[i] * (dims[i] - 1));
        steps[i] = (points[last] - points[0]) / static_cast<double>(dims[i] - 1);
        const double length = glm::length(steps[i]);
        if (!std::isfinite(length) || !(length > 0.0))
            return std::nullopt;
        geometry.spacing[axis] = length;
        geometry.direction[axis] = steps[i] / length + 0.0; // no negative zeros
        least = std::min(least, length);
    }
    const double tolerance = latticeTolerance(least, farthestOf(points));
    const double longest = static_cast<double>(std::max({dims[0], dims[1], dims[2]}) - 1);
    for (int axis = 0; axis < 3; ++axis) // a shear may not move the far side by more than a point may be off
        if (std::abs(glm::dot(geometry.direction[axis], geometry.direction[(axis + 1) % 3])) * longest *
                std::max({geometry.spacing.x, geometry.spacing.y, geometry.spacing.z}) >
            tolerance)
            return std::nullopt;
    std::size_t at = 0;
    for (std::int64_t k = 0; k < dims[2]; ++k)
        for (std::int64_t j = 0; j < dims[1]; ++j)
            for (std::int64_t i = 0; i < dims[0]; ++i, ++at) {
                const glm::dvec3 place = geometry.origin + static_cast<double>(i) * steps[0] +
                                         static_cast<double>(j) * steps[1] + static_cast<double>(k) * steps[2];
                const glm::dvec3 off = glm::abs(points[at] - place);
                if (!(std::max({off.x, off.y, off.z}) <= tolerance))
                    return std::nullopt;
            }
    return geometry;
}

} // namespace isoslider::io
