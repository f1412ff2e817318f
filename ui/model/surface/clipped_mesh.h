#pragma once

#include "core/base/job_control.h"
#include "core/extract/surface_mesh.h"
#include "ui/model/surface/clipping.h"

namespace isoslider::model {

/// Whether a mesh of what is in the crop box ends there or is closed, see extract::cropMesh().
enum class CropSides { Open, Closed };

/// What of a volume's whole surface the clipping leaves. Closed: all in the crop box, whatever the clip planes leave of
/// it. Errors: Cancelled; those of extract::cropMesh() where it is to be closed.
Result<extract::SurfaceMesh> clippedMesh(extract::SurfaceMesh mesh, const Clipping& clipping, CropSides sides,
                                         const JobControl& job = {});
/// Whether that ends where nothing of the volume does: then it cannot be checked as a surface of the volume is.
bool cutsTriangles(const extract::SurfaceMesh& mesh, const Clipping& clipping, CropSides sides);

} // namespace isoslider::model
