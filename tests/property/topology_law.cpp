#include "tests/property/topology_law.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "core/extract/full_extraction.h"
#include "core/mesh/mesh_checks.h"
#include "tests/property/surface_comparison.h"
#include "tests/property/test_volumes.h"

namespace isoslider::test {
namespace {

using extract::SurfaceMesh;

std::string vertexFault(const SurfaceMesh& mesh, const TopologyGrid& grid) {
    if (mesh.positions.size() != mesh.normals.size() || mesh.edgeIds.size() > mesh.positions.size())
        return "array lengths do not fit";
    for (std::size_t i = 0; i < mesh.positions.size(); ++i)
        for (int axis = 0; axis < 3; ++axis) {
            const float place = mesh.positions[i][axis];
            if (!(place >= 0.0F && place <= static_cast<float>(grid.dims[static_cast<std::size_t>(axis)] - 1)))
                return "vertex " + std::to_string(i) + " is outside the box";
            if (!std::isfinite(mesh.normals[i][axis]))
                return "the normal of vertex " + std::to_string(i) + " is not finite";
        }
    return {};
}

// Bit 2 axis + side: the vertex lies in that side of the box. By its edge, not its place: on a tie a vertex
// inside lies on the box too.
unsigned boxSides(const SurfaceMesh& mesh, const TopologyGrid& grid, std::uint32_t vertex) {
    if (vertex >= mesh.edgeIds.size())
        return 0;
    const auto axis = static_cast<std::size_t>(mesh.edgeIds[vertex] % 4);
    auto point = static_cast<std::int64_t>(mesh.edgeIds[vertex] / 4);
    unsigned sides = 0;
    for (std::size_t a = 0; a < 3; ++a) {
        const std::int64_t place = point % grid.dims[a];
        point /= grid.dims[a];
        if (a == axis)
            continue;
        sides |= place == 0 ? 1u << 2 * a : 0u;
        sides |= place + 1 == grid.dims[a] ? 2u << 2 * a : 0u;
    }
    return sides;
}

std::string triangleFault(const SurfaceMesh& mesh, const TopologyGrid& grid) {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> directed;
    for (std::size_t i = 0; i + 2 < mesh.triangles.size(); i += 3)
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t from = mesh.triangles[i + k], to = mesh.triangles[i + (k + 1) % 3];
            if (from >= mesh.positions.size() || from == to)
                return "triangle " + std::to_string(i / 3) + " repeats a vertex or has one that is not there";
            directed.emplace_back(from, to);
        }
    std::sort(directed.begin(), directed.end());
    if (std::adjacent_find(directed.begin(), directed.end()) != directed.end())
        return "an edge has two triangles on the same side";
    for (const auto& [from, to] : directed) {
        const bool isBorder = !std::binary_search(directed.begin(), directed.end(), std::pair(to, from));
        if (isBorder && (boxSides(mesh, grid, from) & boxSides(mesh, grid, to)) == 0)
            return "a border off the box, vertices " + std::to_string(from) + " and " + std::to_string(to);
    }
    return {};
}

std::string countFault(const mesh::MeshReport& report, const SurfaceMesh& mesh, const GridTopology& expected) {
    const auto differs = [](const char* what, std::int64_t is, std::int64_t should) {
        return std::string(what) + " " + std::to_string(is) + ", should be " + std::to_string(should);
    };
    if (static_cast<std::int64_t>(mesh.edgeIds.size()) != expected.activeEdges)
        return differs("active edges", static_cast<std::int64_t>(mesh.edgeIds.size()), expected.activeEdges);
    if (report.vertices != mesh.positions.size())
        return "a vertex that no triangle uses";
    if (static_cast<std::int64_t>(report.components) != expected.components)
        return differs("components", static_cast<std::int64_t>(report.components), expected.components);
    if (report.euler != expected.euler)
        return differs("Euler number", report.euler, expected.euler);
    if (static_cast<std::int64_t>(report.boundaryLoops) != expected.loops)
        return differs("boundary loops", static_cast<std::int64_t>(report.boundaryLoops), expected.loops);
    return {};
}

} // namespace

std::string surfaceFault(const SurfaceMesh& mesh, const TopologyGrid& grid, const GridTopology& expected) {
    if (std::string fault = vertexFault(mesh, grid); !fault.empty())
        return fault;
    if (std::string fault = triangleFault(mesh, grid); !fault.empty())
        return fault;
    const mesh::MeshReport report = mesh::checkMesh(mesh);
    if (report.duplicateTriangles != 0)
        return "a triangle twice";
    const bool isEmpty = report.triangles == 0;
    if (!isEmpty && (!report.isManifold || !report.isOriented || report.nonManifoldEdges != 0 ||
                     report.nonManifoldVertices != 0 || report.refusedByOpenMesh != 0))
        return "not an oriented manifold: " + std::to_string(report.nonManifoldEdges) + " edges, " +
               std::to_string(report.nonManifoldVertices) + " vertices, " + std::to_string(report.refusedByOpenMesh) +
               " triangles refused by OpenMesh";
    return countFault(report, mesh, expected);
}

std::string surfaceFault(const SurfaceMesh& mesh, const TopologyGrid& grid) {
    return surfaceFault(mesh, grid, sweepGrid(grid.scalars, grid.dims, mesh.isovalue));
}

std::string freshFault(const TopologyGrid& grid, double isovalue) {
    const auto fresh = extract::extractFull(*grid.grid, isovalue);
    return fresh.isOk() ? surfaceFault(fresh.value(), grid) : fresh.error().line();
}

TopologyWalker::TopologyWalker(const TopologyGrid& grid, const std::filesystem::path& path, int skipLevels,
                               double threshold)
    : grid_(grid) {
    preprocess::BuildOptions options;
    options.skipLevels = skipLevels;
    options.redundancyThreshold = threshold;
    if (const auto built = buildIndexOf(grid.grid, path, options); !built.isOk()) {
        fault_ = built.error().line();
        return;
    }
    auto engine = extract::SlideEngine::open(path);
    if (engine.isOk())
        engine_ = std::move(engine).value();
    else
        fault_ = engine.error().line();
}

std::string TopologyWalker::slideFault(double isovalue, bool isJudged) {
    const auto moved = engine_->slideTo(isovalue);
    if (!moved.isOk())
        return moved.error().line();
    isovalue_ = isovalue;
    patchedMoves_ += !moved.value().hasRebuilt;
    const auto fresh = extract::extractFull(*grid_.grid, isovalue);
    if (!fresh.isOk())
        return fresh.error().line();
    if (const auto same = isSameSurface(engine_->mesh().value(), fresh.value()); !same)
        return same.message();
    return isJudged ? surfaceFault(fresh.value(), grid_) : std::string();
}

double TopologyWalker::nextIsovalue(Random& random) const {
    double nearest = topologyIsovalue(grid_, random);
    if (pickInt(random, 0, 1) != 0)
        return nearest;
    for (int i = 0; i < 12; ++i)
        if (const double other = topologyIsovalue(grid_, random);
            std::abs(other - isovalue_) < std::abs(nearest - isovalue_))
            nearest = other;
    return nearest;
}

} // namespace isoslider::test
