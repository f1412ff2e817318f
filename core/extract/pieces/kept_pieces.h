#pragma once

#include <span>

#include "core/base/job_control.h"
#include "core/extract/pieces/surface_pieces.h"
#include "core/extract/surface_mesh.h"

namespace isoslider::extract {

/// The mesh without all but some pieces, vertices and triangles in the order they had. `kept`: pieces of a picture of
/// the same surface. Where cells only touch beside missing values, what has a vertex on the same edge may be kept, too.
/// O(vertices + triangles). Errors: Cancelled; InvalidArgument: the mesh has no vertex on the edge of such a piece, so
/// it is of another surface.
Result<SurfaceMesh> keepPieces(const SurfaceMesh& mesh, std::span<const Piece> kept, const JobControl& job = {});

} // namespace isoslider::extract
