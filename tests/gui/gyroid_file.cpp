#include "tests/gui/gyroid_file.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <string>
#include <vector>

namespace isoslider::test {

std::filesystem::path writeGyroid(const TemporaryFolder& folder, int n, float angle) {
    std::vector<float> sines, cosines;
    for (int i = 0; i < n; ++i) {
        const float phase = angle * static_cast<float>(i) / static_cast<float>(n);
        sines.push_back(std::sin(phase));
        cosines.push_back(std::cos(phase));
    }
    const float middle = static_cast<float>(n - 1) / 2.0f;
    std::vector<std::uint16_t> samples;
    samples.reserve(static_cast<std::size_t>(n) * n * n);
    const auto at = [](const std::vector<float>& table, int i) { return table[static_cast<std::size_t>(i)]; };
    for (int z = 0; z < n; ++z)
        for (int y = 0; y < n; ++y)
            for (int x = 0; x < n; ++x) {
                const float dx = static_cast<float>(x) - middle, dy = static_cast<float>(y) - middle,
                            dz = static_cast<float>(z) - middle;
                const float rim = std::clamp(
                    (0.36f * static_cast<float>(n) - std::sqrt(dx * dx + dy * dy + dz * dz)) / 8.0f, 0.0f, 1.0f);
                const float wave =
                    at(sines, x) * at(cosines, y) + at(sines, y) * at(cosines, z) + at(sines, z) * at(cosines, x);
                samples.push_back(static_cast<std::uint16_t>(rim * (2048.0f + 900.0f * wave)));
            }
    std::ofstream(folder / "gyroid.raw", std::ios::binary)
        .write(reinterpret_cast<const char*>(samples.data()),
               static_cast<std::streamsize>(samples.size() * sizeof samples[0]));
    const std::string size = std::to_string(n);
    return folder.write(
        "gyroid.mhd",
        "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\nDimSize = " + size + " " +
            size + " " + size + "\nElementSpacing = 1 1 1\nElementType = MET_USHORT\nElementDataFile = gyroid.raw\n");
}

} // namespace isoslider::test
