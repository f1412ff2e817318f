#pragma once

#include <array>
#include <cstdint>

#include "core/cell/cell_numbering.h"

namespace isoslider::cell {

// Decisions inside one cell, by the trilinear interpolant f of its eight corner scalars.
//
// Everything is asked at the limit from below: for all isovalues that are a little smaller than the
// given one. There no corner and no saddle lies on the surface, so each question has one answer, and
// it is the sign of a polynomial in (scalar - isovalue), or, where that is zero, of its derivative.
// Signs are exact: floating point with a bound on its error first, integers of any size when the bound
// is larger than the value. So neighbours always agree, and no sample value is special.
//
// Faces. On an ambiguous face with above corners A, C and below corners B, D the bilinear interpolant
// has its saddle at (AC - BD) / (A + C - B - D); the two above corners are joined when the isovalue is
// not greater (asymptotic decider, Nielson and Hamann 1991).
//
// Interior. Slices of f across an axis have corners that are linear in the slice's place t; AC - BD is
// a quadratic q(t) = a t^2 + b t + c, and its roots are the slices whose level lines cross. The surface
// contains axis-parallel lines there: six, which close to a hexagon. All three quadratics have the
// same discriminant, Cayley's hyperdeterminant D of the eight numbers, and D as a function of the
// isovalue is a quadratic too, whose roots are the values at f's two critical points (body saddles).
// The surface has a tunnel through the cell exactly when
//  1. all six roots lie inside (0, 1): then the hexagon is inside the cell; and
//  2. D has two real roots (one, when f has no xyz term): then the hexagon is the waist around a
//     critical point, else f is monotone across it and the surface spans it as a disc.
// Between the isovalue and that critical value the hexagon only shrinks, so no face changes and the
// tunnel is as it was born. It joins above corners when the isovalue is below the critical value
// (D decreasing), below corners when it is above.

/// How the surface passes through the inside of a cell.
enum class Tunnel : std::uint8_t {
    None, ///< every loop on the cell's faces bounds a disc
    Above, ///< two loops bound a tube around a passage between above corners
    Below, ///< the same between below corners
};

/// Corner scalars of a cell, exactly, in corner order. REQUIRES, below: all finite.
using CornerScalars = std::array<double, 8>;

/// The tunnel of a cell whose faces allow one (see mayHaveTunnel), and the main diagonal it winds
/// round: from corner `diagonal` (0 to 3) to the opposite one, 7 - diagonal. Exact.
struct TunnelDecision {
    Tunnel tunnel = Tunnel::None;
    std::uint8_t diagonal = 0;
};
TunnelDecision decideTunnel(const CornerScalars& scalars, double isovalue);

/// Whether the leading coefficient of the quadratic across `axis` is zero, which rules out tunnels at every isovalue.
/// Shown where one factor of each product is zero and where scalars are integers of up to 25 bits, as samples of 8 and
/// 16 bits are; elsewhere false.
bool isLeadingZero(const CornerScalars& scalars, int axis);

/// Isovalues between which a cell with unchanged signs keeps its state: (below, above]. Cut short by the
/// error of the arithmetic, never too wide; empty when that error is all there is.
struct StateInterval {
    double below;
    double above;
    bool contains(double isovalue) const { return isovalue > below && isovalue <= above; }
};

/// State (see cell_states.h) of a cell with eight known corners, and how long it lasts.
struct ResolvedCell {
    std::uint16_t state = 0;
    StateInterval interval{};
};
/// Bit i of `signs`: corner i is above (scalar >= isovalue). 2 divisions and some products for an ambiguous face.
ResolvedCell resolveCell(std::uint8_t signs, const CornerScalars& scalars, double isovalue);

/// The greatest isovalue at which the above corners `a` and `c` of a face are joined, `b` and `d` below between them:
/// the double at or below the saddle. Exact. REQUIRES: the lesser of a and c is greater than the greater of b and d;
/// the result lies between those two.
double lastJoined(double a, double b, double c, double d);

/// The tunnel of a cell, and how long it lasts while neither signs nor joined faces change. `allowed`: mayHaveTunnel().
struct ResolvedTunnel {
    TunnelDecision decision;
    StateInterval interval{};
};
ResolvedTunnel resolveTunnel(const CornerScalars& scalars, unsigned allowed, double isovalue);

/// The six inner vertices of a tunnel: roots of the three quadratics, ascending along each axis, in cell
/// units. Kept apart and off the faces by at least `least`, so that no triangle vanishes.
struct TunnelWaist {
    std::array<double, 2> x, y, z;
};
TunnelWaist tunnelWaist(const CornerScalars& scalars, double isovalue, double least);

/// Gradient of the interpolant at a place in the cell, per cell.
std::array<double, 3> gradientInCell(const CornerScalars& scalars, double x, double y, double z);

} // namespace isoslider::cell
