#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "core/grid/gradient.h"

namespace isoslider {

/// What differences along the axes are multiplied with: rounded alike wherever gradients are made.
inline glm::vec3 inverseSpacingOf(const GridGeometry& geometry) {
    glm::vec3 inverse;
    for (int a = 0; a < 3; ++a)
        inverse[a] = static_cast<float>(1.0 / std::abs(geometry.spacing[a]));
    return inverse;
}

/// Normals of the points from `begin` on, `extent` of them along each axis, x fastest; "no normal" where a sample is
/// missing. REQUIRES: the view holds one point more on every side, but where the grid ends.
template <class Sample>
void findNormals(const SampleView<Sample>& view, const std::array<std::int64_t, 3>& begin,
                 const std::array<int, 3>& extent, const glm::vec3& inverseSpacing, NormalCode* out) {
    for (std::int64_t z = begin[2]; z < begin[2] + extent[2]; ++z)
        for (std::int64_t y = begin[1]; y < begin[1] + extent[1]; ++y)
            for (std::int64_t x = begin[0]; x < begin[0] + extent[0]; ++x)
                *out++ = isMissing(view.samples[view.offset(x, y, z)])
                             ? kNoNormal
                             : normalOfGradient(gradientAt(view, x, y, z, inverseSpacing));
}

} // namespace isoslider
