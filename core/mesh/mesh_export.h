#pragma once

#include <filesystem>

#include "core/base/result.h"
#include "core/extract/surface_mesh.h"

namespace isoslider::mesh {

/// Suffixes that can be written, with the dot: .ply .obj .stl .off .om
bool isExportSuffix(const std::filesystem::path& path);

/// Writes a surface in world space (spacing, origin, direction applied; triangles counter-clockwise
/// seen from below the isovalue, also for left-handed grids), with normals where the format has
/// them. Vertices that no triangle uses are left out. Published by rename: on failure there is no
/// partial file and an earlier one is untouched.
/// Errors: InvalidArgument (unknown suffix), IoError, OutOfSpace.
Status exportMesh(const extract::SurfaceMesh& mesh, const std::filesystem::path& path);

} // namespace isoslider::mesh
