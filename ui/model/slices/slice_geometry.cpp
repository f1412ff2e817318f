#include "ui/model/slices/slice_geometry.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "ui/model/surface/axis_names.h"

namespace isoslider::model {
namespace {

constexpr double kOutsideWindow = 0.005; // share of the samples, at each end

double lastOf(const GridGeometry& geometry, int axis) {
    return static_cast<double>(geometry.dims[static_cast<std::size_t>(axis)] - 1);
}

glm::dvec3 lastPoint(const GridGeometry& geometry) {
    return {lastOf(geometry, 0), lastOf(geometry, 1), lastOf(geometry, 2)};
}

glm::dmat3 indexToWorldAxes(const GridGeometry& geometry) { return glm::dmat3(geometry.indexToWorld()); }

double smallestSpacing(const GridGeometry& geometry) {
    return std::min({geometry.spacing.x, geometry.spacing.y, geometry.spacing.z});
}

extract::SlicePlane axisPlane(int axis, const glm::dvec3& position, const GridGeometry& geometry, std::int64_t step) {
    const SliceAxes axes = sliceAxes(geometry, axis);
    const double longest = std::max(lastOf(geometry, axes.right), lastOf(geometry, axes.down)) + 1.0;
    const double known = static_cast<double>(std::max<std::int64_t>(1, step));
    const double stride = known * std::max(1.0, std::ceil(longest / known / kMostSliceSide));
    extract::SlicePlane plane{glm::dvec3(0.0), glm::dvec3(0.0), glm::dvec3(0.0), 0, 0};
    const auto lay = [&](int along, bool isBackwards, glm::dvec3& way) {
        const double pixels = std::floor(lastOf(geometry, along) / stride);
        way[along] = isBackwards ? -stride : stride;
        plane.origin[along] = isBackwards ? pixels * stride : 0.0;
        return static_cast<int>(pixels) + 1;
    };
    plane.width = lay(axes.right, axes.isRightBackwards, plane.right);
    plane.height = lay(axes.down, axes.isDownBackwards, plane.down);
    plane.origin[axis] = position[axis];
    return plane;
}

extract::SlicePlane obliquePlane(const SliceOptions& options, const GridGeometry& geometry, std::int64_t step) {
    const glm::dmat3 toWorld = indexToWorldAxes(geometry), toIndex = glm::inverse(toWorld);
    const glm::dvec3 right = options.orientation * glm::dvec3(1.0, 0.0, 0.0);
    const glm::dvec3 down = options.orientation * glm::dvec3(0.0, -1.0, 0.0);
    glm::dvec2 low(std::numeric_limits<double>::infinity()), high(-low);
    for (int corner = 0; corner < 8; ++corner) {
        const glm::dvec3 at = toWorld * (lastPoint(geometry) * glm::dvec3(corner & 1, corner >> 1 & 1, corner >> 2));
        const glm::dvec2 seen(glm::dot(at, right), glm::dot(at, down));
        low = glm::min(low, seen);
        high = glm::max(high, seen);
    }
    const glm::dvec2 extent = high - low;
    const double finest = smallestSpacing(geometry) * static_cast<double>(std::max<std::int64_t>(1, step));
    const double pixel = std::max(finest, std::max(extent.x, extent.y) / (kMostObliqueSide - 1));
    const glm::dvec3 position = toWorld * options.position;
    const glm::dvec3 origin =
        position + right * (low.x - glm::dot(position, right)) + down * (low.y - glm::dot(position, down));
    const auto count = [pixel](double length) {
        return std::clamp(static_cast<int>(std::floor(length / pixel)) + 1, 1, kMostObliqueSide);
    };
    return {toIndex * origin, toIndex * (right * pixel), toIndex * (down * pixel), count(extent.x), count(extent.y)};
}

} // namespace

int gridAxisOf(SliceKind kind, const GridGeometry& geometry) {
    return AxisNames(geometry).gridAxisOf(worldAxisOf(kind));
}

SliceAxes sliceAxes(const GridGeometry& geometry, int axis) {
    const AxisNames names(geometry);
    const int across = names.worldAxisOf(axis);
    const int rightOf = across == 0 ? 1 : 0, downOf = across == 2 ? 1 : 2;
    SliceAxes axes{names.gridAxisOf(rightOf), names.gridAxisOf(downOf), false, false};
    axes.isRightBackwards = geometry.direction[axes.right][rightOf] * geometry.spacing[axes.right] < 0.0;
    const bool isDownwards = geometry.direction[axes.down][downOf] * geometry.spacing[axes.down] >= 0.0;
    axes.isDownBackwards = isDownwards != (across == 2);
    return axes;
}

extract::SlicePlane planeOf(SliceKind kind, const SliceOptions& options, const GridGeometry& geometry,
                            std::int64_t step) {
    return kind == SliceKind::Oblique ? obliquePlane(options, geometry, step)
                                      : axisPlane(gridAxisOf(kind, geometry), options.position, geometry, step);
}

glm::dvec2 pixelSize(const extract::SlicePlane& plane, const GridGeometry& geometry) {
    const glm::dmat3 toWorld = indexToWorldAxes(geometry);
    return {glm::length(toWorld * plane.right), glm::length(toWorld * plane.down)};
}

glm::dvec2 pixelOf(const extract::SlicePlane& plane, const glm::dvec3& place, const GridGeometry& geometry) {
    // Axes of a grid may be oblique to each other, so both are solved for at once.
    const glm::dmat3 toWorld = indexToWorldAxes(geometry);
    const glm::dvec3 right = toWorld * plane.right, down = toWorld * plane.down,
                     away = toWorld * (place - plane.origin);
    const glm::dmat2 gram(glm::dot(right, right), glm::dot(right, down), glm::dot(right, down), glm::dot(down, down));
    return glm::inverse(gram) * glm::dvec2(glm::dot(right, away), glm::dot(down, away));
}

extract::CutPlane cutPlaneOf(const extract::SlicePlane& plane, const GridGeometry& volume, const GridGeometry& frame) {
    // A preview's grid begins at the volume's first point and has its axes: only the steps are longer.
    const glm::dvec3 step = frame.spacing / volume.spacing;
    const glm::dvec3 normal = glm::normalize(plane.normal()) * step;
    return {normal, glm::dot(normal, plane.origin / step)};
}

glm::dvec3 clampedPlace(const glm::dvec3& place, const GridGeometry& geometry) {
    return glm::clamp(place, glm::dvec3(0.0), glm::max(lastPoint(geometry), glm::dvec3(0.0)));
}

glm::dvec3 snappedPlace(const glm::dvec3& place, const GridGeometry& geometry) {
    return clampedPlace(glm::round(place), geometry);
}

glm::dvec3 steppedPlace(SliceKind kind, double steps, const SliceOptions& options, const GridGeometry& geometry) {
    glm::dvec3 place = options.position;
    if (kind != SliceKind::Oblique) {
        const int axis = gridAxisOf(kind, geometry);
        place[axis] = std::round(place[axis] + steps);
        return clampedPlace(place, geometry);
    }
    const glm::dvec3 normal = options.orientation * glm::dvec3(0.0, 0.0, 1.0);
    const glm::dvec3 way = glm::inverse(indexToWorldAxes(geometry)) * (normal * smallestSpacing(geometry) * steps);
    double share = 1.0; // as far as the volume goes: a clamped place would have left the way
    for (int axis = 0; axis < 3; ++axis)
        if (way[axis] != 0.0) {
            const double end = way[axis] > 0.0 ? lastOf(geometry, axis) : 0.0;
            share = std::min(share, std::max(0.0, (end - place[axis]) / way[axis]));
        }
    return clampedPlace(place + share * way, geometry);
}

SliceLabels sliceLabels(SliceKind kind, const SliceOptions& options, const GridGeometry& geometry, bool isPatient) {
    if (kind == SliceKind::Oblique && !isPatient)
        return {};
    const auto letterOf = [](const glm::dvec3& way) {
        static constexpr std::array<const char*, 3> kTowards{"L", "P", "S"}, kAgainst{"R", "A", "I"};
        std::size_t axis = 0;
        for (std::size_t a = 1; a < 3; ++a)
            if (std::abs(way[static_cast<int>(a)]) > std::abs(way[static_cast<int>(axis)]))
                axis = a;
        return std::string(way[static_cast<int>(axis)] >= 0.0 ? kTowards[axis] : kAgainst[axis]);
    };
    if (isPatient) {
        const extract::SlicePlane plane = planeOf(kind, options, geometry);
        const glm::dmat3 toWorld = indexToWorldAxes(geometry);
        const glm::dvec3 right = toWorld * plane.right, down = toWorld * plane.down;
        return {letterOf(-right), letterOf(right), letterOf(-down), letterOf(down)};
    }
    const SliceAxes axes = sliceAxes(geometry, gridAxisOf(kind, geometry));
    const AxisNames names(geometry);
    // Axes of the world grow to the right, and downwards in slices across z only, whatever those of the grid do.
    const bool areOfWorld = names.areOfWorld();
    const bool isToLeft = !areOfWorld && axes.isRightBackwards;
    const bool isUpwards = areOfWorld ? kind != SliceKind::Z : axes.isDownBackwards;
    SliceLabels labels;
    (isToLeft ? labels.left : labels.right) = names.nameOf(axes.right);
    (isUpwards ? labels.top : labels.bottom) = names.nameOf(axes.down);
    return labels;
}

ValueWindow automaticWindow(const ValueDistribution& values) {
    const auto all = static_cast<double>(values.counted()); // a sum over all cells
    const double outside = kOutsideWindow * all;
    ValueWindow window{values.min, values.max};
    double counted = 0.0;
    for (const ValueCell& cell : values.cells) {
        const double before = counted;
        counted += static_cast<double>(cell.count);
        if (before <= outside && counted > outside)
            window.low = cell.lower;
        if (all - before > outside)
            window.high = cell.upper;
    }
    // One value may be nearly all there is.
    if (!(window.high > window.low))
        window = {values.min, values.max};
    if (!(window.high > window.low))
        window = {values.min - 0.5, values.min + 0.5};
    return window;
}

} // namespace isoslider::model
