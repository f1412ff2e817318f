#pragma once

#include <cstdint>
#include <filesystem>

#include "core/base/result.h"
#include "core/extract/surface_mesh.h"

namespace isoslider::mesh {

/// What OpenMesh says of a triangle mesh. Counts are over the mesh as given, before any repair.
struct MeshReport {
    bool isManifold = false; ///< every edge has one or two triangles, every vertex one fan
    bool isClosed = false;   ///< no boundary edge
    bool isOriented = false; ///< neighbouring triangles agree on their common edge's direction
    std::uint64_t vertices = 0;
    std::uint64_t edges = 0;
    std::uint64_t triangles = 0;
    std::uint64_t components = 0;
    std::int64_t euler = 0;
    std::uint64_t boundaryLoops = 0;
    std::int64_t genus = 0; ///< summed over components: (2 * components - loops - euler) / 2
    std::uint64_t degenerateTriangles = 0; ///< zero area or a repeated vertex
    std::uint64_t duplicateTriangles = 0;
    double area = 0.0;           ///< world units squared
    double enclosedVolume = 0.0; ///< world units cubed, signed; meaningful when closed
};

/// Checks a surface in world space.
MeshReport checkMesh(const extract::SurfaceMesh& mesh);
/// Reads a mesh file (ply, obj, stl, off, om) and checks it.
/// Errors: NotFound, IoError, InvalidArgument (not a mesh, or an unknown suffix).
Result<MeshReport> checkMeshFile(const std::filesystem::path& path);

} // namespace isoslider::mesh
