#include "ui/model/surface/clipping.h"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

namespace isoslider::model {
namespace {

glm::dvec3 lastPoint(const GridGeometry& geometry) {
    return glm::dvec3(geometry.dims[0], geometry.dims[1], geometry.dims[2]) - 1.0;
}

/// Equal origins cancel before anything is rounded, however far away they are.
glm::dvec3 offsetOf(const GridGeometry& grid, const GridGeometry& volume) {
    return (grid.origin - volume.origin) - glm::dmat3(volume.indexToWorld()) * (0.5 * lastPoint(volume));
}

/// The volume's index along an axis, as a function of an index in `grid`: dot(xyz, place) + w.
glm::dvec4 indexAlong(int axis, const GridGeometry& grid, const GridGeometry& volume) {
    glm::dvec4 along(0.0);
    if (grid.direction == volume.direction && grid.origin == volume.origin) { // exact, for places on a face
        along[axis] = grid.spacing[axis] / volume.spacing[axis];
        return along;
    }
    const glm::dmat3 toVolume = glm::inverse(glm::dmat3(volume.indexToWorld()));
    const glm::dmat3 turn = toVolume * glm::dmat3(grid.indexToWorld());
    for (int column = 0; column < 3; ++column)
        along[column] = turn[column][axis];
    along.w = (toVolume * (grid.origin - volume.origin))[axis];
    return along;
}

glm::dvec3 unitOr(const glm::dvec3& direction, const glm::dvec3& other) {
    const double length = glm::length(direction);
    return std::isfinite(length) && length > 0.0 ? direction / length : other;
}

} // namespace

CropBox wholeBox(const GridDims& dims) { return {{0, 0, 0}, {dims[0] - 1, dims[1] - 1, dims[2] - 1}}; }

CropBox cropWithin(const std::optional<CropBox>& crop, const GridDims& dims) {
    CropBox box = crop.value_or(wholeBox(dims));
    for (std::size_t a = 0; a < 3; ++a) {
        const std::int64_t last = std::max<std::int64_t>(1, dims[a] - 1);
        box.low[a] = std::clamp<std::int64_t>(box.low[a], 0, last - 1);
        box.high[a] = std::clamp<std::int64_t>(box.high[a], box.low[a] + 1, last);
    }
    return box;
}

CropBox withFace(CropBox box, int axis, bool isHigh, double at, const GridDims& dims) {
    const auto a = static_cast<std::size_t>(axis);
    const std::int64_t last = std::max<std::int64_t>(1, dims[a] - 1);
    if (!std::isfinite(at))
        return box;
    const auto point = static_cast<std::int64_t>(std::clamp(std::round(at), 0.0, static_cast<double>(last)));
    if (isHigh)
        box.high[a] = std::max(point, box.low[a] + 1);
    else
        box.low[a] = std::min(point, box.high[a] - 1);
    return box;
}

std::vector<glm::dvec4> cutsOf(const Clipping& clipping, const GridGeometry& grid, const GridGeometry& volume) {
    std::vector<glm::dvec4> cuts;
    if (clipping.isCropped) {
        const CropBox box = cropWithin(clipping.crop, volume.dims);
        for (int axis = 0; axis < 3; ++axis) {
            const auto a = static_cast<std::size_t>(axis);
            const glm::dvec4 along = indexAlong(axis, grid, volume);
            cuts.push_back(along - glm::dvec4(0.0, 0.0, 0.0, static_cast<double>(box.low[a])));
            cuts.push_back(glm::dvec4(0.0, 0.0, 0.0, static_cast<double>(box.high[a])) - along);
        }
    }
    for (const ClipPlane& plane : clipping.planes) {
        if (!plane.isOn)
            continue;
        const glm::dmat3 toWorld(grid.indexToWorld());
        cuts.emplace_back(-(glm::transpose(toWorld) * plane.normal),
                          plane.offset - glm::dot(plane.normal, offsetOf(grid, volume)));
    }
    return cuts;
}

bool isWithin(std::span<const glm::dvec4> cuts, const glm::dvec3& place) {
    return std::all_of(cuts.begin(), cuts.end(),
                       [&](const glm::dvec4& cut) { return glm::dot(glm::dvec3(cut), place) + cut.w >= 0.0; });
}

std::optional<std::pair<glm::dvec3, glm::dvec3>> partWithin(std::span<const glm::dvec4> cuts, glm::dvec3 from,
                                                            glm::dvec3 to) {
    for (const glm::dvec4& cut : cuts) {
        const auto side = [&](const glm::dvec3& place) { return glm::dot(glm::dvec3(cut), place) + cut.w; };
        const double first = side(from), last = side(to);
        if (!(first >= 0.0 || last >= 0.0))
            return std::nullopt;
        if (first < 0.0)
            from += (to - from) * (first / (first - last));
        else if (last < 0.0)
            to = from + (to - from) * (first / (first - last));
    }
    return std::pair(from, to);
}

glm::dvec3 centredWorldOf(const glm::dvec3& place, const GridGeometry& grid, const GridGeometry& volume) {
    return glm::dmat3(grid.indexToWorld()) * place + offsetOf(grid, volume);
}

glm::dvec3 indexOfCentred(const glm::dvec3& place, const GridGeometry& grid, const GridGeometry& volume) {
    return glm::inverse(glm::dmat3(grid.indexToWorld())) * (place - offsetOf(grid, volume));
}

double reachAlong(const glm::dvec3& direction, const GridGeometry& volume) {
    const glm::dmat3 toWorld(volume.indexToWorld());
    double reach = 0.0;
    for (int axis = 0; axis < 3; ++axis)
        reach += 0.5 * lastPoint(volume)[axis] * std::abs(glm::dot(toWorld[axis], direction));
    return reach;
}

ClipPlane planeWithin(ClipPlane plane, const GridGeometry& volume) {
    if (!(std::abs(glm::length(plane.normal) - 1.0) < 1e-12)) // not again and again: equal planes must stay equal
        plane.normal = unitOr(plane.normal, {1.0, 0.0, 0.0});
    const double reach = reachAlong(plane.normal, volume);
    plane.offset = std::isfinite(plane.offset) ? std::clamp(plane.offset, -reach, reach) : 0.0;
    return plane;
}

ClipPlane turnedTo(ClipPlane plane, const glm::dvec3& normal, const glm::dvec3& about) {
    plane.normal = unitOr(normal, plane.normal);
    plane.offset = glm::dot(plane.normal, about);
    return plane;
}

ClipPlane flipped(ClipPlane plane) {
    plane.normal = -plane.normal;
    plane.offset = -plane.offset;
    return plane;
}

} // namespace isoslider::model
