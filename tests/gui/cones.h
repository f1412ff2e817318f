#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <string>

#include "tests/support/temporary_folder.h"

namespace isoslider::test {

/// Three cones: the surface at 1.5 is three pieces; below, two of them join at 1 and the third at -1.
inline std::filesystem::path writeCones(const TemporaryFolder& folder) {
    constexpr int kPoints = 32;
    struct Cone {
        float x, y, z, height;
    };
    constexpr std::array<Cone, 3> kCones{{{8, 10, 15, 6}, {17, 10, 15, 4}, {17, 20, 15, 3}}};
    std::string bytes = "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n"
                        "DimSize = 32 32 32\nElementSpacing = 1 1 1\nElementType = MET_FLOAT\n"
                        "ElementDataFile = LOCAL\n";
    for (int z = 0; z < kPoints; ++z)
        for (int y = 0; y < kPoints; ++y)
            for (int x = 0; x < kPoints; ++x) {
                float value = -30.0f;
                for (const Cone& cone : kCones)
                    value = std::max(value, cone.height - std::hypot(static_cast<float>(x) - cone.x,
                                                                     static_cast<float>(y) - cone.y,
                                                                     static_cast<float>(z) - cone.z));
                bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
            }
    return folder.write("cones.mha", bytes);
}

} // namespace isoslider::test
