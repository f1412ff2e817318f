#pragma once

#include <array>

namespace isoslider::cell {

/// The polynomials of trilinear_cell.h in g = scalar - isovalue at the eight corners, over any ring.
template <class Number>
struct CellPolynomials {
    std::array<Number, 8> g;

    // Corners of the slice across `axis` in the order (0,0) (1,0) (0,1) (1,1) of the other two axes.
    static constexpr int kSlice[3][4] = {{0, 2, 4, 6}, {0, 1, 4, 5}, {0, 1, 2, 3}};
    static constexpr int step(int axis) { return 1 << axis; }

    const Number& at(int axis, int side, int k) const {
        return g[static_cast<std::size_t>(kSlice[axis][k] + side * step(axis))];
    }
    Number slope(int axis, int k) const { return at(axis, 1, k) - at(axis, 0, k); }

    /// q at the cell's face: AC - BD.
    Number face(int axis, int side) const {
        return at(axis, side, 0) * at(axis, side, 3) - at(axis, side, 1) * at(axis, side, 2);
    }
    /// A + C - B - D: the rate at which face() falls with the isovalue.
    Number faceRate(int axis, int side) const {
        return at(axis, side, 0) + at(axis, side, 3) - at(axis, side, 1) - at(axis, side, 2);
    }
    /// q's leading coefficient a; does not depend on the isovalue.
    Number leading(int axis) const { return slope(axis, 0) * slope(axis, 3) - slope(axis, 1) * slope(axis, 2); }
    /// q's middle coefficient b.
    Number middle(int axis) const {
        return at(axis, 0, 0) * slope(axis, 3) + slope(axis, 0) * at(axis, 0, 3) - at(axis, 0, 1) * slope(axis, 2) -
               slope(axis, 1) * at(axis, 0, 2);
    }

    /// D = b^2 - 4ac as a function of the isovalue, about the present one: D(isovalue + h) =
    /// value + slope h + square^2 h^2.
    struct Discriminant {
        Number value, slope, square;
    };
    Discriminant discriminant() const {
        const Number a = leading(2), b = middle(2), c = face(2, 0);
        const Number rate0 = faceRate(2, 0), square = faceRate(2, 1) - rate0;
        const Number ac = a * c, bs = b * square, ar = a * rate0;
        return {b * b - (ac + ac + ac + ac), (ar + ar + ar + ar) - (bs + bs), square};
    }
};

} // namespace isoslider::cell
