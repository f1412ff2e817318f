#pragma once

#include <filesystem>

#include "core/base/job_control.h"
#include "core/base/result.h"
#include "core/mesh/triangle_soup.h"

namespace isoslider::mesh {

/// ".ply" and so on, in lower case; empty when it is none of .ply .obj .stl .off .om.
std::string meshSuffix(const std::filesystem::path& path);

/// Reads a mesh file as triangles, nothing repaired; polygons are cut into fans, normals are left
/// out. STL corners at exactly equal positions become one vertex. Errors: see checkMeshFile.
Result<TriangleSoup> readMeshFile(const std::filesystem::path& path, const JobControl& job = {});

} // namespace isoslider::mesh
