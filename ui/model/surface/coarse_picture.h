#pragma once

#include "core/extract/surface_frame.h"

namespace isoslider::model {

/// Merges the vertices of `frame` in blocks of `blockCells` cells along each axis into one at their mean, and drops
/// the triangles that leaves without area; those changed stay changed. What was two sheets within a block may become
/// one. O(vertices + triangles). REQUIRES: blockCells is a multiple of frame.mergedCells.
void mergeVertices(extract::SurfaceFrame& frame, std::int64_t blockCells);

/// Makes the picture take at most `limitBytes`, by the smallest blocks of 2, 4, 8 ... cells that do; if none do, the
/// volume is one block, and what is left is next to nothing.
void fitPicture(extract::SurfaceFrame& frame, std::uint64_t limitBytes);

} // namespace isoslider::model
