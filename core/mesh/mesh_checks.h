#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/base/job_control.h"
#include "core/base/result.h"
#include "core/extract/surface_mesh.h"
#include "core/mesh/soup_topology.h"
#include "core/mesh/triangle_soup.h"

namespace isoslider::mesh {

/// Facts of a triangle mesh as given, before any repair.
///
/// Judged on the triangles as index triples, and confirmed by building an OpenMesh mesh: a mesh
/// that is manifold and oriented here but of which OpenMesh refuses a face is not called manifold.
/// A triangle that repeats a vertex is no face: it is counted, makes the mesh non-manifold, and
/// takes part in no other count. A vertex that no triangle uses is not counted.
struct MeshReport {
    bool isManifold = false; ///< every edge has one or two triangles, every vertex one fan
    bool isClosed = false; ///< no boundary edge
    bool isOriented = false; ///< neighbouring triangles agree on their common edge's direction
    std::uint64_t vertices = 0; ///< used by a triangle
    std::uint64_t edges = 0;
    std::uint64_t triangles = 0; ///< all, degenerate and duplicate ones included
    std::uint64_t components = 0; ///< connected through shared vertices
    std::int64_t euler = 0; ///< vertices - edges + triangles that repeat no vertex
    std::uint64_t boundaryLoops = 0; ///< two surfaces that touch in a point have a loop each
    /// Summed over components: (2 * components - loops - euler) / 2. Zero unless manifold and oriented.
    std::int64_t genus = 0;
    std::uint64_t degenerateTriangles = 0; ///< a repeated vertex, or an area of exactly zero
    std::uint64_t duplicateTriangles = 0; ///< beyond the first of the same three vertices, in any order
    double area = 0.0; ///< world units squared
    double enclosedVolume = 0.0; ///< world units cubed, signed; meaningful when closed
    std::uint64_t refusedByOpenMesh = 0; ///< triangles that OpenMesh's add_face did not take
    std::uint64_t nonManifoldEdges = 0; ///< with more than two triangles
    std::uint64_t nonManifoldVertices = 0; ///< with more than one fan
};

/// Checks a surface in world space. O(n log n); some seconds for ten million triangles.
MeshReport checkMesh(const extract::SurfaceMesh& mesh);
MeshReport checkSoup(const TriangleSoup& soup);
/// The same, and leaves the topology that it found in `topology`. Errors: Cancelled, within a second.
Result<MeshReport> checkSoup(const TriangleSoup& soup, SoupTopology& topology, const JobControl& job);

/// What makes a mesh unsound, each in a few words; empty for a sound one. Being open is no fault: a
/// surface ends where it meets the box.
std::vector<std::string> faultsOf(const MeshReport& report);

/// Reads a mesh file (ply, obj, stl, off, om) and checks it. Polygons are cut into triangles.
/// In STL, which stores every corner on its own, corners at exactly equal positions are one vertex.
/// Errors: NotFound, IoError, Corruption (the file ends early), InvalidArgument (not a mesh, an
/// index without a vertex, a position that is not finite, or an unknown suffix), Cancelled.
Result<MeshReport> checkMeshFile(const std::filesystem::path& path, const JobControl& job = {});

} // namespace isoslider::mesh
