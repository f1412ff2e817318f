#include "core/mesh/mesh_import.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <exception>
#include <iostream>
#include <new>

#include <OpenMesh/Core/IO/MeshIO.hh>
#include <OpenMesh/Core/Mesh/PolyMesh_ArrayKernelT.hh>

#include "core/base/quiet_stream.h"
#include "core/mesh/mesh_readers.h"
#include "core/mesh/open_mesh_adapter.h"

namespace isoslider::mesh {
namespace {

using PolyMesh = OpenMesh::PolyMesh_ArrayKernelT<DoubleTraits>;

// Meshes are read whole: this many bytes hold some hundred million triangles.
constexpr std::uint64_t kMaxFileBytes = std::uint64_t{16} << 30;

/// OpenMesh believes the counts in the header of its native format; they are checked first.
Status checkOmHeader(std::string_view bytes, const std::filesystem::path& path) {
    // "OM", kind, version, then the numbers of vertices, faces and edges.
    if (bytes.size() < 16 || !bytes.starts_with("OM"))
        return makeError(ErrorCode::InvalidArgument, "is not a readable om mesh: its first bytes are not 'OM'", path);
    for (std::size_t i = 0; i < 3; ++i) {
        std::uint32_t count = 0;
        std::memcpy(&count, bytes.data() + 4 + 4 * i, 4);
        if (count > bytes.size())
            return makeError(ErrorCode::Corruption, "the header asks for more elements than the file can hold", path);
    }
    return {};
}

// A native OpenMesh file holds halfedges, which only a real mesh can take.
Result<TriangleSoup> readOm(std::string_view bytes, const std::filesystem::path& path) {
    ISO_TRY(checkOmHeader(bytes, path));
    PolyMesh mesh;
    bool isRead = false;
    {
        const QuietStream quietErrors(std::cerr), quietLog(std::clog);
        isRead = OpenMesh::IO::read_mesh(mesh, path.string());
    }
    if (!isRead)
        return makeError(ErrorCode::InvalidArgument, "is not a readable om mesh", path);
    TriangleSoup soup;
    for (const auto vertex : mesh.vertices()) {
        const auto& p = mesh.point(vertex);
        soup.positions.emplace_back(p[0], p[1], p[2]);
    }
    std::vector<std::int64_t> corners;
    for (const auto face : mesh.faces()) {
        corners.clear();
        for (const auto vertex : mesh.fv_range(face)) {
            corners.push_back(vertex.idx());
            if (corners.size() > mesh.n_vertices())
                return makeError(ErrorCode::Corruption, "the halfedges of a face do not close", path);
        }
        ISO_TRY(addPolygon(soup, corners, path));
    }
    ISO_TRY(checkIndices(soup, path));
    return soup;
}

Result<TriangleSoup> readAs(const std::string& suffix, std::string_view bytes, const std::filesystem::path& path) {
    if (suffix == ".ply")
        return readPly(bytes, path);
    if (suffix == ".obj")
        return readObj(bytes, path);
    if (suffix == ".off")
        return readOff(bytes, path);
    if (suffix == ".stl")
        return readStl(bytes, path);
    return readOm(bytes, path);
}

Status checkFinite(const TriangleSoup& soup, const std::filesystem::path& path) {
    for (std::size_t i = 0; i < soup.positions.size(); ++i) {
        const glm::dvec3& p = soup.positions[i];
        if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
            return makeError(ErrorCode::InvalidArgument, "position of vertex " + std::to_string(i) + " is not finite",
                             path);
    }
    return {};
}

Result<TriangleSoup> readChecked(const std::filesystem::path& path) {
    const auto file = readWholeFile(path, kMaxFileBytes); // refuses folders, pipes and devices
    if (!file.isOk())
        return file.error();
    const std::string suffix = meshSuffix(path);
    if (suffix.empty())
        return makeError(ErrorCode::InvalidArgument, "is not a mesh file: expected .ply .obj .stl .off or .om", path);
    auto soup = readAs(suffix, {reinterpret_cast<const char*>(file.value().data()), file.value().size()}, path);
    if (soup.isOk())
        ISO_TRY(checkFinite(soup.value(), path));
    return soup;
}

} // namespace

std::string meshSuffix(const std::filesystem::path& path) {
    std::string suffix = path.extension().string();
    for (char& c : suffix)
        if (c >= 'A' && c <= 'Z')
            c = static_cast<char>(c - 'A' + 'a');
    for (const char* known : {".ply", ".obj", ".stl", ".off", ".om"})
        if (suffix == known)
            return suffix;
    return {};
}

Result<TriangleSoup> readMeshFile(const std::filesystem::path& path) {
    silenceOpenMesh();
    try {
        return readChecked(path);
    } catch (const std::bad_alloc&) {
        return makeError(ErrorCode::OutOfSpace, "does not fit in memory", path);
    } catch (const std::exception& problem) {
        return makeError(ErrorCode::InvalidArgument, std::string("cannot be read as a mesh: ") + problem.what(), path);
    }
}

} // namespace isoslider::mesh
