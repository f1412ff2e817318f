#include "ui/model/slices/cap_samples.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>
#include <glm/gtx/quaternion.hpp>
#include <glm/matrix.hpp>

#include "ui/model/slices/slice_geometry.h"

namespace isoslider::model {
namespace {

constexpr int kMostPixelsPerStep = 4;

bool isOutside(const glm::dvec3& place, const GridDims& dims) {
    constexpr double kRounding = 1e-7; // as where samples are taken
    for (int axis = 0; axis < 3; ++axis)
        if (place[axis] < -kRounding ||
            place[axis] > static_cast<double>(dims[static_cast<std::size_t>(axis)] - 1) + kRounding)
            return true;
    return false;
}

} // namespace

extract::SlicePlane capPlaneOf(const ClipPlane& plane, const GridGeometry& volume, std::int64_t step) {
    SliceOptions options;
    // Any turn about the normal would do.
    options.orientation = plane.normal.z < -0.999999 ? glm::dquat(0.0, 1.0, 0.0, 0.0)
                                                     : glm::rotation(glm::dvec3(0.0, 0.0, 1.0), plane.normal);
    const glm::dvec3 centre = 0.5 * (glm::dvec3(volume.dims[0], volume.dims[1], volume.dims[2]) - 1.0);
    options.position = centre + glm::inverse(glm::dmat3(volume.indexToWorld())) * (plane.normal * plane.offset);
    extract::SlicePlane pixels = planeOf(SliceKind::Oblique, options, volume, step);
    const int longest = std::max({1, pixels.width - 1, pixels.height - 1});
    const int finer = std::clamp((kMostObliqueSide - 1) / longest, 1, kMostPixelsPerStep);
    pixels.right /= finer;
    pixels.down /= finer;
    // One more step at the ends: the last pixel may lie short of the volume's corner.
    pixels.width = pixels.width * finer + 1;
    pixels.height = pixels.height * finer + 1;
    return pixels;
}

CapSamples capSamplesOf(const ClipPlane& of, const extract::SlicePlane& plane, const extract::SliceSamples& samples,
                        const GridDims& dims) {
    CapSamples cap{of, plane, {}};
    const auto width = static_cast<std::ptrdiff_t>(plane.width), height = static_cast<std::ptrdiff_t>(plane.height);
    const auto valueAt = [&](std::ptrdiff_t column, std::ptrdiff_t row) {
        return samples.values[static_cast<std::size_t>(row * width + column)];
    };
    cap.pixels.resize(samples.values.size(), glm::vec2(0.0f));
    for (std::ptrdiff_t row = 0; row < height; ++row)
        for (std::ptrdiff_t column = 0; column < width; ++column) {
            glm::vec2& pixel = cap.pixels[static_cast<std::size_t>(row * width + column)];
            if (const float value = valueAt(column, row); std::isfinite(value)) {
                pixel = {value, 1.0f};
                continue;
            }
            if (!isOutside(plane.at(static_cast<double>(column), static_cast<double>(row)), dims))
                continue; // missing
            float sum = 0.0f, count = 0.0f;
            for (std::ptrdiff_t r = std::max<std::ptrdiff_t>(0, row - 1); r < std::min(height, row + 2); ++r)
                for (std::ptrdiff_t c = std::max<std::ptrdiff_t>(0, column - 1); c < std::min(width, column + 2); ++c)
                    if (std::isfinite(valueAt(c, r))) {
                        sum += valueAt(c, r);
                        count += 1.0f;
                    }
            if (count > 0.0f && std::isfinite(sum))
                pixel = {sum / count, 1.0f};
        }
    return cap;
}

} // namespace isoslider::model
