#pragma once

#include <array>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

namespace isoslider::test {

using Random = std::mt19937_64;

/// Scalars of a cell, corner i at (i & 1, i >> 1 & 1, i >> 2 & 1).
using CellScalars = std::array<double, 8>;

inline std::int64_t pickInt(Random& random, std::int64_t low, std::int64_t high) {
    return std::uniform_int_distribution<std::int64_t>(low, high)(random);
}
inline double pickUnit(Random& random) { return std::uniform_real_distribution<double>(0.0, 1.0)(random); }

/// Corner i of the turned cell is corner symmetry[i] of the cell. The cube's 48, the identity first.
const std::vector<std::array<std::uint8_t, 8>>& cubeSymmetries();

/// One of 96: the cube's symmetries, then the same with above and below swapped.
CellScalars turned(const CellScalars& scalars, int symmetry);

enum class CellKind {
    Uniform, ///< doubles
    TinyIntegers, ///< -2 to 2: most questions are ties
    SmallIntegers,
    Saddle, ///< alternating signs and magnitudes from a wide range: ambiguous faces, tunnels
    Decades, ///< the same, magnitudes from 1 to 1e35
    Plane, ///< linear, small integers: no xyz term, often no mixed term at all
    NearPlane, ///< the same, a few scalars moved by an ulp or so
    Degenerate, ///< few distinct values, products of linear functions
    BodyTies, ///< a critical point inside, with value 0 exactly: its tunnel is born there
    PowersOfTwo, ///< of far apart exponents: ties of products that no machine integer holds
    Scaled, ///< small integers times a power of two whose square under- or overflows
    SignedZeros,
    Denormal,
    HugeFloats, ///< FLT_MAX and other floats, exact sums far from doubles
    HugeDoubles, ///< DBL_MAX, the least denormal and between: exact polynomials of thousands of bits
};
inline constexpr int kCellKinds = 15;
const char* cellKindName(CellKind kind);
CellScalars randomCell(CellKind kind, Random& random);

/// Zero, a scalar, a neighbour of a scalar, a face's saddle value (rounded), or between two scalars.
double randomIsovalue(const CellScalars& scalars, Random& random);

/// Values of the interpolant at its critical points inside the cell, rounded.
std::vector<double> bodySaddleValues(const CellScalars& scalars);
/// Values at the saddles of the faces, rounded: those between the scalars of each face.
std::vector<double> faceSaddleValues(const CellScalars& scalars);

/// To paste into a test.
std::string toString(const CellScalars& scalars, double isovalue);

} // namespace isoslider::test
