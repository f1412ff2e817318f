#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/grid/scalar_grid.h"
#include "tests/support/cell_cases.h"

namespace isoslider::test {

/// A small grid for tests of topology: as the product takes it, and as plain numbers for the oracle.
struct TopologyGrid {
    std::shared_ptr<const ScalarGrid> grid;
    std::vector<double> scalars; ///< x fastest
    std::array<std::int64_t, 3> dims{};
    std::string description;

    CellScalars cell(std::int64_t x, std::int64_t y, std::int64_t z) const;
    double min() const;
    double max() const;
};

enum class GridKind {
    Open, ///< integers in [-127, 127]
    TinyIntegers, ///< [-2, 2]: nearly everything is tied
    SmallIntegers,
    Closed, ///< the box is below
    Saddles, ///< scarce strong points among weak ones: tunnels, many of them
    Checkerboard, ///< alternating signs, any strength: all faces ambiguous
    PlusMinusOne, ///< a checkerboard of two values, here and there disturbed
    Plane, ///< linear in the place, or constant in layers
    NearTies, ///< products of linear functions, some scalars moved by an ulp
    Doubles,
    Extreme, ///< denormals, or FLT_MAX and DBL_MAX beside tiny ones
};
inline constexpr int kGridKinds = 11;
const char* gridKindName(GridKind kind);

/// A grid of given scalars, of a type that holds them exactly: i8, i16, f32 or f64.
TopologyGrid makeTopologyGrid(std::vector<double> scalars, const std::array<std::int64_t, 3>& dims,
                              std::string description);

/// `shortest` to `longest` points along each axis.
TopologyGrid randomTopologyGrid(GridKind kind, std::int64_t shortest, std::int64_t longest, Random& random);

/// To go to: an integer, a scalar or its neighbour, a face's or body's saddle value, exactly as rounded, a
/// little beside, or half way to the next; sometimes anything between the extremes or outside. Finite.
double topologyIsovalue(const TopologyGrid& grid, Random& random);

} // namespace isoslider::test
