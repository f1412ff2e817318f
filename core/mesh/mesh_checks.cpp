#include "core/mesh/mesh_checks.h"

#include <cmath>

#include <glm/geometric.hpp>

#include "core/base/plain_text.h"
#include "core/mesh/loop_control.h"
#include "core/mesh/mesh_import.h"
#include "core/mesh/open_mesh_adapter.h"
#include "core/mesh/soup_topology.h"

namespace isoslider::mesh {
namespace {

Status measure(const TriangleSoup& soup, const JobControl& job, MeshReport& report) {
    if (soup.triangles.empty())
        return {};
    LoopControl loop(job, soup.triangles.size(), "measuring");
    // Volumes are taken from a point of the surface: far from the world's origin they would cancel.
    const glm::dvec3 base = soup.positions[soup.triangles[0][0]];
    for (std::size_t i = 0; i < soup.triangles.size(); ++i) {
        if (!loop.goesOn(i))
            return cancelledError();
        const Triangle& t = soup.triangles[i];
        const glm::dvec3 a = soup.positions[t[0]] - base;
        const glm::dvec3 b = soup.positions[t[1]] - base;
        const glm::dvec3 c = soup.positions[t[2]] - base;
        const glm::dvec3 doubled = glm::cross(b - a, c - a);
        const double area = 0.5 * glm::length(doubled);
        report.degenerateTriangles += !hasThreeVertices(t) || doubled == glm::dvec3(0.0);
        report.area += area;
        report.enclosedVolume += glm::dot(a, glm::cross(b, c)) / 6.0;
    }
    return {};
}

} // namespace

MeshReport checkSoup(const TriangleSoup& soup) {
    SoupTopology topology;
    return checkSoup(soup, topology, {}).value(); // which only a stop request keeps from one
}

Result<MeshReport> checkSoup(const TriangleSoup& soup, SoupTopology& topology, const JobControl& job) {
    const JobControl analysing = job.part(0.0, 0.5), filling = job.part(0.5, 0.9), measuring = job.part(0.9, 1.0);
    auto analysed = analyseTopology(soup.triangles, soup.positions.size(), analysing);
    if (!analysed.isOk())
        return std::move(analysed).error();
    topology = std::move(analysed).value();
    MeshReport report;
    FloatMesh mesh;
    const auto refused = fillOpenMesh(soup, RefusedFaces::LeaveOut, mesh, filling);
    if (!refused.isOk())
        return refused.error();
    report.refusedByOpenMesh = refused.value();
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
                        static_cast<std::int64_t>(report.boundaryLoops) - report.euler) /
                       2;
    report.duplicateTriangles = topology.duplicateTriangles;
    report.nonManifoldEdges = topology.crowdedEdges;
    report.nonManifoldVertices = topology.verticesOfSeveralFans;
    ISO_TRY(measure(soup, measuring, report));
    return report;
}

std::vector<std::string> faultsOf(const MeshReport& report) {
    std::vector<std::string> faults;
    if (!report.isManifold)
        faults.emplace_back("not manifold");
    if (!report.isOriented)
        faults.emplace_back("not consistently oriented");
    if (report.degenerateTriangles > 0)
        faults.push_back(counted(report.degenerateTriangles, "degenerate triangle"));
    if (report.duplicateTriangles > 0)
        faults.push_back(counted(report.duplicateTriangles, "duplicate triangle"));
    return faults;
}

MeshReport checkMesh(const extract::SurfaceMesh& mesh) { return checkSoup(worldSoup(mesh)); }

Result<MeshReport> checkMeshFile(const std::filesystem::path& path, const JobControl& job) {
    const JobControl reading = job.part(0.0, 0.4), checking = job.part(0.4, 1.0);
    auto soup = readMeshFile(path, reading);
    if (!soup.isOk())
        return std::move(soup).error();
    SoupTopology topology;
    return checkSoup(soup.value(), topology, checking);
}

} // namespace isoslider::mesh
