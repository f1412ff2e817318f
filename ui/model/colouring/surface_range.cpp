#include "ui/model/colouring/surface_range.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "ui/model/surface/clipping.h"
#include "ui/model/surface/surface_vertices.h"

namespace isoslider::model {
namespace {

glm::dvec3 lastPoint(const GridGeometry& volume) {
    return glm::dvec3(volume.dims[0], volume.dims[1], volume.dims[2]) - 1.0;
}

glm::dvec3 worldOf(const GridGeometry& volume, const glm::dvec3& place) {
    return glm::dvec3(volume.indexToWorld() * glm::dvec4(place, 1.0));
}

double interpolated(const ColourField& field, const glm::dvec3& place) {
    double sum = 0.0;
    for (int corner = 0; corner < 8; ++corner) {
        double weight = 1.0;
        std::int64_t at = 0, stride = 1;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const double last = static_cast<double>(field.dims[axis] - 1);
            const double texel = std::clamp((place[static_cast<int>(axis)] / static_cast<double>(field.gridStep) +
                                             0.5) / static_cast<double>(field.step) -
                                                0.5,
                                            0.0, last);
            const double low = std::min(std::floor(texel), std::max(0.0, last - 1.0));
            const bool isUpper = (corner >> axis & 1) != 0;
            weight *= isUpper ? texel - low : 1.0 - (texel - low);
            at += stride * std::min(static_cast<std::int64_t>(low) + (isUpper ? 1 : 0), field.dims[axis] - 1);
            stride *= field.dims[axis];
        }
        if (weight > 0.0)
            sum += weight * static_cast<double>(field.texels[static_cast<std::size_t>(at)]);
    }
    return sum > static_cast<double>(ColourField::kMostTexel) ? std::numeric_limits<double>::quiet_NaN()
                                                              : field.min + sum * (field.max - field.min);
}

} // namespace

double scalarAt(const SurfaceColours& colours, const GridGeometry& volume, const glm::dvec3& place) {
    switch (colours.by) {
        case ColourBy::One: break;
        case ColourBy::Gradient:
        case ColourBy::Field: return interpolated(*colours.field, place);
        case ColourBy::X:
        case ColourBy::Y:
        case ColourBy::Z: return worldOf(volume, place)[static_cast<int>(colours.by) - static_cast<int>(ColourBy::X)];
        case ColourBy::Middle:
            return glm::length(glm::dmat3(volume.indexToWorld()) * (place - 0.5 * lastPoint(volume)));
    }
    return std::numeric_limits<double>::quiet_NaN();
}

ColourRange rangeOfVolume(ColourBy by, const GridGeometry& volume) {
    ColourRange range{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
    for (int corner = 0; corner < 8; ++corner) {
        const glm::dvec3 place = lastPoint(volume) * glm::dvec3(corner & 1, corner >> 1 & 1, corner >> 2);
        const double value = scalarAt({by, nullptr, {}, {}, false}, volume, place);
        range.low = std::min(range.low, value);
        range.high = std::max(range.high, value);
    }
    if (by == ColourBy::Middle)
        range.low = 0.0;
    return usableRange(range);
}

ColourRange usableRange(ColourRange range) {
    if (isUsable(range))
        return range;
    const double middle = std::isfinite(range.low) ? range.low : 0.0;
    const double half = std::max(0.5, std::abs(middle) * 1e-6);
    return {middle - half, middle + half};
}

Result<std::optional<ColourRange>> rangeOnSurface(const extract::SurfaceFrame& frame, const SurfaceColours& colours,
                                                  const GridGeometry& volume, std::span<const glm::dvec4> cuts,
                                                  const JobControl& job) {
    const glm::dmat4 toVolume = glm::inverse(volume.indexToWorld()) * frame.geometry.indexToWorld();
    ColourRange range{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
    const auto add = [&](const glm::dvec3& place) {
        if (!isWithin(cuts, place))
            return;
        const double value = scalarAt(colours, volume, glm::dvec3(toVolume * glm::dvec4(place, 1.0)));
        if (std::isfinite(value)) {
            range.low = std::min(range.low, value);
            range.high = std::max(range.high, value);
        }
    };
    if (!visitVertices(frame, job, add))
        return cancelledError();
    return range.low <= range.high ? std::optional(usableRange(range)) : std::nullopt;
}

} // namespace isoslider::model
