#pragma once

#include <cstddef>

#include "core/base/job_control.h"
#include "core/extract/surface_frame.h"

namespace isoslider::extract {

/// Of one piece, in the unit of length of the volume's world.
struct PieceMeasures {
    double area = 0.0;
    /// That it encloses: below 0 where the lower values are inside, as of a bubble. Meaningful where it is closed.
    double volume = 0.0;
    bool isClosed = false; ///< it ends nowhere: neither at the volume's box nor beside missing values

    bool operator==(const PieceMeasures&) const = default;
};

/// Of the frame's piece in that place of its pieces. REQUIRES: the frame has such a piece.
/// O(triangles of the bricks that it is in); of arrays O(triangles). Errors: Cancelled.
Result<PieceMeasures> measurePiece(const SurfaceFrame& frame, std::size_t piece, const JobControl& job = {});

} // namespace isoslider::extract
