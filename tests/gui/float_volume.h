#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <string_view>

#include "tests/support/temporary_folder.h"

namespace isoslider::test {

/// Writes a MetaImage of floats, value(x, y, z) at each grid point. `fields`: further lines of its header.
template <class Value>
std::filesystem::path writeFloats(const TemporaryFolder& folder, const char* name, const std::array<int, 3>& dims,
                                  const Value& value, std::string_view fields = "ElementSpacing = 1 1 1\n") {
    std::string bytes = "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\nDimSize =";
    for (const int dim : dims)
        bytes.append(" ").append(std::to_string(dim));
    bytes.append("\n").append(fields).append("ElementType = MET_FLOAT\nElementDataFile = LOCAL\n");
    for (int z = 0; z < dims[2]; ++z)
        for (int y = 0; y < dims[1]; ++y)
            for (int x = 0; x < dims[0]; ++x) {
                const auto sample = static_cast<float>(value(x, y, z));
                bytes.append(reinterpret_cast<const char*>(&sample), sizeof sample);
            }
    return folder.write(name, bytes);
}

} // namespace isoslider::test
