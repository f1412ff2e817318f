#pragma once

#include <cstdint>
#include <filesystem>

#include "core/base/result.h"
#include "core/extract/surface_mesh.h"
#include "core/mesh/certificate.h"

namespace isoslider::mesh {

/// Suffixes that can be written, with the dot: .ply .obj .stl .off .om
bool isExportSuffix(const std::filesystem::path& path);

/// Refuses what formats cannot number: beyond 2^31 - 1 vertices (PLY) or 2^32 - 1 triangles (STL).
/// Errors: InvalidArgument. `path` is only for the message.
Status checkExportSize(std::uint64_t vertices, std::uint64_t triangles, const std::filesystem::path& path);

/// Writes a surface in world space (spacing, origin, direction applied; triangles counter-clockwise
/// seen from below the isovalue, also for left-handed grids), with normals where the format has
/// them. Vertices that no triangle uses are left out. Positions are float where that keeps vertices
/// apart, else double; STL has floats only, and is refused where these would not, thousands of cells from
/// the origin. The mesh's certificate goes along: as comments at the head of PLY and OBJ and at the end
/// of OFF, in short as the header of STL; OM has no room for one. A mesh that is not valid is written
/// all the same, and its certificate reports it. Published by rename: on failure there is no partial file
/// and an earlier one is untouched.
/// Errors: InvalidArgument (unknown suffix, too large, too far for STL), IoError, OutOfSpace, Cancelled (within a
/// second).
Status exportMesh(const extract::SurfaceMesh& mesh, const Certificate& certificate, const std::filesystem::path& path,
                  const JobControl& job = {});

} // namespace isoslider::mesh
