#include "core/mesh/certificate.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <utility>

#include "core/base/plain_text.h"

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

void addOpenings(const extract::SurfaceMesh& mesh, const SoupTopology& topology, bool mayMiss,
                 Certificate& certificate) {
    auto& openings = certificate.openings;
    std::vector<std::pair<std::uint32_t, OpenAt>> loopsAt;
    for (const BoundaryEdge& edge : topology.boundary) {
        OpenAt place = OpenAt::Elsewhere; // an inner vertex lies on no plane of grid points
        if (edge.begin < mesh.edgeIds.size() && edge.end < mesh.edgeIds.size())
            place = placeOf(gridEdge(mesh.edgeIds[edge.begin], mesh.geometry.dims),
                            gridEdge(mesh.edgeIds[edge.end], mesh.geometry.dims), mesh.geometry.dims);
        if (place == OpenAt::Missing && !mayMiss)
            place = OpenAt::Elsewhere;
        ++openings[static_cast<std::size_t>(place)].edges;
        loopsAt.emplace_back(edge.loop, place);
    }
    std::sort(loopsAt.begin(), loopsAt.end());
    loopsAt.erase(std::unique(loopsAt.begin(), loopsAt.end()), loopsAt.end());
    for (std::size_t i = 0; i < loopsAt.size(); ++i) {
        ++openings[static_cast<std::size_t>(loopsAt[i].second)].loops;
        const bool isSecondOfItsLoop =
            i > 0 && loopsAt[i].first == loopsAt[i - 1].first && (i < 2 || loopsAt[i].first != loopsAt[i - 2].first);
        certificate.sharedLoops += isSecondOfItsLoop ? 1 : 0;
    }
}

std::string text(double value) {
    char digits[40];
    return {digits, std::to_chars(digits, digits + sizeof digits, value).ptr};
}
std::string text(std::uint64_t value) { return std::to_string(value); }
std::string text(std::int64_t value) { return std::to_string(value); }
std::string text(bool isSo) { return isSo ? "yes" : "no"; }
std::string text(const glm::dvec3& v) { return text(v.x) + " " + text(v.y) + " " + text(v.z); }

std::string joined(const std::vector<std::string>& parts) {
    std::string line;
    for (const std::string& part : parts)
        line += (line.empty() ? "" : ", ") + part;
    return line;
}

/// Bytes of the UTF-8 character at the front of `text`; 0 if there is none, or if it controls terminals or lines.
std::size_t printableBytes(std::string_view text) {
    const auto byteAt = [&](std::size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0u; };
    const unsigned first = byteAt(0);
    if (first < 0x80) // a backslash would continue an OBJ comment on the next line
        return first >= 0x20 && first != 0x7f && first != '\\' ? 1 : 0;
    const std::size_t size = first >= 0xf0 ? 4 : first >= 0xe0 ? 3 : 2;
    char32_t code = first & (0x7fu >> size);
    for (std::size_t i = 1; i < size; ++i) {
        if ((byteAt(i) & 0xc0) != 0x80)
            return 0;
        code = code << 6 | (byteAt(i) & 0x3f);
    }
    constexpr char32_t kLeast[] = {0xa0, 0x800, 0x10000}; // below 0xa0 there are controls only
    const bool isSurrogate = code >= 0xd800 && code < 0xe000, endsLine = code == 0x2028 || code == 0x2029;
    return first < 0xc0 || first >= 0xf8 || code < kLeast[size - 2] || code > 0x10ffff || isSurrogate || endsLine
               ? 0
               : size;
}

std::string printable(std::string_view name) {
    std::string clean;
    while (!name.empty() && clean.size() < kMaxNameBytes) {
        const std::size_t size = printableBytes(name);
        clean += size > 0 ? name.substr(0, size) : "?";
        name.remove_prefix(std::max<std::size_t>(size, 1));
    }
    return name.empty() ? clean : clean + "...";
}

/// In ASCII where that is possible: some readers of meshes take no other comments.
std::string unitName(const std::string& unit) {
    if (unit.empty())
        return "units";
    return unit == "µm" ? "um" : unit == "Å" ? "angstrom" : printable(unit);
}

std::string unitText(const std::string& unit) {
    if (unit.empty())
        return "world units of the source: those of its spacing and origin";
    return unitName(unit) + ", that of the spacing and origin of the source";
}

std::string gridText(const GridGeometry& geometry) {
    const GridDims& dims = geometry.dims;
    return text(dims[0]) + " x " + text(dims[1]) + " x " + text(dims[2]) + " points, spacing " +
           text(geometry.spacing) + ", origin " + text(geometry.origin) +
           (geometry.isLeftHanded() ? ", left-handed" : ", right-handed");
}

// A vertex that is interpolated along the edge of a merged cell may lie beside the one grid edge on it that is active.
std::string nudgeText(const Nudge& nudge, const std::string& unit, bool isMerged) {
    if (nudge.vertices == 0)
        return "0";
    return text(nudge.vertices) + ", held off grid points" + (isMerged ? " and on active grid edges" : "") +
           ", by at most " + text(nudge.largestCells) + " cells (" + text(nudge.largestWorld) + " " + unitName(unit) +
           ")";
}

} // namespace

Certificate uncheckedCertificate(const extract::SurfaceMesh& mesh, const SurfaceSource& source) {
    Certificate certificate;
    certificate.isChecked = false;
    certificate.report.vertices = mesh.positions.size();
    certificate.report.triangles = mesh.triangleCount();
    certificate.isovalue = mesh.isovalue;
    certificate.source = source.name;
    certificate.lengthUnit = source.lengthUnit;
    certificate.resampling = source.resampling;
    certificate.merging = source.merging;
    certificate.isPatientSpace = source.isPatientSpace;
    certificate.part = source.part;
    certificate.geometry = mesh.geometry;
    certificate.activeEdges = mesh.activeEdgeCount();
    certificate.innerVertices = mesh.positions.size() - mesh.edgeIds.size();
    return certificate;
}

Certificate certify(const extract::SurfaceMesh& mesh, const SurfaceSource& source) {
    return certify(mesh, source, {}).value(); // which only a stop request keeps from one
}

Result<Certificate> certify(const extract::SurfaceMesh& mesh, const SurfaceSource& source, const JobControl& job) {
    Certificate certificate = uncheckedCertificate(mesh, source);
    SoupTopology topology;
    auto report = checkSoup(worldSoup(mesh), topology, job);
    if (!report.isOk())
        return std::move(report).error();
    certificate.isChecked = true;
    certificate.report = report.value();
    addOpenings(mesh, topology, source.missingSamples.value_or(1) > 0, certificate);
    certificate.nudge = nudgeOf(mesh);
    if (job.isStopRequested())
        return cancelledError();
    return certificate;
}

std::vector<std::string> faultsOf(const Certificate& certificate) {
    if (!certificate.isChecked)
        return {};
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
    if (parts.empty())
        return "closed";
    const auto shared = certificate.sharedLoops;
    return "open at " + joined(parts) +
           (shared == 0 ? ""
                        : "; " + counted(shared, "loop") + (shared == 1 ? " meets " : " meet ") +
                              (parts.size() == 2 ? "both" : "several of these"));
}

namespace {

std::vector<CertificateLine> checkedLines(const Certificate& certificate) {
    const MeshReport& report = certificate.report;
    const auto faults = faultsOf(certificate);
    const std::string unit = unitName(certificate.lengthUnit);
    const bool hasGenus = report.isManifold && report.isOriented;
    return {{"components", text(report.components)},
            {"Euler number", text(report.euler)},
            {"boundary loops", text(report.boundaryLoops)},
            {"boundary", openingText(certificate)},
            {"genus", hasGenus ? text(report.genus) : "none: not an oriented manifold"},
            {"area", text(report.area) + " square " + unit},
            {"enclosed volume", report.isClosed ? text(report.enclosedVolume) + " cubic " + unit : "none: open"},
            {"closed", text(report.isClosed)},
            {"manifold", text(report.isManifold)},
            {"oriented", text(report.isOriented)},
            {"degenerate triangles", text(report.degenerateTriangles)},
            {"duplicate triangles", text(report.duplicateTriangles)},
            {"nudged vertices", nudgeText(certificate.nudge, certificate.lengthUnit, !certificate.merging.empty())},
            {"valid", faults.empty() ? "yes" : "no: " + joined(faults)}};
}

} // namespace

std::string mergingText(const extract::MergeBound& bound, double least, double greatest, int side) {
    if (!(bound.limit > 0.0))
        return {};
    std::string within = text(bound.limit) + (bound.limit == 1.0 ? " cell" : " cells");
    if (bound.measure == extract::MergeBound::Measure::Scalar) {
        char percent[40];
        std::snprintf(percent, sizeof percent, "%.6g", extract::errorOf(bound, least, greatest).amount);
        within = std::string(percent) + " % of the value range (" + text(bound.limit) + ")";
    }
    return "within " + within + ", of up to " + std::to_string(side) + " cells a side";
}

std::vector<CertificateLine> linesOf(const Certificate& certificate) {
    std::vector<CertificateLine> lines{{"source", printable(certificate.source)},
                                       {"isovalue", text(certificate.isovalue)},
                                       {"grid", gridText(certificate.geometry)},
                                       {"units", unitText(certificate.lengthUnit)},
                                       {"orientation", "counter-clockwise seen from the side below the isovalue"},
                                       {"vertices", text(certificate.report.vertices)},
                                       {"triangles", text(certificate.report.triangles)},
                                       {"active edges", text(certificate.activeEdges)},
                                       {"inner vertices", text(certificate.innerVertices)}};
    if (certificate.isPatientSpace)
        lines.insert(lines.begin() + 4,
                     {"coordinates", "LPS: x to the left, y to posterior, z to superior, as in DICOM"});
    if (!certificate.resampling.empty())
        lines.insert(lines.begin() + 3, {"resampled", printable(certificate.resampling)});
    if (!certificate.merging.empty())
        lines.insert(lines.begin() + 2, {"merged cells", printable(certificate.merging)});
    if (!certificate.part.empty())
        lines.insert(lines.begin() + 2, {"part", printable(certificate.part)});
    if (!certificate.isChecked) {
        lines.push_back({"checked", "no"});
        return lines;
    }
    const auto checked = checkedLines(certificate);
    lines.insert(lines.end(), checked.begin(), checked.end());
    return lines;
}

std::vector<std::string> commentsOf(const Certificate& certificate) {
    std::vector<std::string> comments{certificate.isChecked ? "Isosurface by ISOSLIDER, checked with OpenMesh"
                                                            : "Isosurface by ISOSLIDER, not checked"};
    for (const CertificateLine& line : linesOf(certificate))
        comments.push_back(line.name + ": " + line.value);
    return comments;
}

std::string shortForm(const Certificate& certificate, std::size_t maxBytes) {
    const MeshReport& report = certificate.report;
    std::string form = "ISOSLIDER";
    std::vector<std::string> facts{"isovalue=" + text(certificate.isovalue)};
    if (!certificate.isChecked)
        facts.insert(facts.end(), {"not checked", "vertices=" + text(report.vertices)});
    else
        facts.insert(facts.end(), {isValid(certificate) ? "valid" : "INVALID", report.isClosed ? "closed" : "open",
                                   "components=" + text(report.components), "euler=" + text(report.euler),
                                   "loops=" + text(report.boundaryLoops), "vertices=" + text(report.vertices)});
    for (const std::string& fact : facts)
        if (form.size() + 1 + fact.size() <= maxBytes)
            form += " " + fact;
    return form;
}

} // namespace isoslider::mesh
