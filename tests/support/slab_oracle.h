#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>

namespace isoslider::test {

// What the isosurface of the trilinear interpolant is, found with no case table and no code of core/cell.
//
// A cell is swept in slices across one axis. A slice is bilinear, so its regions above and below are known
// from its four corners' signs and, where these are ambiguous, from the sign of A C - B D. Both change at
// finitely many slices only: where a corner of the slice is zero, or A C - B D, a quadratic in the slice's
// place. Between them nothing happens, and regions of neighbouring slabs are one where they share a corner.
//
// Exact for all finite doubles, at the limit from below: scalars are (scalar - isovalue) + e on an integer
// lattice, and every question is the sign of a polynomial in e for e > 0 as small as need be.

/// One cell. Corner i at (i & 1, i >> 1 & 1, i >> 2 & 1); faces x0 x1 y0 y1 z0 z1.
struct CellTopology {
    std::uint8_t signs = 0; ///< bit i: corner i is above
    std::uint8_t ambiguousFaces = 0;
    std::uint8_t joinedFaces = 0; ///< bit f: ambiguous, and its above corners are joined
    int loops = 0; ///< of the surface on the faces
    int components = 0; ///< of the surface inside
    int euler = 0; ///< counted slice by slice, not from loops and components
    int aboveRegions = 0;
    int belowRegions = 0;
    int aboveJoinsInside = 0; ///< regions above that the faces alone leave apart
    int belowJoinsInside = 0;
    std::array<std::uint8_t, 8> region{}; ///< of each corner: 0.. above first, then below

    bool operator==(const CellTopology&) const = default;
};

/// `axis` is the one swept along; the answer does not depend on it. REQUIRES: all finite.
CellTopology sweepCell(const std::array<double, 8>& scalars, double isovalue, int axis = 2);

/// Empty, or what is wrong with the oracle's own answer: axes that disagree, an Euler number that is not
/// 2 components - loops, region counts that do not fit. REQUIRES: all finite.
std::string oracleFault(const std::array<double, 8>& scalars, double isovalue);

/// A whole grid, its surface open at the box.
struct GridTopology {
    std::int64_t components = 0;
    std::int64_t euler = 0;
    std::int64_t loops = 0; ///< on the box
    std::int64_t activeEdges = 0;
    std::int64_t tunnels = 0; ///< cells with a join inside

    bool operator==(const GridTopology&) const = default;
};

/// Scalars x fastest. REQUIRES: all finite, dims at least 1.
GridTopology sweepGrid(std::span<const double> scalars, const std::array<std::int64_t, 3>& dims, double isovalue,
                       int axis = 2);

std::string toString(const CellTopology& topology);
std::string toString(const GridTopology& topology);

} // namespace isoslider::test
