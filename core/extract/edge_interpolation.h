#pragma once

#include <cmath>
#include <cstdint>
#include <type_traits>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "core/grid/normal_codec.h"
#include "core/grid/scalar_type.h"

namespace isoslider::extract {

/// Place of the isovalue on an edge whose ends have scalars s1 and s2: 0 at the lower grid point,
/// 1 at the upper. Always in [0, 1], also when the difference overflows or is denormal: a NaN falls
/// through the first comparison to 0. The same arithmetic in full extraction and in sliding, so that
/// equal surfaces have equal bytes.
/// PAPER 3.2: V = V1 + (isovalue - S1) dV. DEVIATION: the paper stores dV = (V2 - V1) / (S2 - S1) for each active
/// edge; with both scalars kept instead, an edge is 16 bytes and the shader computes this.
template <class Live>
inline Live edgeFraction(Live s1, Live s2, Live isovalue) {
    Live t = (isovalue * Live(0.5) - s1 * Live(0.5)) / (s2 * Live(0.5) - s1 * Live(0.5));
    t = t > Live(0) ? t : Live(0);
    t = t < Live(1) ? t : Live(1);
    return t;
}

/// Below this square length the sum of two normals has no direction.
inline constexpr float kLeastNormalSquare = 1e-12f;

/// Unit normal at fraction `t` of an edge from the quantised normals at its ends. Where both ends are flat, or
/// their normals cancel, it points along the edge towards lower scalars; `rises`: the upper end's is greater.
/// PAPER 3.2: N from N1, N2 and m = 2 sin^2(alpha / 2). DEVIATION: divided by its length, because the paper's formula
/// needs a third number for each edge and is exact for small angles only.
inline glm::vec3 edgeNormal(NormalCode lower, NormalCode upper, float t, int axis, bool rises) {
    const glm::vec3 n1 = decodeDirection(lower), n2 = decodeDirection(upper);
    const glm::vec3 sum(n1.x + t * (n2.x - n1.x), n1.y + t * (n2.y - n1.y), n1.z + t * (n2.z - n1.z));
    const float square = sum.x * sum.x + sum.y * sum.y + sum.z * sum.z;
    if (!(square < kLeastNormalSquare))
        return sum * (1.0f / std::sqrt(square)); // both correctly rounded, on every instruction set
    glm::vec3 along(0.0f);
    along[axis] = rises ? -1.0f : 1.0f;
    return along;
}

/// What samples live as: float where it holds every one exactly, double otherwise.
template <class Sample>
using LiveOf =
    std::conditional_t<std::is_same_v<Sample, std::int32_t> || std::is_same_v<Sample, double>, double, float>;

} // namespace isoslider::extract
