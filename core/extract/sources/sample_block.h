#pragma once

#include <array>
#include <cstdint>

#include "core/grid/brick_grid.h"
#include "core/grid/gradient.h"

namespace isoslider::extract {

/// First and one past the last local coordinate from -1 to 9 that lie inside the box, for a brick that begins at
/// `origin`.
inline void placeInBox(const GridDims& dims, const std::array<std::int64_t, 3>& origin, std::array<int, 3>& begin,
                       std::array<int, 3>& end) {
    for (std::size_t a = 0; a < 3; ++a) {
        begin[a] = origin[a] > 0 ? -1 : 0;
        end[a] = static_cast<int>(std::min<std::int64_t>(10, dims[a] - origin[a]));
    }
}

/// The samples around one brick: local coordinates -1 to 9 along each axis. Those from 0 to 8 are the ends of
/// the brick's edges; the others are what gradients there and the wholeness of cells depend on. Rows are
/// padded to 16 so that they are read in whole vectors; places outside the box hold anything.
template <class Sample>
struct SampleBlock {
    static constexpr int kRow = 16;
    static constexpr int kSide = 11;
    static constexpr int kPlane = kRow * kSide;

    alignas(64) std::array<Sample, kPlane * kSide> samples;
    std::array<int, 3> begin{}; ///< first and one past the last local coordinate inside the box
    std::array<int, 3> end{};

    static constexpr int offset(int x, int y, int z) { return (x + 1) + kRow * (y + 1) + kPlane * (z + 1); }
    static constexpr int stride(int axis) { return axis == 0 ? 1 : axis == 1 ? kRow : kPlane; }

    bool isInside(int x, int y, int z) const {
        return x >= begin[0] && x < end[0] && y >= begin[1] && y < end[1] && z >= begin[2] && z < end[2];
    }
    /// As gradientAt() of the whole volume.
    glm::vec3 gradient(int x, int y, int z, const glm::vec3& inverseSpacing) const {
        const Sample* point = samples.data() + offset(x, y, z);
        return {derivativeAt(point, stride(0), x > begin[0], x + 1 < end[0], inverseSpacing.x),
                derivativeAt(point, stride(1), y > begin[1], y + 1 < end[1], inverseSpacing.y),
                derivativeAt(point, stride(2), z > begin[2], z + 1 < end[2], inverseSpacing.z)};
    }
};

} // namespace isoslider::extract
