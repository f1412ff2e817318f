#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/job_control.h"
#include "core/extract/merged/merge_bound.h"
#include "core/extract/surface_mesh.h"
#include "core/mesh/mesh_checks.h"
#include "core/mesh/triangle_soup.h"

namespace isoslider::mesh {

/// Where a surface may end: at a face of the box (x0 is the face of the first grid points along x, x1
/// that of the last), or at cells with a missing value. Elsewhere it must not: that is a crack.
enum class OpenAt : std::uint8_t { X0, X1, Y0, Y1, Z0, Z1, Missing, Elsewhere };
inline constexpr std::array<std::string_view, 8> kOpenAtNames{"x0", "x1", "y0",      "y1",
                                                              "z0", "z1", "missing", "elsewhere"};

struct Opening {
    std::uint64_t loops = 0; ///< boundary loops with an edge there; a loop around a box corner counts at each face
    std::uint64_t edges = 0; ///< boundary edges there; these add up to all boundary edges
};

/// The volume that a surface is of.
struct SurfaceSource {
    std::string name; ///< file name without its folder, or a sample's title
    std::optional<std::uint64_t> missingSamples; ///< where known: without any, no edge is open at one
    std::string lengthUnit; ///< of spacing and origin; empty: unknown
    std::string resampling = {}; ///< what resampling lost, in one line; empty: it was not resampled
    std::string merging = {}; ///< how far merged cells may differ, in one line; empty: none are merged
    bool isPatientSpace = false; ///< as io::VolumeInfo::isPatientSpace: places are left, posterior, superior (LPS)
    std::string part = {}; ///< what of the surface is left out, in one line; empty: nothing
};

/// For SurfaceSource::merging, of a volume of values from `least` to `greatest`; `side`: of the largest merged cells
/// that there may be. Empty where nothing is merged.
std::string mergingText(const extract::MergeBound& bound, double least, double greatest, int side);

/// What is known of a surface as it is exported: the facts of its mesh in world space, where it is
/// open, and what the export moved.
struct Certificate {
    bool isChecked =
        true; ///< false: of `report` only the numbers of vertices and triangles are set, no opening, no nudge
    MeshReport report;
    double isovalue = 0.0;
    std::string source;
    std::string lengthUnit; ///< of areas and volumes too, squared and cubed; empty: unknown
    std::string resampling; ///< as SurfaceSource::resampling
    std::string merging; ///< as SurfaceSource::merging
    bool isPatientSpace = false; ///< as SurfaceSource::isPatientSpace
    std::string part; ///< as SurfaceSource::part
    GridGeometry geometry; ///< lengths are in the world units that its spacing is in
    std::array<Opening, 8> openings{}; ///< by OpenAt
    std::uint64_t sharedLoops =
        0; ///< boundary loops that count at more than one place: why those of the places may add up to more
    std::uint64_t activeEdges = 0;
    std::uint64_t innerVertices = 0; ///< those of cells, on no grid edge
    Nudge nudge;

    const Opening& openAt(OpenAt place) const { return openings[static_cast<std::size_t>(place)]; }
};

/// Checks a surface once, with all that the certificate states. O(n log n), as checkMesh.
/// A boundary edge lies on a face of the box when the grid edges of both its vertices meet that face;
/// on another plane of grid points it is at a missing value. Decided by edge ids, not by positions.
Certificate certify(const extract::SurfaceMesh& mesh, const SurfaceSource& source);
/// The same. Errors: Cancelled, within a second.
Result<Certificate> certify(const extract::SurfaceMesh& mesh, const SurfaceSource& source, const JobControl& job);
/// What is known without a check.
Certificate uncheckedCertificate(const extract::SurfaceMesh& mesh, const SurfaceSource& source);

/// None of an unchecked surface. Else the faults of the report, cracks, and an area that is not finite, as one with a
/// NaN among its positions.
std::vector<std::string> faultsOf(const Certificate& certificate);
inline bool isValid(const Certificate& certificate) { return certificate.isChecked && faultsOf(certificate).empty(); }

/// "closed", or "open at x0 (2 loops, 34 edges), missing values (1 loop, 8 edges)"; behind it, if so, how many loops
/// meet more than one of these places: "; 1 loop meets both".
std::string openingText(const Certificate& certificate);

struct CertificateLine {
    std::string name;
    std::string value; ///< numbers as the shortest digits that read back as the same, their unit behind them
};

/// The certificate for people and for scripts, in UTF-8. Control characters and bytes of the source's name that are
/// not UTF-8 become '?', and so does a backslash, which would continue a comment in OBJ.
std::vector<CertificateLine> linesOf(const Certificate& certificate);
/// "name: value" lines after a heading, for comments in a file.
std::vector<std::string> commentsOf(const Certificate& certificate);
/// As many facts as fit, the weightiest first, for the 80 bytes of an STL header.
std::string shortForm(const Certificate& certificate, std::size_t maxBytes);

} // namespace isoslider::mesh
