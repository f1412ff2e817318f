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

// Exactly, of short integers; elsewhere false.
bool isWithoutThird(const CornerScalars& v) {
    return v[7] - v[6] - v[5] + v[4] == v[3] - v[2] - v[1] + v[0] && std::all_of(v.begin(), v.end(), isShortInteger);
}

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

// ---- corners that are moved
//
// Where a critical point lies on a face, corners are moved by as little as one likes, those of equal scalars apart in
// the order of their places. Off the isovalue of that point nothing depends on it; the face's saddle and the point, if
// it comes to lie inside, then change the surface one after the other, at what remains one isovalue. A number is
// followed by how it changes. Exact where scalars are short integers.

template <class Number>
struct Moved {
    Number value{}, move{};
    friend Moved operator+(const Moved& a, const Moved& b) { return {a.value + b.value, a.move + b.move}; }
    friend Moved operator-(const Moved& a, const Moved& b) { return {a.value - b.value, a.move - b.move}; }
    friend Moved operator*(const Moved& a, const Moved& b) {
        return {a.value * b.value, a.value * b.move + a.move * b.value};
    }
};

template <class Number>
Moved<Number> movedCorner(const CornerScalars& scalars, std::size_t corner) {
    // Ascending, and with no relation between them that cells would have.
    constexpr std::array<int, 8> kMoves{0, 7, 31, 57, 131, 208, 353, 499};
    return {static_cast<Number>(scalars[corner]), static_cast<Number>(kMoves[corner])};
}

enum class Known { No, Yes, Nothing };
using WideInteger = __int128; // NOLINT: an extension that GCC and Clang share

// Whether a critical point on faces `on` lies inside of all of them when corners are moved. In the words of Shape, it
// is on a face where its mixed derivative, whose square is - l_j l_k / l_i, is the face's rate.
Known isInsideWhenMoved(const CornerScalars& scalars, unsigned on) {
    if (!std::all_of(scalars.begin(), scalars.end(), isShortInteger))
        return Known::Nothing;
    using Slices = cell::CellPolynomials<double>;
    using Number = Moved<WideInteger>;
    const auto at = [&](std::size_t axis, std::size_t end, int k) {
        return movedCorner<WideInteger>(scalars, static_cast<std::size_t>(Slices::kSlice[axis][k]) + (end << axis));
    };
    std::array<Number, 3> leading;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto slope = [&](int k) { return at(axis, 1, k) - at(axis, 0, k); };
        leading[axis] = slope(0) * slope(3) - slope(1) * slope(2);
    }
    const auto rate = [&](std::size_t axis, std::size_t end) {
        return at(axis, end, 0) + at(axis, end, 3) - at(axis, end, 1) - at(axis, end, 2);
    };
    for (; on != 0; on &= on - 1) {
        const auto face = static_cast<std::size_t>(std::countr_zero(on));
        const std::size_t axis = face / 2, end = face % 2;
        const Number own = rate(axis, end), other = rate(axis, 1 - end);
        const Number difference = leading[axis] * own * own + leading[(axis + 1) % 3] * leading[(axis + 2) % 3];
        if (difference.value != 0 || difference.move == 0 || own.value == 0 || own.value == other.value)
            return Known::Nothing;
        const bool isFarther = (difference.move > 0) != (leading[axis].value > 0); // from zero than the rate
        const bool isBeyond = isFarther == (own.value > 0); // greater than the rate
        const bool isLow = own.value < other.value;
        if (isBeyond != isLow)
            return Known::No;
    }
    return Known::Yes;
}

// The value at a critical point on faces: that of the only face's saddle, or of a corner, where an edge between two
// faces is level.
double valueOnFaces(const CornerScalars& scalars, const Shape<long double>& shape,
                    const std::array<long double, 3>& mixed, unsigned on) {
    if (std::has_single_bit(on)) {
        const auto& c = cell::kFaceCorners[static_cast<std::size_t>(std::countr_zero(on))];
        for (std::size_t up = 0; up < 2; ++up) {
            const double a = scalars[c[up]], b = scalars[c[up + 1]], e = scalars[c[up + 2]],
                         d = scalars[c[(up + 3) % 4]];
            if (std::min(a, e) > std::max(b, d))
                return cell::lastJoined(a, b, e, d);
        }
        return std::numeric_limits<double>::quiet_NaN();
    }
    std::size_t corner = 0;
    for (std::size_t i = 0; i < 3; ++i)
        corner |=
            (mixed[i] - shape.rate[i][0]) / (shape.rate[i][1] - shape.rate[i][0]) > 0.5L ? std::size_t{1} << i : 0;
    return scalars[corner];
}

} // namespace

bool CellSaddles::find(const CornerScalars& scalars, unsigned faces, bool mayHaveInner) {
    innerCount_ = 0;
    isMoved_ = false;
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
        return sum == 0.0 && std::all_of(scalars.begin(), scalars.end(), isShortInteger) && findFlatFace(scalars, face);
    euler_[face] = sum > 0.0 ? -1 : 1;
    return true;
}

// The derivative is zero: a critical point of the cell lies on the face. Corners are moved.
bool CellSaddles::findFlatFace(const CornerScalars& scalars, std::size_t face) {
    const auto& corners = cell::kFaceCorners[face];
    std::array<Moved<double>, 4> at, inwards;
    for (std::size_t i = 0; i < 4; ++i) {
        at[i] = movedCorner<double>(scalars, corners[i]);
        inwards[i] = movedCorner<double>(scalars, corners[i] ^ 1u << face / 2) - at[i];
    }
    const auto ab = at[0] - at[1], ad = at[0] - at[3], cb = at[2] - at[1], cd = at[2] - at[3];
    const auto sum = cb * cd * inwards[0] + ad * cd * inwards[1] + ad * ab * inwards[2] + cb * ab * inwards[3];
    if (sum.move == 0.0)
        return false;
    euler_[face] = sum.move > 0.0 ? -1 : 1;
    isMoved_ = true;
    return true;
}

bool CellSaddles::findInner(const CornerScalars& scalars) {
    constexpr double kCertain = 1e-12, kUnit = std::numeric_limits<double>::epsilon();
    const Shape<double> shape(scalars);
    std::array<int, 3> signs{};
    int zeros = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        signs[i] = signOf(shape.leading[i]);
        if (isPlainSize(shape.leadingSize[i]) && std::abs(shape.leading[i]) > kCertain * shape.leadingSize[i])
            continue;
        if (!cell::isLeadingZero(scalars, static_cast<int>(i)))
            return false;
        ++zeros;
    }
    // With a zero among them no isovalue has a tunnel, see excludesTunnel() in trilinear_cell.cpp. Where corners are
    // moved a critical point comes from far away; where there are two zeros it may come into the cell.
    if (zeros > 0)
        return zeros == 1 || !isMoved_;
    if (signs[0] * signs[1] * signs[2] > 0)
        return true; // nor is there a tunnel here
    if (!isPlainSize(shape.leadingSize[0] * shape.leadingSize[1] * shape.leadingSize[2]))
        return false;
    if (isWithoutThird(scalars))
        return findOnlyInner(scalars);
    const std::array<double, 3> mixed = shape.mixed(signs);
    const double relative = shape.mixedError(kUnit);
    for (const double side : {1.0, -1.0}) {
        bool isOutside = false;
        unsigned on = 0; // bit f: it lies on face f, or as near as makes no difference here
        for (std::size_t i = 0; i < 3; ++i) {
            const auto [low, high] = std::minmax(shape.rate[i][0], shape.rate[i][1]);
            const double here = side * mixed[i];
            const double margin = std::abs(here) * 2.0 * relative + 1e-14 * (std::abs(here) + shape.rateSize[i]);
            isOutside = isOutside || here < low - margin || here > high + margin;
            for (std::size_t end = 0; end < 2; ++end)
                on |= (std::abs(here - shape.rate[i][end]) <= margin ? 1u : 0u) << (2 * i + end);
        }
        if (isOutside)
            continue;
        if (on != 0) {
            const Known isMovedInside = isInsideWhenMoved(scalars, on);
            if (isMovedInside == Known::Nothing)
                return false;
            if (isMovedInside == Known::No)
                continue;
        }
        const Shape<long double> fine(scalars);
        std::array<long double, 3> at = fine.mixed(signs);
        for (long double& each : at)
            each *= side;
        BodySaddle saddle;
        saddle.face = static_cast<std::int8_t>(on != 0 ? std::countr_zero(on) : -1);
        saddle.isovalue = on == 0 ? valueAt(scalars, fine, at) : valueOnFaces(scalars, fine, at, on);
        if (std::isnan(saddle.isovalue))
            return false;
        addInner(scalars, saddle, {static_cast<double>(at[0]), static_cast<double>(at[1]), static_cast<double>(at[2])});
    }
    return true;
}

// No term in xyz: mixed derivatives are the same everywhere, and the gradient vanishes at one point. All is exact but
// for the last divisions. REQUIRES: no leading coefficient is zero; isWithoutThird().
bool CellSaddles::findOnlyInner(const CornerScalars& v) {
    const std::array<double, 3> slope{v[1] - v[0], v[2] - v[0], v[4] - v[0]};
    const std::array<double, 3> mixed{v[6] - v[4] - slope[1], v[5] - v[4] - slope[0], v[3] - v[2] - slope[0]};
    std::array<double, 3> part, whole; // its place along an axis
    for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
        part[i] = mixed[i] * slope[i] - mixed[j] * slope[j] - mixed[k] * slope[k];
        whole[i] = 2.0 * mixed[j] * mixed[k];
        if (whole[i] < 0.0) {
            whole[i] = -whole[i];
            part[i] = -part[i];
        }
    }
    bool isOn = false;
    for (std::size_t i = 0; i < 3; ++i) {
        if (part[i] < 0.0 || part[i] > whole[i])
            return true;
        isOn = isOn || part[i] == 0.0 || part[i] == whole[i];
    }
    if (isOn)
        return false;
    // At the point of a quadratic function where its gradient vanishes its linear terms are twice what they were.
    constexpr long double kUnit = std::numeric_limits<long double>::epsilon();
    long double rest = 0.0L, size = std::abs(static_cast<long double>(v[0]));
    for (std::size_t i = 0; i < 3; ++i) {
        const long double term =
            static_cast<long double>(slope[i]) * (static_cast<long double>(part[i]) / whole[i]) / 2;
        rest += term;
        size += std::abs(term);
    }
    const long double value = static_cast<long double>(v[0]) + rest, bound = 4 * kUnit * size;
    BodySaddle saddle;
    saddle.isovalue = floorOf(value - bound) + 0.0; // no -0
    if (floorOf(value + bound) != saddle.isovalue)
        return false;
    addInner(v, saddle, mixed);
    return true;
}

void CellSaddles::addInner(const CornerScalars& scalars, BodySaddle saddle, const std::array<double, 3>& mixed) {
    // Of three mixed derivatives the product is that of the principal curvatures, which add up to none.
    saddle.isOfAbove = (mixed[0] > 0.0) == ((mixed[1] > 0.0) == (mixed[2] > 0.0));
    const double turn = saddle.isOfAbove ? 1.0 : -1.0;
    const unsigned start = (turn * mixed[1] < 0.0 ? 1u : 0u) | (turn * mixed[0] < 0.0 ? 2u : 0u);
    // The tunnel passes along a diagonal. Where the corner at an end of it is on the other side, its neighbours are
    // joined around it, and the tunnel leads to them.
    for (std::size_t end = 0; end < 2; ++end) {
        const unsigned corner = end == 0 ? start : 7u - start;
        const bool isThere = saddle.isOfAbove ? scalars[corner] >= saddle.isovalue : scalars[corner] <= saddle.isovalue;
        saddle.corners[end] = static_cast<std::uint8_t>(isThere ? corner : corner ^ 1u);
    }
    inner_[innerCount_++] = saddle;
}

} // namespace isoslider::topology
