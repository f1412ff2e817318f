#include "ui/model/surface/box_ticks.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <glm/geometric.hpp>

#include "ui/model/isovalue/value_steps.h"
#include "ui/model/surface/axis_names.h"

namespace isoslider::model {
namespace {

constexpr double kTickPixels = 70.0; // at least, from tick to tick
constexpr double kLeastEdge = 40.0; // pixels
constexpr double kOnEdge = 1e-9; // of the span of values

using Corners = std::array<glm::dvec2, 8>; ///< pixels, y upwards; bit a of a number: the far end along axis a

glm::dvec3 cornerOf(int corner, const GridDims& dims) {
    glm::dvec3 place(0.0);
    for (int axis = 0; axis < 3; ++axis)
        if ((corner >> axis & 1) != 0)
            place[axis] = static_cast<double>(dims[static_cast<std::size_t>(axis)] - 1);
    return place;
}

std::optional<Corners> cornersOnScreen(const GridGeometry& volume, const glm::dmat4& toScreen,
                                       const glm::dvec2& pixels) {
    Corners corners;
    for (int corner = 0; corner < 8; ++corner) {
        const glm::dvec4 clip = toScreen * glm::dvec4(cornerOf(corner, volume.dims), 1.0);
        if (!(clip.w > 0.0))
            return std::nullopt;
        corners[static_cast<std::size_t>(corner)] = 0.5 * pixels * glm::dvec2(clip.x / clip.w, clip.y / clip.w);
    }
    return corners;
}

/// Whether all other corners lie on one side of the line through an edge.
bool isOutline(const Corners& corners, std::size_t from, std::size_t to) {
    const glm::dvec2 along = corners[to] - corners[from];
    bool isLeft = false, isRight = false;
    for (std::size_t corner = 0; corner < corners.size(); ++corner) {
        const glm::dvec2 away = corners[corner] - corners[from];
        const double side = along.x * away.y - along.y * away.x;
        const double exact = 1e-9 * glm::dot(along, along);
        isLeft = isLeft || side > exact;
        isRight = isRight || side < -exact;
    }
    return !(isLeft && isRight);
}

std::optional<std::pair<std::size_t, std::size_t>> edgeToTick(const Corners& corners, int axis) {
    std::optional<std::pair<std::size_t, std::size_t>> best;
    double least = 0.0;
    for (std::size_t from = 0; from < corners.size(); ++from) {
        const std::size_t to = from | std::size_t{1} << axis;
        if (to == from || !isOutline(corners, from, to))
            continue;
        const glm::dvec2 along = corners[to] - corners[from], middle = 0.5 * (corners[to] + corners[from]);
        const double place = std::abs(along.y) > std::abs(along.x) ? middle.x : middle.y;
        if (glm::length(along) >= kLeastEdge && (!best || place < least)) {
            least = place;
            best = {from, to};
        }
    }
    return best;
}

/// From the first point of the edge to its last.
struct Values {
    double first = 0.0, last = 0.0;
};

Values valuesAlong(const GridGeometry& volume, int axis, TickedEdge& edge) {
    const glm::dvec3 direction = volume.direction[axis];
    const double length = volume.spacing[axis] * static_cast<double>(volume.dims[static_cast<std::size_t>(axis)] - 1);
    if (const auto world = worldAxisAlong(direction)) {
        edge.axis = *world;
        const double first = volume.origin[*world];
        return {first, first + std::copysign(length, direction[*world])};
    }
    edge.axis = axis;
    edge.isOfWorld = false;
    return {0.0, length};
}

void addTicks(TickedEdge& edge, const Values& values, double pixels) {
    const double span = std::abs(values.last - values.first);
    if (!(span > 0.0) || !std::isfinite(span))
        return;
    double step = roundStep(span * kTickPixels / pixels);
    while (pixels * step / span < kTickPixels) // it is rounded down
        step = roundStep(step * 2.5);
    const double low = std::min(values.first, values.last), high = std::max(values.first, values.last);
    if (!(high - low > step * 1e-9) || !(std::abs(low) < step * 1e15)) // its digits do not tell ticks apart
        return;
    for (double count = std::ceil(low / step - kOnEdge); count * step <= high + kOnEdge * span; ++count) {
        const double value = nearestMultiple(count * step, step);
        const double share = (value - values.first) / (values.last - values.first);
        edge.ticks.push_back({value, edge.from + (edge.to - edge.from) * std::clamp(share, 0.0, 1.0)});
    }
}

} // namespace

std::vector<TickedEdge> tickedEdges(const GridGeometry& volume, const glm::dmat4& toScreen, const glm::dvec2& pixels) {
    std::vector<TickedEdge> edges;
    const auto corners = cornersOnScreen(volume, toScreen, pixels);
    if (!corners)
        return edges;
    for (int axis = 0; axis < 3; ++axis) {
        const auto ends = edgeToTick(*corners, axis);
        if (!ends)
            continue;
        TickedEdge edge;
        edge.from = cornerOf(static_cast<int>(ends->first), volume.dims);
        edge.to = cornerOf(static_cast<int>(ends->second), volume.dims);
        const Values values = valuesAlong(volume, axis, edge);
        addTicks(edge, values, glm::length((*corners)[ends->second] - (*corners)[ends->first]));
        edges.push_back(std::move(edge));
    }
    return edges;
}

} // namespace isoslider::model
