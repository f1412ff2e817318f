#include "core/extract/pieces/kept_pieces.h"

#include <algorithm>
#include <limits>
#include <vector>

#include "core/base/disjoint_sets.h"

namespace isoslider::extract {
namespace {

constexpr std::uint32_t kGone = std::numeric_limits<std::uint32_t>::max();

/// The vertices that triangles connect.
DisjointSets<> connectedVertices(const SurfaceMesh& mesh) {
    DisjointSets<> connected(mesh.positions.size());
    for (std::size_t i = 0; i < mesh.triangles.size(); i += 3) {
        connected.unite(mesh.triangles[i], mesh.triangles[i + 1]);
        connected.unite(mesh.triangles[i], mesh.triangles[i + 2]);
    }
    return connected;
}

EdgeId edgeOf(const Piece& piece, const GridDims& dims) {
    return 4 * static_cast<EdgeId>(piece.edgeStart[0] +
                                   dims[0] * (piece.edgeStart[1] + dims[1] * std::int64_t{piece.edgeStart[2]})) +
           static_cast<EdgeId>(piece.edgeAxis);
}

} // namespace

Result<SurfaceMesh> keepPieces(const SurfaceMesh& mesh, std::span<const Piece> kept, const JobControl& job) {
    DisjointSets<> connected = connectedVertices(mesh);
    if (job.isStopRequested())
        return cancelledError();
    std::vector<bool> isKept(mesh.positions.size(), false);
    for (const Piece& piece : kept) {
        const auto [first, last] =
            std::equal_range(mesh.edgeIds.begin(), mesh.edgeIds.end(), edgeOf(piece, mesh.geometry.dims));
        if (first == last)
            return makeError(ErrorCode::InvalidArgument, "the surface has changed since its pieces were found");
        for (auto edge = first; edge != last; ++edge)
            isKept[connected.rootOf(static_cast<std::uint32_t>(edge - mesh.edgeIds.begin()))] = true;
    }
    SurfaceMesh result;
    result.geometry = mesh.geometry;
    result.isovalue = mesh.isovalue;
    result.mergeBound = mesh.mergeBound;
    std::vector<std::uint32_t> numbers(mesh.positions.size(), kGone);
    for (std::uint32_t vertex = 0; vertex < numbers.size(); ++vertex) {
        if (!isKept[connected.rootOf(vertex)])
            continue;
        numbers[vertex] = static_cast<std::uint32_t>(result.positions.size());
        result.positions.push_back(mesh.positions[vertex]);
        result.normals.push_back(mesh.normals[vertex]);
        if (vertex < mesh.edgeIds.size())
            result.edgeIds.push_back(mesh.edgeIds[vertex]);
    }
    if (job.isStopRequested())
        return cancelledError();
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
        if (numbers[mesh.triangles[i]] != kGone)
            result.triangles.push_back(numbers[mesh.triangles[i]]);
    return result;
}

} // namespace isoslider::extract
