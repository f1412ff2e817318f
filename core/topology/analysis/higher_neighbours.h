#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/grid/grid_geometry.h"

namespace isoslider::topology {

/// The neighbours of a grid point along edges of the grid: 0 to 5, down and up x, y, z. Across faces: all pairs of
/// those along different axes, in order.
inline constexpr std::array<std::array<std::uint8_t, 2>, 12> kFacePairs{
    {{0, 2}, {0, 3}, {0, 4}, {0, 5}, {1, 2}, {1, 3}, {1, 4}, {1, 5}, {2, 4}, {2, 5}, {3, 4}, {3, 5}}};

/// Neighbours as bits: six along edges, then twelve across faces.
using Neighbours = std::uint32_t;
inline constexpr unsigned kEdgeNeighbours = 6;
inline constexpr Neighbours kAllNeighbours = (1u << 18) - 1;

/// Which neighbours of the grid points of some planes are higher; of equal ones those with the greater place are. What
/// is said of neighbours outside the planes or the grid means nothing.
class HigherNeighbours {
public:
    /// `samples`: of `planes` planes of the grid; whether one more lies before and behind them in memory. O(points).
    template <class Sample>
    void find(const Sample* samples, const GridDims& dims, std::int64_t planes, bool hasPlaneBefore,
              bool hasPlaneAfter);

    const std::uint8_t* edges() const { return parts_[0].data(); }
    Neighbours at(std::int64_t place) const {
        const auto i = static_cast<std::size_t>(place);
        return parts_[0][i] | static_cast<Neighbours>(parts_[1][i]) << 6 | static_cast<Neighbours>(parts_[2][i]) << 14;
    }

    /// Of a row: places of the neighbours from a point, and where to write.
    struct Row {
        std::array<std::ptrdiff_t, 18> steps;
        std::array<std::uint8_t*, 3> out;
    };

private:
    std::array<std::vector<std::uint8_t>, 3> parts_; ///< by point: six bits, eight, four
};

} // namespace isoslider::topology
