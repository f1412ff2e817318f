#include "core/mesh/mesh_checks.h"

#include <cmath>

#include <glm/geometric.hpp>

#include "core/mesh/mesh_import.h"
#include "core/mesh/open_mesh_adapter.h"
#include "core/mesh/soup_topology.h"

namespace isoslider::mesh {
namespace {

void measure(const TriangleSoup& soup, MeshReport& report) {
    if (soup.triangles.empty())
        return;
    // Volumes are taken from a point of the surface: far from the world's origin they would cancel.
    const glm::dvec3 base = soup.positions[soup.triangles[0][0]];
    for (const Triangle& t : soup.triangles) {
        const glm::dvec3 a = soup.positions[t[0]] - base;
        const glm::dvec3 b = soup.positions[t[1]] - base;
        const glm::dvec3 c = soup.positions[t[2]] - base;
        const glm::dvec3 doubled = glm::cross(b - a, c - a);
        const double area = 0.5 * glm::length(doubled);
        report.degenerateTriangles += !hasThreeVertices(t) || doubled == glm::dvec3(0.0);
        report.area += area;
        report.enclosedVolume += glm::dot(a, glm::cross(b, c)) / 6.0;
    }
}

} // namespace

MeshReport checkSoup(const TriangleSoup& soup) {
    SoupTopology topology;
    return checkSoup(soup, topology);
}

MeshReport checkSoup(const TriangleSoup& soup, SoupTopology& topology) {
    topology = analyseTopology(soup.triangles, soup.positions.size());
    MeshReport report;
    FloatMesh mesh;
    report.refusedByOpenMesh = fillOpenMesh(soup, RefusedFaces::LeaveOut, mesh);
    report.isClosed = topology.boundaryEdges == 0;
    report.isOriented = topology.disagreeingEdges == 0;
    report.isManifold = topology.isManifold() && !(report.isOriented && report.refusedByOpenMesh > 0);
    report.vertices = topology.usedVertices;
    report.edges = topology.edges;
    report.triangles = soup.triangles.size();
    report.components = topology.components;
    report.boundaryLoops = topology.boundaryLoops;
    report.euler = static_cast<std::int64_t>(topology.usedVertices) - static_cast<std::int64_t>(topology.edges) +
                   static_cast<std::int64_t>(soup.triangles.size() - topology.trianglesWithRepeats);
    if (report.isManifold && report.isOriented)
        report.genus = (2 * static_cast<std::int64_t>(report.components) -
                        static_cast<std::int64_t>(report.boundaryLoops) - report.euler) / 2;
    report.duplicateTriangles = topology.duplicateTriangles;
    report.nonManifoldEdges = topology.crowdedEdges;
    report.nonManifoldVertices = topology.verticesOfSeveralFans;
    measure(soup, report);
    return report;
}

std::vector<std::string> faultsOf(const MeshReport& report) {
    std::vector<std::string> faults;
    if (!report.isManifold)
        faults.emplace_back("not manifold");
    if (!report.isOriented)
        faults.emplace_back("not consistently oriented");
    if (report.degenerateTriangles > 0)
        faults.push_back(std::to_string(report.degenerateTriangles) + " degenerate triangles");
    if (report.duplicateTriangles > 0)
        faults.push_back(std::to_string(report.duplicateTriangles) + " duplicate triangles");
    return faults;
}

MeshReport checkMesh(const extract::SurfaceMesh& mesh) { return checkSoup(worldSoup(mesh)); }

Result<MeshReport> checkMeshFile(const std::filesystem::path& path) {
    auto soup = readMeshFile(path);
    if (!soup.isOk())
        return std::move(soup).error();
    return checkSoup(soup.value());
}

} // namespace isoslider::mesh
