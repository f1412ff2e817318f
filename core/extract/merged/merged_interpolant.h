#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "core/cell/trilinear_cell.h"
#include "core/extract/merged/merge_bound.h"

namespace isoslider::extract {

/// The trilinear interpolant of a merged cell as a polynomial of places in cells of the grid from its first corner.
/// Exact for integers of up to 32 bits at grid points: the side is a power of two.
class MergedInterpolant {
public:
    /// `side` in cells of the grid.
    MergedInterpolant(const cell::CornerScalars& c, double side) {
        const double once = 1.0 / side, twice = once * once;
        constant_ = c[0];
        slope_ = {(c[1] - c[0]) * once, (c[2] - c[0]) * once, (c[4] - c[0]) * once};
        twist_ = {(c[6] - c[4] - c[2] + c[0]) * twice, (c[5] - c[4] - c[1] + c[0]) * twice,
                  (c[3] - c[2] - c[1] + c[0]) * twice};
        product_ = ((c[7] - c[6] - c[5] + c[4]) - (c[3] - c[2] - c[1] + c[0])) * twice * once;
    }

    double at(const std::array<double, 3>& p) const {
        return constant_ + slope_[0] * p[0] + p[1] * (slope_[1] + twist_[2] * p[0]) +
               p[2] * (slope_[2] + twist_[1] * p[0] + p[1] * (twist_[0] + product_ * p[0]));
    }
    /// Of the gradient, per cell of the grid; constant along the axis.
    double derivative(std::size_t axis, const std::array<double, 3>& p) const {
        const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
        return slope_[axis] + twist_[v] * p[u] + p[v] * (twist_[u] + product_ * p[u]);
    }

    /// Whether an active edge of the grid, from `start` along `axis`, whose ends have the samples a and b, keeps to the
    /// bound.
    bool keepsWithin(const MergeBound& bound, const std::array<int, 3>& start, std::size_t axis, double a,
                     double b) const {
        std::array<double, 3> p{static_cast<double>(start[0]), static_cast<double>(start[1]),
                                static_cast<double>(start[2])};
        const double lower = at(p), along = derivative(axis, p);
        const double difference = std::max(std::abs(a - lower), std::abs(b - (lower + along)));
        if (bound.measure == MergeBound::Measure::Scalar)
            return difference <= bound.limit;
        p[axis] += 0.5;
        const double du = derivative((axis + 1) % 3, p), dv = derivative((axis + 2) % 3, p);
        double length = std::sqrt(along * along + du * du + dv * dv);
        if (!(length > 1e-150 && length < 1e150)) { // squares overflow, or vanish
            const double most = std::max({std::abs(along), std::abs(du), std::abs(dv)});
            length = most > 0.0 ? most * std::hypot(along / most, du / most, dv / most) : 0.0;
        }
        return std::isfinite(difference) && std::isfinite(length) && difference <= bound.limit * length;
    }

private:
    double constant_, product_;
    std::array<double, 3> slope_, twist_; ///< twist: of the product of the other two axes
};

} // namespace isoslider::extract
