#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "core/cell/trilinear_cell.h"

namespace isoslider::topology {

/// A critical point of the interpolant inside a cell. The surface's Euler number changes by 2 there.
struct BodySaddle {
    double isovalue = 0.0; ///< the last double up to its value
    bool isOfAbove = false; ///< up to it a tunnel joins what is above; else beyond it one joins what is below
    std::array<std::uint8_t, 2> corners{}; ///< that are joined
    std::int8_t face = -1; ///< that it lies on: then what it joins is joined across the face, and it only counts

    /// Where the isovalue rises beyond it a tube is parted in two, or two sheets become a tube.
    int euler() const { return isOfAbove ? 2 : -2; }
};

/// What a cell adds to the changes of the Euler number between the scalars of its corners, by derivatives instead of
/// states: at the saddle of a face by that along the normal, inside by critical points. In plain arithmetic with bounds
/// on its error: some ten times faster than CellHistory, which decides where the bounds leave something open.
///
/// Equal scalars count as ascending with the place of their corners. No isovalue lies between them, so what is counted
/// at one isovalue is what any other order would count there.
class CellSaddles {
public:
    /// `faces`, `mayHaveInner`: as in the cell's code (cell_codes.h). False where rounding leaves anything open;
    /// nothing is known then. REQUIRES: all finite.
    bool find(const cell::CornerScalars& scalars, unsigned faces, bool mayHaveInner);

    /// Discs less tubes of the cell, when the isovalue rises beyond the saddle of one of `faces`: 1 or -1.
    int eulerAtFace(int face) const { return euler_[static_cast<std::size_t>(face)]; }
    std::span<const BodySaddle> inner() const { return {inner_.data(), innerCount_}; }

private:
    bool findFace(const cell::CornerScalars& scalars, std::size_t face);
    bool findFlatFace(const cell::CornerScalars& scalars, std::size_t face);
    bool findInner(const cell::CornerScalars& scalars);
    bool findOnlyInner(const cell::CornerScalars& scalars);
    /// `mixed`: along each axis the mixed derivative of the two others.
    void addInner(const cell::CornerScalars& scalars, BodySaddle saddle, const std::array<double, 3>& mixed);

    std::array<std::int8_t, 6> euler_{};
    bool isMoved_ = false; ///< a critical point lies on a face
    std::array<BodySaddle, 2> inner_{};
    std::size_t innerCount_ = 0;
};

} // namespace isoslider::topology
