#include "core/mesh/triangle_soup.h"

#include <algorithm>
#include <numeric>
#include <tuple>
#include <utility>

#include <glm/geometric.hpp>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>
#include <tbb/parallel_sort.h>

#include "core/grid/gradient.h"
#include "core/grid/world_normals.h"
#include "core/mesh/loop_control.h"

namespace isoslider::mesh {
namespace {

glm::dvec3 heldOffGridPoints(glm::dvec3 position, extract::EdgeId edge, const GridDims& dims) {
    const GridEdge place = gridEdge(edge, dims);
    const double start = static_cast<double>(place.lower[static_cast<std::size_t>(place.axis)]);
    double& along = position[place.axis];
    along = std::clamp(along, start + kLeastDistance, start + 1.0 - kLeastDistance);
    return position;
}

} // namespace

GridEdge gridEdge(extract::EdgeId edge, const GridDims& dims) {
    const auto point = static_cast<std::int64_t>(edge >> 2);
    return {{point % dims[0], point / dims[0] % dims[1], point / (dims[0] * dims[1])}, static_cast<int>(edge & 3)};
}

TriangleSoup worldSoup(const extract::SurfaceMesh& mesh) {
    TriangleSoup soup;
    const GridGeometry& geometry = mesh.geometry;
    const bool hasNormals = mesh.normals.size() == mesh.positions.size();
    soup.positions.resize(mesh.positions.size());
    soup.normals.resize(hasNormals ? mesh.positions.size() : 0);
    const glm::dmat3 normalMap = normalToWorld(geometry);
    const bool isOblique = !hasOrthogonalAxes(geometry);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, mesh.positions.size(), 4096), [&](const auto& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) {
            glm::dvec3 position(mesh.positions[i]);
            if (i < mesh.edgeIds.size())
                position = heldOffGridPoints(position, mesh.edgeIds[i], geometry.dims);
            soup.positions[i] = geometry.origin + geometry.direction * (geometry.spacing * position);
            if (hasNormals) {
                const glm::vec3 normal(normalMap * glm::dvec3(mesh.normals[i]));
                soup.normals[i] = isOblique ? normalizedOrZero(normal) : normal;
            }
        }
    });
    const bool flips = geometry.isLeftHanded();
    soup.triangles.resize(mesh.triangleCount());
    for (std::size_t i = 0; i < soup.triangles.size(); ++i) {
        soup.triangles[i] = {mesh.triangles[3 * i], mesh.triangles[3 * i + 1], mesh.triangles[3 * i + 2]};
        if (flips)
            std::swap(soup.triangles[i][1], soup.triangles[i][2]);
    }
    return soup;
}

Nudge nudgeOf(const extract::SurfaceMesh& mesh) {
    std::vector<std::uint8_t> isUsed(mesh.positions.size(), 0);
    for (const std::uint32_t vertex : mesh.triangles)
        isUsed[vertex] = 1;
    const auto farther = [](Nudge a, const Nudge& b) {
        a.vertices += b.vertices;
        a.largestCells = std::max(a.largestCells, b.largestCells);
        a.largestWorld = std::max(a.largestWorld, b.largestWorld);
        return a;
    };
    const auto nudgeOfRange = [&](const tbb::blocked_range<std::size_t>& range, Nudge nudge) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) {
            const glm::dvec3 from(mesh.positions[i]);
            const glm::dvec3 way = heldOffGridPoints(from, mesh.edgeIds[i], mesh.geometry.dims) - from;
            if (isUsed[i] && way != glm::dvec3(0.0))
                nudge = farther(nudge, {1, glm::length(way), glm::length(mesh.geometry.spacing * way)});
        }
        return nudge;
    };
    const std::size_t edgeVertices = std::min(mesh.edgeIds.size(), mesh.positions.size());
    return tbb::parallel_reduce(tbb::blocked_range<std::size_t>(0, edgeVertices, 4096), Nudge{}, nudgeOfRange, farther);
}

void dropUnusedVertices(TriangleSoup& soup) {
    constexpr std::uint32_t kUnused = ~std::uint32_t{0};
    std::vector<std::uint32_t> newIndex(soup.positions.size(), kUnused);
    for (const Triangle& triangle : soup.triangles)
        for (const std::uint32_t vertex : triangle)
            newIndex[vertex] = 0;
    std::uint32_t used = 0;
    for (std::size_t i = 0; i < newIndex.size(); ++i) {
        if (newIndex[i] == kUnused)
            continue;
        soup.positions[used] = soup.positions[i];
        if (!soup.normals.empty())
            soup.normals[used] = soup.normals[i];
        newIndex[i] = used++;
    }
    soup.positions.resize(used);
    if (!soup.normals.empty())
        soup.normals.resize(used);
    for (Triangle& triangle : soup.triangles)
        for (std::uint32_t& vertex : triangle)
            vertex = newIndex[vertex];
}

Status weldEqualPositions(TriangleSoup& soup, const JobControl& job) {
    const auto key = [&](std::uint32_t i) {
        const glm::dvec3& p = soup.positions[i];
        return std::tuple(p.x, p.y, p.z); // operator== and < of doubles already take -0 as +0
    };
    std::vector<std::uint32_t> order(soup.positions.size());
    std::iota(order.begin(), order.end(), 0u);
    runStoppable(job, [&] {
        tbb::parallel_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
            const auto keyA = key(a), keyB = key(b);
            return keyA < keyB || (keyA == keyB && a < b);
        });
    });
    if (job.isStopRequested())
        return cancelledError();
    std::vector<std::uint32_t> representative(order.size());
    LoopControl loop(job, order.size(), "welding");
    for (std::size_t i = 0; i < order.size(); ++i) {
        if (!loop.goesOn(i))
            return cancelledError();
        const bool isSame = i > 0 && key(order[i]) == key(order[i - 1]);
        representative[order[i]] = isSame ? representative[order[i - 1]] : order[i];
    }
    for (Triangle& triangle : soup.triangles)
        for (std::uint32_t& vertex : triangle)
            vertex = representative[vertex];
    dropUnusedVertices(soup);
    return {};
}

} // namespace isoslider::mesh
