#include "core/mesh/mesh_export.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>
#include <limits>
#include <mutex>
#include <new>
#include <ostream>
#include <streambuf>
#include <string>
#include <vector>

#include <tbb/parallel_sort.h>

#include "core/base/file_system.h"
#include "core/base/guarded.h"
#include "core/base/quiet_stream.h"
#include "core/mesh/mesh_import.h"
#include "core/mesh/mesh_writers.h"
#include "core/mesh/open_mesh_adapter.h"

namespace isoslider::mesh {
namespace {

/// OpenMesh writes to streams, which only know "failed": the buffer keeps the reason.
class FileBuffer final : public std::streambuf {
public:
    FileBuffer(AtomicFile& file, const JobControl& job) : file_(file), job_(job), buffer_(std::size_t{1} << 20) {
        setp(buffer_.data(), buffer_.data() + buffer_.size());
    }
    const Status& status() const { return status_; }

protected:
    int_type overflow(int_type c) override {
        if (sync() != 0)
            return traits_type::eof();
        if (!traits_type::eq_int_type(c, traits_type::eof())) {
            *pptr() = traits_type::to_char_type(c);
            pbump(1);
        }
        return traits_type::not_eof(c);
    }

    int sync() override {
        if (status_.isOk() && job_.isStopRequested())
            status_ = cancelledError();
        if (status_.isOk())
            status_ = file_.writeAll(std::as_bytes(std::span(pbase(), static_cast<std::size_t>(pptr() - pbase()))));
        setp(buffer_.data(), buffer_.data() + buffer_.size());
        return status_.isOk() ? 0 : -1;
    }

    // Enough for tellp().
    pos_type seekoff(off_type offset, std::ios_base::seekdir way, std::ios_base::openmode) override {
        if (offset != 0 || way != std::ios_base::cur)
            return pos_type(off_type(-1));
        return pos_type(static_cast<off_type>(file_.sizeBytes()) + (pptr() - pbase()));
    }

private:
    AtomicFile& file_;
    const JobControl& job_;
    std::uint64_t unsynced_ = 0;
    std::vector<char> buffer_;
    Status status_;
};

// Far from the world's origin neighbouring vertices would round to one float. Vertices of one grid point
// lie kLeastDistance off it: half of that is the most that a float may be coarse. In units that are far too small or
// too large floats have no such places at all.
Precision neededPrecision(const TriangleSoup& soup, const GridGeometry& geometry) {
    double farthest = 0.0;
    for (const glm::dvec3& p : soup.positions)
        farthest = std::max({farthest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    const glm::dvec3& spacing = geometry.spacing;
    const double cell = std::min({std::abs(spacing.x), std::abs(spacing.y), std::abs(spacing.z)});
    using Float = std::numeric_limits<float>;
    const double coarseness = std::max<double>(farthest * Float::epsilon(), Float::min()); // below that digits are lost
    return farthest > Float::max() || coarseness > cell * kLeastDistance / 2 ? Precision::Double : Precision::Float;
}

// Readers of STL, which has no numbers of vertices, join corners at one place.
template <class Number>
std::size_t differentPlaces(const TriangleSoup& soup) {
    std::vector<std::array<Number, 3>> places;
    places.reserve(soup.positions.size());
    for (const glm::dvec3& p : soup.positions)
        places.push_back({static_cast<Number>(p.x), static_cast<Number>(p.y), static_cast<Number>(p.z)});
    tbb::parallel_sort(places.begin(), places.end());
    return static_cast<std::size_t>(std::unique(places.begin(), places.end()) - places.begin());
}

Status checkFloatsHoldPlaces(const TriangleSoup& soup, const std::filesystem::path& path) {
    constexpr const char* kOthers = "; export to .ply .obj .off or .om";
    constexpr double kMost = std::numeric_limits<float>::max();
    const auto isFar = [](const glm::dvec3& p) {
        return std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) > kMost;
    };
    if (const auto far = std::count_if(soup.positions.begin(), soup.positions.end(), isFar); far > 0)
        return makeError(ErrorCode::InvalidArgument,
                         std::to_string(far) + " vertices lie beyond the 32-bit places of an STL file" + kOthers, path);
    const std::size_t lost = differentPlaces<double>(soup) - differentPlaces<float>(soup);
    if (lost == 0)
        return {};
    return makeError(ErrorCode::InvalidArgument,
                     std::to_string(lost) +
                         " vertices would fall together in an STL file, whose places have 32 bits: "
                         "too coarse so far from the origin, or in so small a unit" +
                         kOthers,
                     path);
}

template <class Mesh>
Status writeOm(const TriangleSoup& soup, AtomicFile& file, const JobControl& job) {
    Mesh mesh;
    const JobControl filling = job.part(0.0, 0.5);
    if (const auto filled = fillOpenMesh(soup, RefusedFaces::Separate, mesh, filling); !filled.isOk())
        return filled.error();
    job.report(0.5, "writing");
    FileBuffer buffer(file, job);
    std::ostream stream(&buffer);
    OpenMesh::IO::Options options = OpenMesh::IO::Options::Binary;
    if (!soup.normals.empty())
        options += OpenMesh::IO::Options::VertexNormal;
    bool isWritten = false;
    {
        static std::mutex oneAtATime;
        const std::scoped_lock lock(oneAtATime);
        const QuietStream quiet(std::clog); // OpenMesh logs how many bytes were written
        isWritten = OpenMesh::IO::write_mesh(mesh, stream, ".om", options);
    }
    stream.flush();
    ISO_TRY(buffer.status());
    if (!isWritten || !stream)
        return makeError(ErrorCode::IoError, "OpenMesh could not write the mesh", file.path());
    return {};
}

Status writeSoup(const TriangleSoup& soup, const Certificate& certificate, const std::string& suffix, AtomicFile& file,
                 const JobControl& job) {
    const Precision precision = neededPrecision(soup, certificate.geometry);
    if (suffix == ".ply")
        return writePly(soup, precision, commentsOf(certificate), file, job);
    if (suffix == ".obj")
        return writeObj(soup, precision, commentsOf(certificate), file, job);
    if (suffix == ".off")
        return writeOff(soup, precision, commentsOf(certificate), file, job);
    if (suffix == ".stl" && precision == Precision::Double)
        ISO_TRY(checkFloatsHoldPlaces(soup, file.path()));
    if (suffix == ".stl")
        return writeStl(soup, shortForm(certificate, kStlHeaderBytes), file, job);
    return precision == Precision::Double ? writeOm<DoubleMesh>(soup, file, job) : writeOm<FloatMesh>(soup, file, job);
}

} // namespace

bool isExportSuffix(const std::filesystem::path& path) { return !meshSuffix(path).empty(); }

Status checkExportSize(std::uint64_t vertices, std::uint64_t triangles, const std::filesystem::path& path) {
    if (vertices > static_cast<std::uint64_t>(std::numeric_limits<std::int32_t>::max()) ||
        triangles > std::numeric_limits<std::uint32_t>::max())
        return makeError(ErrorCode::InvalidArgument, "the mesh has 2^31 vertices or 2^32 triangles or more", path);
    return {};
}

Status exportMesh(const extract::SurfaceMesh& mesh, const Certificate& certificate, const std::filesystem::path& path,
                  const JobControl& job) {
    if (!isExportSuffix(path))
        return makeError(ErrorCode::InvalidArgument, "cannot be exported to: expected .ply .obj .stl .off or .om",
                         path);
    ISO_TRY(checkExportSize(mesh.positions.size(), mesh.triangleCount(), path));
    auto file = AtomicFile::create(path);
    if (!file.isOk())
        return std::move(file).error();
    const ThrownErrors errors{"not enough memory to export the mesh", ErrorCode::IoError, "cannot write the mesh",
                              path};
    const Status written = guarded(errors, [&]() -> Status {
        TriangleSoup soup = worldSoup(mesh);
        dropUnusedVertices(soup);
        ISO_TRY(writeSoup(soup, certificate, meshSuffix(path), *file.value(), job));
        return job.isStopRequested() ? cancelledError() : Status();
    });
    if (!written.isOk())
        return written;
    return file.value()->publish();
}

} // namespace isoslider::mesh
