#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/job_control.h"
#include "core/mesh/triangle_soup.h"

namespace isoslider::mesh {

/// An edge with exactly one triangle, in that triangle's direction.
struct BoundaryEdge {
    std::uint32_t begin = 0; ///< vertices
    std::uint32_t end = 0;
    std::uint32_t loop = 0; ///< below SoupTopology::boundaryLoops
};

/// Topology of triangles as index triples. Triangles that repeat an index take part in nothing.
struct SoupTopology {
    std::uint64_t usedVertices = 0;
    std::uint64_t edges = 0;
    std::uint64_t boundaryEdges = 0; ///< with exactly one triangle
    std::uint64_t crowdedEdges = 0; ///< with more than two triangles
    std::uint64_t disagreeingEdges = 0; ///< two triangles run along it in the same direction
    std::uint64_t verticesOfSeveralFans = 0;
    std::uint64_t components = 0; ///< connected through shared vertices
    std::uint64_t boundaryLoops = 0;
    std::uint64_t trianglesWithRepeats = 0;
    std::uint64_t duplicateTriangles = 0; ///< beyond the first of the same three vertices, in any order
    std::vector<BoundaryEdge> boundary; ///< all boundaryEdges of them

    bool isManifold() const { return crowdedEdges == 0 && verticesOfSeveralFans == 0 && trianglesWithRepeats == 0; }
};

/// O(n log n) in the number of triangles, by sorting the triangles' edges; several threads.
/// REQUIRES: every index < vertexCount. Errors: Cancelled.
Result<SoupTopology> analyseTopology(std::span<const Triangle> triangles, std::size_t vertexCount,
                                     const JobControl& job = {});

} // namespace isoslider::mesh
