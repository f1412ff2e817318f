#pragma once

#include <cstdint>

#include "core/cell/trilinear_cell.h"

namespace isoslider::cell {

/// Bit i: corner i is above (scalar >= isovalue).
inline std::uint8_t signsOf(const CornerScalars& scalars, double isovalue) {
    unsigned signs = 0;
    for (unsigned i = 0; i < 8; ++i)
        signs |= static_cast<unsigned>(scalars[i] >= isovalue) << i;
    return static_cast<std::uint8_t>(signs);
}

} // namespace isoslider::cell
