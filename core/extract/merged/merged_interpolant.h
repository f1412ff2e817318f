#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "core/cell/trilinear_cell.h"
#include "core/extract/merged/merge_bound.h"

namespace isoslider::extract {

/// The trilinear interpolant of a merged cell, at places in cells of the grid from its first corner.
class MergedInterpolant {
public:
    /// `side` in cells of the grid.
    MergedInterpolant(const cell::CornerScalars& corners, double side) : corners_(corners), inverseSide_(1.0 / side) {}

    double at(double x, double y, double z) const {
        const double u = x * inverseSide_, v = y * inverseSide_, w = z * inverseSide_;
        const auto alongX = [&](std::size_t c) { return corners_[c] * (1 - u) + corners_[c + 1] * u; };
        const double y0 = alongX(0) * (1 - v) + alongX(2) * v, y1 = alongX(4) * (1 - v) + alongX(6) * v;
        return y0 * (1 - w) + y1 * w;
    }
    /// Per cell of the grid.
    double gradientLength(double x, double y, double z) const {
        const auto [gx, gy, gz] = cell::gradientInCell(corners_, x * inverseSide_, y * inverseSide_, z * inverseSide_);
        return std::sqrt(gx * gx + gy * gy + gz * gz) * inverseSide_;
    }

    /// Whether an active edge of the grid, from `start` along `axis`, whose ends have the samples a and b, keeps to the
    /// bound.
    bool keepsWithin(const MergeBound& bound, const std::array<int, 3>& start, std::size_t axis, double a,
                     double b) const {
        std::array<double, 3> place{static_cast<double>(start[0]), static_cast<double>(start[1]),
                                    static_cast<double>(start[2])};
        const double first = std::abs(a - at(place[0], place[1], place[2]));
        place[axis] += 1.0;
        const double difference = std::max(first, std::abs(b - at(place[0], place[1], place[2])));
        if (bound.measure == MergeBound::Measure::Scalar)
            return difference <= bound.limit;
        place[axis] -= 0.5;
        return difference <= bound.limit * gradientLength(place[0], place[1], place[2]);
    }

private:
    cell::CornerScalars corners_;
    double inverseSide_;
};

} // namespace isoslider::extract
