#include "core/cell/plain_decisions.h"

#include <algorithm>
#include <limits>

#include "core/cell/cell_polynomials.h"

namespace isoslider::cell {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
using Slices = CellPolynomials<double>;

std::array<double, 4> slopesAcross(const CornerScalars& v, int axis) {
    std::array<double, 4> slopes;
    for (std::size_t k = 0; k < 4; ++k) {
        const auto lower = static_cast<std::size_t>(Slices::kSlice[axis][k]);
        slopes[k] = v[lower + static_cast<std::size_t>(Slices::step(axis))] - v[lower];
    }
    return slopes;
}

// What must be positive for something to hold, linear in the isovalue: at isovalue + h it is slack - rate h, with sums
// of this size behind the rate. Narrows the interval to where it holds, a little less.
void narrowWhile(StateInterval& interval, double isovalue, double slack, double rate, double rateSize) {
    const double error = kRateError * rateSize, distance = kLessOfLine * slack / (std::abs(rate) + error);
    const double margin = kIntervalError * (std::abs(isovalue) + distance);
    if (rate > -error)
        narrowTo(interval, isovalue, isovalue + distance, margin);
    if (rate < error)
        narrowTo(interval, isovalue, isovalue - distance, margin);
}

} // namespace

void narrowTo(StateInterval& interval, double isovalue, double critical, double margin) {
    if (critical - margin > isovalue)
        interval.above = std::min(interval.above, critical - margin);
    else if (critical + margin < isovalue)
        interval.below = std::max(interval.below, critical + margin);
    else
        interval = {kInfinity, -kInfinity};
}

bool isLeadingZero(const CornerScalars& scalars, int axis) {
    const std::array<double, 4> slope = slopesAcross(scalars, axis);
    if ((slope[0] == 0.0 || slope[3] == 0.0) && (slope[1] == 0.0 || slope[2] == 0.0))
        return true;
    return slope[0] * slope[3] == slope[1] * slope[2] && std::all_of(scalars.begin(), scalars.end(), isSmallInteger);
}

PlainLeading plainLeading(const CornerScalars& scalars) {
    PlainLeading leading;
    for (int axis = 0; axis < 3; ++axis) {
        const std::array<double, 4> slope = slopesAcross(scalars, axis);
        const double joining = slope[0] * slope[3], parting = slope[1] * slope[2], value = joining - parting;
        const double size = std::abs(joining) + std::abs(parting);
        leading.value[static_cast<std::size_t>(axis)] = value;
        leading.size[static_cast<std::size_t>(axis)] = size;
        if (isPlainSize(size) && std::abs(value) > kLeadingCertain * size)
            leading.product = leading.product == kUnknown || value > 0.0 ? leading.product : -leading.product;
        else if (isLeadingZero(scalars, axis))
            leading.product = 0;
        else if (leading.product != 0)
            leading.product = kUnknown;
    }
    return leading;
}

bool hasRootOutside(const CornerScalars& v, const PlainLeading& leading, double isovalue, StateInterval& interval) {
    CellPolynomials<double> cell;
    for (std::size_t i = 0; i < 8; ++i)
        cell.g[i] = v[i] - isovalue;
    for (int axis = 0; axis < 3; ++axis) {
        const double lead = leading.value[static_cast<std::size_t>(axis)];
        std::array<double, 2> q, size, rate, rateSize;
        for (int side = 0; side < 2; ++side) {
            const auto s = static_cast<std::size_t>(side);
            const double a = cell.at(axis, side, 0), b = cell.at(axis, side, 1), d = cell.at(axis, side, 2),
                         c = cell.at(axis, side, 3);
            const double joining = a * c, parting = b * d;
            q[s] = joining - parting;
            size[s] = std::abs(joining) + std::abs(parting);
            rate[s] = (a + c) - (b + d);
            rateSize[s] = std::abs(a) + std::abs(b) + std::abs(c) + std::abs(d);
            if (!isPlainSize(size[s]))
                return false;
            const double wrong = lead > 0.0 ? -q[s] : q[s];
            if (wrong > kCertain * size[s]) {
                narrowWhile(interval, isovalue, wrong, lead > 0.0 ? -rate[s] : rate[s], rateSize[s]);
                return true;
            }
        }
        const double difference = q[1] - q[0], slack = std::abs(difference) - std::abs(lead);
        if (slack > kCertain * (size[0] + size[1] + leading.size[static_cast<std::size_t>(axis)])) {
            const double change = rate[1] - rate[0];
            narrowWhile(interval, isovalue, slack, difference > 0.0 ? change : -change, rateSize[0] + rateSize[1]);
            return true;
        }
    }
    return false;
}

bool hasNoHexagon(const CornerScalars& v, const PlainLeading& leading, double isovalue, StateInterval& interval) {
    // D's roots have opposite signs here, and nothing cancels in them.
    std::array<double, 4> g, s; // across z: at the lower face, and from there to the upper one
    for (std::size_t k = 0; k < 4; ++k) {
        g[k] = v[k] - isovalue;
        s[k] = v[k + 4] - v[k];
    }
    const double a = leading.value[2], sizeA = leading.size[2];
    const double b0 = g[0] * s[3], b1 = s[0] * g[3], b2 = g[1] * s[2], b3 = s[1] * g[2];
    const double b = (b0 + b1) - (b2 + b3), sizeB = std::abs(b0) + std::abs(b1) + std::abs(b2) + std::abs(b3);
    const double c0 = g[0] * g[3], c1 = g[1] * g[2], c = c0 - c1, sizeC = std::abs(c0) + std::abs(c1);
    const double value = b * b - 4.0 * a * c, size = sizeB * sizeB + 4.0 * sizeA * sizeC;
    if (!(isPlainSize(size) && -value > kCertain * size))
        return false;
    const double rate = (g[0] + g[3]) - (g[1] + g[2]), square = (s[0] + s[3]) - (s[1] + s[2]);
    const double rateSize = std::abs(g[0]) + std::abs(g[3]) + std::abs(g[1]) + std::abs(g[2]);
    const double squareSize = std::abs(s[0]) + std::abs(s[3]) + std::abs(s[1]) + std::abs(s[2]);
    const double slope = 4.0 * a * rate - 2.0 * b * square,
                 slopeError = kRateError * (4.0 * sizeA * rateSize + 2.0 * sizeB * squareSize);
    const double bend = std::abs(square) + kRateError * squareSize, bend2 = bend * bend, lift = 4.0 * bend2 * -value;
    // How far D stays below zero if it rises from the value like this and bends up as far as it may.
    const auto distance = [&](double rise) {
        const double rise2 = rise * rise, root2 = rise2 + lift, root = std::sqrt(root2);
        if (!(root2 > kLeastSquare && root2 < kMostSize))
            return 0.0;
        return std::min(kFarthest,
                        kLessOfParabola * (rise > 0.0 ? -2.0 * value / (rise + root) : (root - rise) / (2.0 * bend2)));
    };
    const double up = distance(slope + slopeError), down = distance(slopeError - slope);
    narrowTo(interval, isovalue, isovalue + up, kIntervalError * (std::abs(isovalue) + up));
    narrowTo(interval, isovalue, isovalue - down, kIntervalError * (std::abs(isovalue) + down));
    return true;
}

} // namespace isoslider::cell
