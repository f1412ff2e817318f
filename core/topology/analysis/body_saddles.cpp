#include "core/topology/analysis/body_saddles.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "core/cell/cell_polynomials.h"

namespace isoslider::topology {
namespace {

using cell::CornerScalars;

// Underflow would leave nothing of products of this size; overflow and NaN make the comparison false.
bool isPlainSize(double size) { return size > 1e-280 && size < 1e280; }

// What critical points depend on, in the words of cell_polynomials.h: leading coefficients and the rates of the faces,
// with the sizes of the terms behind each. None of them depends on the isovalue.
template <class Number>
struct Shape {
    std::array<Number, 3> leading{}, leadingSize{};
    std::array<std::array<Number, 2>, 3> rate{};
    std::array<Number, 3> rateSize{};

    explicit Shape(const CornerScalars& scalars) {
        using Slices = cell::CellPolynomials<Number>;
        const auto at = [&](int axis, int side, int k) {
            return static_cast<Number>(
                scalars[static_cast<std::size_t>(Slices::kSlice[axis][k] + side * Slices::step(axis))]);
        };
        for (int axis = 0; axis < 3; ++axis) {
            const auto i = static_cast<std::size_t>(axis);
            const auto slope = [&](int k) { return at(axis, 1, k) - at(axis, 0, k); };
            const Number joining = slope(0) * slope(3), parting = slope(1) * slope(2);
            leading[i] = joining - parting;
            leadingSize[i] = std::abs(joining) + std::abs(parting);
            for (int side = 0; side < 2; ++side) {
                const Number first = at(axis, side, 0) - at(axis, side, 1),
                             second = at(axis, side, 3) - at(axis, side, 2);
                rate[i][static_cast<std::size_t>(side)] = first + second;
                rateSize[i] = std::max(rateSize[i], std::abs(first) + std::abs(second));
            }
        }
    }

    /// Along each axis the mixed derivative of the two others at a critical point: one point has these, the other the
    /// same with all signs changed. `signs`: of the leading coefficients, whose product is -1.
    std::array<Number, 3> mixed(const std::array<int, 3>& signs) const {
        const Number root = std::sqrt(-leading[0] * leading[1] * leading[2]);
        // The product of any two is the leading coefficient of the third, less its sign.
        return {root / std::abs(leading[0]), static_cast<Number>(-signs[2]) * root / std::abs(leading[1]),
                static_cast<Number>(-signs[1]) * root / std::abs(leading[2])};
    }
    /// Bound on the relative error of mixed(), with `unit` that of one operation.
    Number mixedError(Number unit) const {
        Number error = 8 * unit;
        for (std::size_t i = 0; i < 3; ++i)
            error += 4 * unit * leadingSize[i] / std::abs(leading[i]);
        return error;
    }
};

// Of up to 17 bits: a sum of four products of three differences is exact.
bool isShortInteger(double x) { return std::abs(x) <= 0x1p16 && x == std::nearbyint(x); }

int signOf(double value) { return value < 0.0 ? -1 : 1; }

// A double below or at a number, as long as no other lies between.
double floorOf(long double number) {
    const auto rounded = static_cast<double>(number);
    return static_cast<long double>(rounded) > number
               ? std::nextafter(rounded, -std::numeric_limits<double>::infinity())
               : rounded;
}

// The last double up to the value at a critical point with these mixed derivatives; NaN where it is not certain. The
// gradient vanishes there, so an error of its place hardly matters: f(p + d) - f(p) has no term of first order.
double valueAt(const CornerScalars& scalars, const Shape<long double>& shape, const std::array<long double, 3>& mixed) {
    constexpr long double kUnit = std::numeric_limits<long double>::epsilon();
    constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();
    const long double relative = shape.mixedError(kUnit);
    std::array<long double, 3> place, error;
    for (std::size_t i = 0; i < 3; ++i) {
        const long double range = shape.rate[i][1] - shape.rate[i][0];
        place[i] = (mixed[i] - shape.rate[i][0]) / range;
        error[i] = (std::abs(mixed[i]) * relative + 16 * kUnit * (std::abs(mixed[i]) + 2 * shape.rateSize[i])) /
                   std::abs(range);
        if (!(error[i] < 0.01L))
            return kNothing;
    }
    const auto base = static_cast<long double>(scalars[0]);
    long double value = 0.0L, size = 0.0L;
    for (std::size_t c = 1; c < 8; ++c) {
        long double weight = 1.0L;
        for (std::size_t i = 0; i < 3; ++i)
            weight *= (c >> i & 1) != 0 ? place[i] : 1.0L - place[i];
        const long double term = weight * (static_cast<long double>(scalars[c]) - base);
        value += term;
        size += std::abs(term);
    }
    value += base;
    const long double third = std::abs(shape.rate[0][1] - shape.rate[0][0]);
    const long double offPlace = std::abs(mixed[0]) * error[1] * error[2] + std::abs(mixed[1]) * error[0] * error[2] +
                                 std::abs(mixed[2]) * error[0] * error[1] + third * error[0] * error[1] * error[2];
    const long double bound =
        2 * offPlace + 8 * kUnit * size + kUnit * std::abs(value); // 15 roundings, each half a unit
    const double least = floorOf(value - bound), most = floorOf(value + bound);
    return least == most ? least + 0.0 : kNothing; // no -0
}

} // namespace

bool CellSaddles::find(const CornerScalars& scalars, unsigned faces, bool mayHaveInner) {
    innerCount_ = 0;
    flatFaces_ = 0;
    for (; faces != 0; faces &= faces - 1)
        if (!findFace(scalars, static_cast<std::size_t>(std::countr_zero(faces))))
            return false;
    return !mayHaveInner || findInner(scalars);
}

// Near the saddle the surface is a graph over what is below on the face where scalars grow into the cell, over what is
// above where they fall. Beyond the saddle what is above is parted, and what is below is one.
bool CellSaddles::findFace(const CornerScalars& scalars, std::size_t face) {
    constexpr double kCertain = 1e-13;
    const auto& corners = cell::kFaceCorners[face];
    std::array<double, 4> at, inwards;
    int growing = 0;
    for (std::size_t i = 0; i < 4; ++i) {
        at[i] = scalars[corners[i]];
        inwards[i] = scalars[corners[i] ^ 1u << face / 2] - at[i];
        growing += (face % 2 == 0 ? inwards[i] >= 0.0 : inwards[i] > 0.0) ? 1 : 0;
    }
    if (growing == 0 || growing == 4) {
        euler_[face] = growing == 4 ? -1 : 1;
        return true;
    }
    // The derivative at the saddle, times the square of the face's rate.
    const double ab = at[0] - at[1], ad = at[0] - at[3], cb = at[2] - at[1], cd = at[2] - at[3];
    const std::array<double, 4> terms{cb * cd * inwards[0], ad * cd * inwards[1], ad * ab * inwards[2],
                                      cb * ab * inwards[3]};
    const double sum = (terms[0] + terms[1]) + (terms[2] + terms[3]);
    const double size = std::abs(terms[0]) + std::abs(terms[1]) + std::abs(terms[2]) + std::abs(terms[3]);
    if (!isPlainSize(size) || !(std::abs(sum) > kCertain * size))
        return sum == 0.0 && std::all_of(scalars.begin(), scalars.end(), isShortInteger) &&
               findFlatFace(at, inwards, face);
    euler_[face] = sum > 0.0 ? -1 : 1;
    return true;
}

// The derivative is zero: a critical point of the cell lies on the face. Off its isovalue nothing depends on whether it
// is moved a little; moved out of the cell it is none of its critical points, and the face's saddle has the derivative
// that goes with that. Of the saddles of slices into the cell, (AC - BD) / (A + C - B - D) with A and C above, this one
// is the least where the leading coefficient of AC - BD is positive: then scalars grow into the cell.
bool CellSaddles::findFlatFace(const std::array<double, 4>& at, const std::array<double, 4>& inwards,
                               std::size_t face) {
    const bool isFirstAbove = std::min(at[0], at[2]) > std::max(at[1], at[3]);
    if (!isFirstAbove && !(std::min(at[1], at[3]) > std::max(at[0], at[2])))
        return false; // the saddle is on the face's edge
    const double first = inwards[0] * inwards[2], second = inwards[1] * inwards[3];
    if (first == second)
        return false;
    euler_[face] = (first > second) == isFirstAbove ? -1 : 1;
    flatFaces_ |= 1u << face;
    return true;
}

bool CellSaddles::findInner(const CornerScalars& scalars) {
    constexpr double kCertain = 1e-12, kUnit = std::numeric_limits<double>::epsilon();
    const Shape<double> shape(scalars);
    std::array<int, 3> signs{};
    for (std::size_t i = 0; i < 3; ++i) {
        if (!isPlainSize(shape.leadingSize[i]) || !(std::abs(shape.leading[i]) > kCertain * shape.leadingSize[i]))
            return cell::isLeadingZero(scalars, static_cast<int>(i)); // then none at any isovalue, as below
        signs[i] = signOf(shape.leading[i]);
    }
    if (signs[0] * signs[1] * signs[2] > 0)
        return true; // see excludesTunnel() in trilinear_cell.cpp
    if (!isPlainSize(shape.leadingSize[0] * shape.leadingSize[1] * shape.leadingSize[2]))
        return false;
    const std::array<double, 3> mixed = shape.mixed(signs);
    const double relative = shape.mixedError(kUnit);
    unsigned onFaces = 0;
    for (const double side : {1.0, -1.0}) {
        bool isOutside = false, isInside = true;
        unsigned on = 0;
        for (std::size_t i = 0; i < 3; ++i) {
            const auto [low, high] = std::minmax(shape.rate[i][0], shape.rate[i][1]);
            const double here = side * mixed[i];
            const double margin = std::abs(here) * 2.0 * relative + 1e-14 * (std::abs(here) + shape.rateSize[i]);
            isOutside = isOutside || here < low - margin || here > high + margin;
            isInside = isInside && here > low + margin && here < high - margin;
            for (std::size_t end = 0; end < 2; ++end)
                on |= (std::abs(here - shape.rate[i][end]) <= margin ? 1u : 0u) << (2 * i + end);
        }
        if (isOutside)
            continue;
        if (std::has_single_bit(on) && (on & flatFaces_ & ~onFaces) != 0) { // see findFlatFace()
            onFaces |= on;
            continue;
        }
        if (!isInside)
            return false;
        const Shape<long double> fine(scalars);
        std::array<long double, 3> at = fine.mixed(signs);
        for (long double& each : at)
            each *= side;
        BodySaddle saddle;
        saddle.isovalue = valueAt(scalars, fine, at);
        if (std::isnan(saddle.isovalue))
            return false;
        // Of three mixed derivatives the product is that of the principal curvatures, which add up to none.
        saddle.isOfAbove = at[0] * at[1] * at[2] > 0.0L;
        const double turn = saddle.isOfAbove ? 1.0 : -1.0;
        const unsigned start =
            (turn * static_cast<double>(at[1]) < 0.0 ? 1u : 0u) | (turn * static_cast<double>(at[0]) < 0.0 ? 2u : 0u);
        // The tunnel passes along a diagonal. Where the corner at an end of it is on the other side, its neighbours are
        // joined around it, and the tunnel leads to them.
        for (std::size_t end = 0; end < 2; ++end) {
            const unsigned corner = end == 0 ? start : 7u - start;
            const bool isThere =
                saddle.isOfAbove ? scalars[corner] >= saddle.isovalue : scalars[corner] <= saddle.isovalue;
            saddle.corners[end] = static_cast<std::uint8_t>(isThere ? corner : corner ^ 1u);
        }
        inner_[innerCount_++] = saddle;
    }
    return true;
}

} // namespace isoslider::topology
