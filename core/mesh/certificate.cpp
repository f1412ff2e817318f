#include "core/mesh/certificate.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

namespace isoslider::mesh {
namespace {

constexpr std::size_t kMaxNameBytes = 200; // a header line of 1000 bytes is refused by some readers

// Two ends on one line of grid points share two planes: then the box's goes before one inside it.
OpenAt placeOf(const GridEdge& a, const GridEdge& b, const GridDims& dims) {
    OpenAt place = OpenAt::Elsewhere;
    for (int axis = 0; axis < 3; ++axis) {
        const auto i = static_cast<std::size_t>(axis);
        if (a.axis == axis || b.axis == axis || a.lower[i] != b.lower[i])
            continue;
        if (a.lower[i] == 0)
            return static_cast<OpenAt>(2 * axis);
        if (a.lower[i] == dims[i] - 1)
            return static_cast<OpenAt>(2 * axis + 1);
        place = OpenAt::Missing;
    }
    return place;
}

std::array<Opening, 8> openingsOf(const extract::SurfaceMesh& mesh, const SoupTopology& topology, bool mayMiss) {
    std::array<Opening, 8> openings{};
    std::vector<std::pair<OpenAt, std::uint32_t>> loopsAt;
    for (const BoundaryEdge& edge : topology.boundary) {
        OpenAt place = OpenAt::Elsewhere; // an inner vertex lies on no plane of grid points
        if (edge.begin < mesh.edgeIds.size() && edge.end < mesh.edgeIds.size())
            place = placeOf(gridEdge(mesh.edgeIds[edge.begin], mesh.geometry.dims),
                            gridEdge(mesh.edgeIds[edge.end], mesh.geometry.dims), mesh.geometry.dims);
        if (place == OpenAt::Missing && !mayMiss)
            place = OpenAt::Elsewhere;
        ++openings[static_cast<std::size_t>(place)].edges;
        loopsAt.emplace_back(place, edge.loop);
    }
    std::sort(loopsAt.begin(), loopsAt.end());
    loopsAt.erase(std::unique(loopsAt.begin(), loopsAt.end()), loopsAt.end());
    for (const auto& [place, loop] : loopsAt)
        ++openings[static_cast<std::size_t>(place)].loops;
    return openings;
}

std::string text(double value) {
    char digits[40];
    return {digits, std::to_chars(digits, digits + sizeof digits, value).ptr};
}
std::string text(std::uint64_t value) { return std::to_string(value); }
std::string text(std::int64_t value) { return std::to_string(value); }
std::string text(bool isSo) { return isSo ? "yes" : "no"; }
std::string text(const glm::dvec3& v) { return text(v.x) + " " + text(v.y) + " " + text(v.z); }

std::string counted(std::uint64_t count, const char* what) {
    return text(count) + " " + what + (count == 1 ? "" : "s");
}

std::string joined(const std::vector<std::string>& parts) {
    std::string line;
    for (const std::string& part : parts)
        line += (line.empty() ? "" : ", ") + part;
    return line;
}

// A backslash would continue an OBJ comment on the next line; PLY headers are ASCII.
std::string printable(std::string_view name) {
    std::string clean;
    for (const char c : name.substr(0, kMaxNameBytes))
        clean += c >= 0x20 && c < 0x7f && c != '\\' ? c : '?';
    return name.size() > kMaxNameBytes ? clean + "..." : clean;
}

/// Mesh files take ASCII in their comments.
std::string unitText(const std::string& unit) {
    if (unit.empty())
        return "world units of the source: those of its spacing and origin";
    return (unit == "µm" ? "um" : unit == "Å" ? "angstrom" : printable(unit)) +
           ", that of the spacing and origin of the source";
}

std::string gridText(const GridGeometry& geometry) {
    const GridDims& dims = geometry.dims;
    return text(dims[0]) + " x " + text(dims[1]) + " x " + text(dims[2]) + " points, spacing " + text(geometry.spacing) +
           ", origin " + text(geometry.origin) + (geometry.isLeftHanded() ? ", left-handed" : ", right-handed");
}

std::string nudgeText(const Nudge& nudge) {
    if (nudge.vertices == 0)
        return "0";
    return text(nudge.vertices) + ", held off grid points, by at most " + text(nudge.largestCells) + " cells (" +
           text(nudge.largestWorld) + " units)";
}

} // namespace

Certificate certify(const extract::SurfaceMesh& mesh, const SurfaceSource& source) {
    Certificate certificate;
    SoupTopology topology;
    certificate.report = checkSoup(worldSoup(mesh), topology);
    certificate.isovalue = mesh.isovalue;
    certificate.source = source.name;
    certificate.lengthUnit = source.lengthUnit;
    certificate.geometry = mesh.geometry;
    certificate.openings = openingsOf(mesh, topology, source.missingSamples.value_or(1) > 0);
    certificate.activeEdges = mesh.edgeIds.size();
    certificate.innerVertices = mesh.positions.size() - mesh.edgeIds.size();
    certificate.nudge = nudgeOf(mesh);
    return certificate;
}

std::vector<std::string> faultsOf(const Certificate& certificate) {
    auto faults = faultsOf(certificate.report);
    if (const Opening& crack = certificate.openAt(OpenAt::Elsewhere); crack.edges > 0)
        faults.push_back(counted(crack.edges, "boundary edge") + " neither on the box nor at a missing value");
    if (!std::isfinite(certificate.report.area))
        faults.emplace_back("area not finite");
    return faults;
}

std::string openingText(const Certificate& certificate) {
    std::vector<std::string> parts;
    for (std::size_t i = 0; i < certificate.openings.size(); ++i) {
        const Opening& opening = certificate.openings[i];
        const bool isMissing = static_cast<OpenAt>(i) == OpenAt::Missing;
        if (opening.edges > 0)
            parts.push_back((isMissing ? std::string("missing values") : std::string(kOpenAtNames[i])) + " (" +
                            counted(opening.loops, "loop") + ", " + counted(opening.edges, "edge") + ")");
    }
    return parts.empty() ? "closed" : "open at " + joined(parts);
}

std::vector<CertificateLine> linesOf(const Certificate& certificate) {
    const MeshReport& report = certificate.report;
    const auto faults = faultsOf(certificate);
    const bool hasGenus = report.isManifold && report.isOriented;
    return {{"source", printable(certificate.source)},
            {"isovalue", text(certificate.isovalue)},
            {"grid", gridText(certificate.geometry)},
            {"units", unitText(certificate.lengthUnit)},
            {"orientation", "counter-clockwise seen from the side below the isovalue"},
            {"vertices", text(report.vertices)},
            {"triangles", text(report.triangles)},
            {"active edges", text(certificate.activeEdges)},
            {"inner vertices", text(certificate.innerVertices)},
            {"components", text(report.components)},
            {"Euler number", text(report.euler)},
            {"boundary loops", text(report.boundaryLoops)},
            {"boundary", openingText(certificate)},
            {"genus", hasGenus ? text(report.genus) : "none: not an oriented manifold"},
            {"area", text(report.area) + " square units"},
            {"enclosed volume", report.isClosed ? text(report.enclosedVolume) + " cubic units" : "none: open"},
            {"closed", text(report.isClosed)},
            {"manifold", text(report.isManifold)},
            {"oriented", text(report.isOriented)},
            {"degenerate triangles", text(report.degenerateTriangles)},
            {"duplicate triangles", text(report.duplicateTriangles)},
            {"nudged vertices", nudgeText(certificate.nudge)},
            {"valid", faults.empty() ? "yes" : "no: " + joined(faults)}};
}

std::vector<std::string> commentsOf(const Certificate& certificate) {
    std::vector<std::string> comments{"Isosurface by ISOSLIDER, checked with OpenMesh"};
    for (const CertificateLine& line : linesOf(certificate))
        comments.push_back(line.name + ": " + line.value);
    return comments;
}

std::string shortForm(const Certificate& certificate, std::size_t maxBytes) {
    const MeshReport& report = certificate.report;
    std::string form = "ISOSLIDER";
    for (const std::string& fact :
         {"isovalue=" + text(certificate.isovalue), std::string(isValid(certificate) ? "valid" : "INVALID"),
          std::string(report.isClosed ? "closed" : "open"), "components=" + text(report.components),
          "euler=" + text(report.euler), "loops=" + text(report.boundaryLoops), "vertices=" + text(report.vertices)})
        if (form.size() + 1 + fact.size() <= maxBytes)
            form += " " + fact;
    return form;
}

} // namespace isoslider::mesh
