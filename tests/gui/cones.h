#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>

#include "tests/gui/float_volume.h"

namespace isoslider::test {

/// Three cones: the surface at 1.5 is three pieces; below, two of them join at 1 and the third at -1.
inline std::filesystem::path writeCones(const TemporaryFolder& folder) {
    constexpr int kPoints = 32;
    struct Cone {
        float x, y, z, height;
    };
    static constexpr std::array<Cone, 3> kCones{{{8, 10, 15, 6}, {17, 10, 15, 4}, {17, 20, 15, 3}}};
    return writeFloats(folder, "cones.mha", {kPoints, kPoints, kPoints}, [](int x, int y, int z) {
        float value = -30.0f;
        for (const Cone& cone : kCones)
            value =
                std::max(value, cone.height - std::hypot(static_cast<float>(x) - cone.x, static_cast<float>(y) - cone.y,
                                                         static_cast<float>(z) - cone.z));
        return value;
    });
}

} // namespace isoslider::test
