#pragma once

#include <cstddef>
#include <utility>

#include "core/cell/cell_numbering.h"
#include "core/cell/trilinear_cell.h"
#include "core/topology/analysis/cell_codes.h"

namespace isoslider::test {

/// Of equal corners the one with the greater place.
inline bool isHigher(const cell::CornerScalars& scalars, unsigned a, unsigned b) {
    return std::pair(scalars[a], a) > std::pair(scalars[b], b);
}

/// What the edges of a cell tell, corner by corner: its code, as long as no scalars exclude an inner critical point.
inline unsigned cellCodeOf(const cell::CornerScalars& scalars) {
    unsigned code = topology::kMayHaveInner;
    for (unsigned face = 0; face < 6; ++face) {
        const auto& c = cell::kFaceCorners[face];
        const auto are = [&](std::size_t up) {
            for (const std::size_t low : {up + 1, (up + 3) % 4})
                if (!isHigher(scalars, c[up], c[low]) || !isHigher(scalars, c[(up + 2) % 4], c[low]))
                    return false;
            return true;
        };
        code |= (are(0) || are(1) ? 1u : 0u) << face;
    }
    for (unsigned axis = 0; axis < 3; ++axis) {
        int rising = 0;
        for (unsigned c = 0; c < 8; ++c)
            rising += (c >> axis & 1u) == 0 && isHigher(scalars, c ^ 1u << axis, c) ? 1 : 0;
        if (rising == 0 || rising == 4)
            code &= topology::kSaddleFaces;
    }
    return code;
}

} // namespace isoslider::test
