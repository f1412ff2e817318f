#pragma once

#include <array>
#include <cstdint>

namespace isoslider::extract {

/// How far merged cells may lead the surface astray. Of an active edge in a merged cell: the greater difference, at its
/// ends, between the sample and the merged cell's trilinear interpolant.
struct MergeBound {
    enum class Measure : std::uint8_t {
        Scalar, ///< that difference itself; PAPER 2.2, where it is given as a percentage of the value range
        Distance, ///< divided by the length of the interpolant's gradient at the edge's middle: cells
    };
    Measure measure = Measure::Scalar;
    double limit = 0.0; ///< 0: nothing is merged

    friend bool operator==(const MergeBound&, const MergeBound&) = default;
};

/// The bound in percent of the value range, as the paper gives it.
inline MergeBound percentOfRange(double percent, double least, double greatest) {
    return {MergeBound::Measure::Scalar, percent / 100.0 * greatest - percent / 100.0 * least};
}

/// Merged cells have 2^n cells of the grid along each axis, n from 1 to this.
inline constexpr int kMaxMergeLevel = 5;
/// Those of a live brick are not larger than the brick.
inline constexpr int kMaxBrickMergeLevel = 3;
/// Numbers of cells by their level; 0 are cells of the grid.
using LeafCounts = std::array<std::uint64_t, kMaxMergeLevel + 1>;

} // namespace isoslider::extract
