#pragma once

#include <cmath>
#include <cstddef>
#include <span>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "core/grid/classification.h"
#include "core/grid/grid_geometry.h"
#include "core/grid/normal_codec.h"

namespace isoslider {

/// Samples x fastest with a fixed number of points per row and plane: a volume or a part of one.
template <class Sample>
struct SampleView {
    const Sample* samples = nullptr;
    GridDims dims{0, 0, 0};

    std::ptrdiff_t stride(int axis) const {
        return axis == 0 ? 1 : static_cast<std::ptrdiff_t>(axis == 1 ? dims[0] : dims[0] * dims[1]);
    }
    std::ptrdiff_t offset(std::int64_t x, std::int64_t y, std::int64_t z) const {
        return static_cast<std::ptrdiff_t>(x + dims[0] * (y + dims[1] * z));
    }
    /// Whether the cell that starts there lies in the grid and has eight finite corners.
    bool isCellValid(std::int64_t x, std::int64_t y, std::int64_t z) const {
        if (x < 0 || y < 0 || z < 0 || x + 1 >= dims[0] || y + 1 >= dims[1] || z + 1 >= dims[2])
            return false;
        for (int c = 0; c < 8; ++c)
            if (isMissing(samples[offset(x + (c & 1), y + (c >> 1 & 1), z + (c >> 2))]))
                return false;
        return true;
    }
};

/// Derivative along one axis at a grid point, per world unit: central difference where both
/// neighbours are there, one-sided at the box and beside missing values, 0 where there is neither.
template <class Sample>
inline float derivativeAt(const Sample* point, std::ptrdiff_t stride, bool hasLower, bool hasUpper,
                          float inverseSpacing) {
    // Floats hold the samples of all other types, and differences of 16-bit integers, exactly.
    using Wide =
        std::conditional_t<std::is_same_v<Sample, double> || std::is_same_v<Sample, std::int32_t>, double, float>;
    hasLower = hasLower && !isMissing(point[-stride * (hasLower ? 1 : 0)]);
    hasUpper = hasUpper && !isMissing(point[stride * (hasUpper ? 1 : 0)]);
    const Wide lower = static_cast<Wide>(hasLower ? point[-stride] : *point);
    const Wide upper = static_cast<Wide>(hasUpper ? point[stride] : *point);
    const Wide scale = hasLower && hasUpper ? Wide(0.5) : Wide(1);
    // Halved before subtracting: +-FLT_MAX neighbours must not overflow.
    const Wide difference = upper * scale - lower * scale;
    return static_cast<float>(difference * static_cast<Wide>(inverseSpacing));
}

/// Gradient at (x, y, z) along the grid's own axes, per world unit. Any finite length, zero included.
template <class Sample>
inline glm::vec3 gradientAt(const SampleView<Sample>& view, std::int64_t x, std::int64_t y, std::int64_t z,
                            const glm::vec3& inverseSpacing) {
    const Sample* point = view.samples + view.offset(x, y, z);
    return {derivativeAt(point, 1, x > 0, x + 1 < view.dims[0], inverseSpacing.x),
            derivativeAt(point, view.stride(1), y > 0, y + 1 < view.dims[1], inverseSpacing.y),
            derivativeAt(point, view.stride(2), z > 0, z + 1 < view.dims[2], inverseSpacing.z)};
}

/// Unit vector, or zero where `v` has no direction; safe for the whole range of float.
inline glm::vec3 normalizedOrZero(glm::vec3 v) {
    const float largest = std::max(std::max(std::abs(v.x), std::abs(v.y)), std::abs(v.z));
    if (!(largest > 0.0f) || !std::isfinite(largest))
        return glm::vec3(0.0f);
    v /= largest;
    if (!std::isfinite(v.x) || !std::isfinite(v.y) || !std::isfinite(v.z))
        return glm::vec3(0.0f); // a denormal gradient: no usable direction
    return v / std::sqrt(glm::dot(v, v));
}

/// Sums of absolute components whose reciprocal, and their products with it, are normal floats.
inline constexpr float kLeastPlainGradient = 1e-30f, kGreatestPlainGradient = 1e30f;

/// The quantised normal at a grid point: against the gradient, towards lower scalars. The octahedral map needs the
/// direction only, so in the common range of lengths nothing is normalised.
inline NormalCode normalOfGradient(const glm::vec3& gradient) {
    const float sum = std::abs(gradient.x) + std::abs(gradient.y) + std::abs(gradient.z);
    if (!(sum >= kLeastPlainGradient && sum <= kGreatestPlainGradient))
        return encodeNormal(normalizedOrZero(-gradient));
    const float scale = 1.0f / sum;
    float u = -gradient.x * scale, v = -gradient.y * scale;
    if (gradient.z > 0.0f) {
        const float folded = (1.0f - std::abs(v)) * (u >= 0.0f ? 1.0f : -1.0f);
        v = (1.0f - std::abs(u)) * (v >= 0.0f ? 1.0f : -1.0f);
        u = folded;
    }
    return static_cast<NormalCode>(quantiseNormal(u) | quantiseNormal(v) << 8);
}

/// What differences along the axes are multiplied with: rounded alike wherever gradients are made.
inline glm::vec3 inverseSpacingOf(const GridGeometry& geometry) {
    glm::vec3 inverse;
    for (int a = 0; a < 3; ++a)
        inverse[a] = static_cast<float>(1.0 / std::abs(geometry.spacing[a]));
    return inverse;
}

} // namespace isoslider
