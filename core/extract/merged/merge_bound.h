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

    /// Where nothing is merged the measure does not matter.
    friend bool operator==(const MergeBound& a, const MergeBound& b) {
        return a.limit == b.limit && (a.measure == b.measure || a.limit == 0.0);
    }
};

/// A bound as users state it: scalars in percent of the value range, as in the paper.
struct MergeError {
    MergeBound::Measure measure = MergeBound::Measure::Scalar;
    double amount = 0.0; ///< %, or cells; 0: nothing is merged

    friend bool operator==(const MergeError&, const MergeError&) = default;
};

/// For a volume of values from `least` to `greatest`.
inline MergeBound boundOf(const MergeError& error, double least, double greatest) {
    if (error.measure == MergeBound::Measure::Distance)
        return {error.measure, error.amount};
    return {error.measure, error.amount / 100.0 * greatest - error.amount / 100.0 * least};
}

/// The other way round.
inline MergeError errorOf(const MergeBound& bound, double least, double greatest) {
    if (bound.measure == MergeBound::Measure::Distance || !(bound.limit > 0.0))
        return {bound.measure, bound.limit};
    return {bound.measure, 50.0 * (bound.limit / (0.5 * greatest - 0.5 * least))};
}

/// Merged cells have 2^n cells of the grid along each axis, n from 1 to this.
inline constexpr int kMaxMergeLevel = 5;
/// Those of a live brick are not larger than the brick.
inline constexpr int kMaxBrickMergeLevel = 3;
/// Numbers of cells by their level; 0 are cells of the grid.
using LeafCounts = std::array<std::uint64_t, kMaxMergeLevel + 1>;

} // namespace isoslider::extract
