#include "core/mesh/mesh_import.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <exception>
#include <iostream>
#include <new>
#include <stdexcept>

#include <OpenMesh/Core/IO/MeshIO.hh>
#include <OpenMesh/Core/Mesh/PolyMesh_ArrayKernelT.hh>

#include "core/base/quiet_stream.h"
#include "core/mesh/loop_control.h"
#include "core/mesh/mesh_readers.h"
#include "core/mesh/open_mesh_adapter.h"

namespace isoslider::mesh {
namespace {

using PolyMesh = OpenMesh::PolyMesh_ArrayKernelT<DoubleTraits>;

// Meshes are read whole: this many bytes hold some hundred million triangles.
constexpr std::uint64_t kMaxFileBytes = std::uint64_t{16} << 30;

struct BadMesh : std::runtime_error {
    using std::runtime_error::runtime_error;
};
/// The only way out of OpenMesh's reader.
struct Stopped : std::exception {};

/// OpenMesh's importer stores whatever handles a native file holds; here they have to exist.
class CheckedImporter final : public OpenMesh::IO::ImporterT<PolyMesh> {
public:
    CheckedImporter(PolyMesh& target, const JobControl& job)
        : ImporterT(target), target_(target), loop_(job, 0, "reading") {}
    using ImporterT::add_face;
    using ImporterT::add_vertex;
    using ImporterT::set_face;

    OpenMesh::HalfedgeHandle add_edge(OpenMesh::VertexHandle a, OpenMesh::VertexHandle b) override {
        check(a.idx(), target_.n_vertices());
        check(b.idx(), target_.n_vertices());
        return ImporterT::add_edge(a, b);
    }
    OpenMesh::FaceHandle add_face(OpenMesh::HalfedgeHandle first) override {
        check(first.idx(), target_.n_halfedges());
        return ImporterT::add_face(first);
    }
    OpenMesh::FaceHandle add_face(const VHandles& corners) override {
        for (const auto corner : corners)
            check(corner.idx(), target_.n_vertices());
        return ImporterT::add_face(corners);
    }
    void set_halfedge(OpenMesh::VertexHandle vertex, OpenMesh::HalfedgeHandle halfedge) override {
        check(vertex.idx(), target_.n_vertices());
        if (halfedge.idx() != -1) // an isolated vertex has none
            check(halfedge.idx(), target_.n_halfedges());
        ImporterT::set_halfedge(vertex, halfedge);
    }
    void set_next(OpenMesh::HalfedgeHandle halfedge, OpenMesh::HalfedgeHandle next) override {
        check(halfedge.idx(), target_.n_halfedges());
        check(next.idx(), target_.n_halfedges());
        ImporterT::set_next(halfedge, next);
    }
    // Faces may come after the halfedges that name them: checked once all are there.
    void set_face(OpenMesh::HalfedgeHandle halfedge, OpenMesh::FaceHandle face) override {
        check(halfedge.idx(), target_.n_halfedges());
        ImporterT::set_face(halfedge, face);
    }

private:
    void check(int index, std::size_t count) {
        if (!loop_.goesOn(0))
            throw Stopped();
        if (index < 0 || static_cast<std::size_t>(index) >= count)
            throw BadMesh("a halfedge structure names an element that is not there");
    }
    PolyMesh& target_;
    LoopControl loop_;
};

// What the importer could not see: halfedges read later than what points at them.
Status checkHandles(const PolyMesh& mesh, const std::filesystem::path& path) {
    const auto isIn = [](int index, std::size_t count) {
        return index >= 0 && static_cast<std::size_t>(index) < count;
    };
    for (const auto face : mesh.faces())
        if (!isIn(mesh.halfedge_handle(face).idx(), mesh.n_halfedges()))
            return makeError(ErrorCode::Corruption, "a face has no halfedge", path);
    for (const auto halfedge : mesh.halfedges())
        if (!isIn(mesh.to_vertex_handle(halfedge).idx(), mesh.n_vertices()) ||
            (!mesh.is_boundary(halfedge) && !isIn(mesh.next_halfedge_handle(halfedge).idx(), mesh.n_halfedges())))
            return makeError(ErrorCode::Corruption, "a halfedge leads nowhere", path);
    return {};
}

/// Vertices around a face; empty if they do not close within the mesh's number of vertices.
std::vector<std::int64_t> cornersOf(const PolyMesh& mesh, OpenMesh::FaceHandle face) {
    std::vector<std::int64_t> corners;
    const auto first = mesh.halfedge_handle(face);
    auto halfedge = first;
    do {
        if (corners.size() > mesh.n_vertices() || !halfedge.is_valid())
            return {};
        corners.push_back(mesh.to_vertex_handle(halfedge).idx());
        halfedge = mesh.next_halfedge_handle(halfedge);
    } while (halfedge != first);
    return corners;
}

/// One kind of chunk in a native file, in the order in which OpenMesh writes them.
struct OmChunk {
    std::uint16_t word; ///< its header without the size of its numbers
    unsigned unitBytes; ///< smallest size of a number: 4 for floats, 1 for whole numbers
    unsigned largestFactor; ///< by which the header may raise it, as a power of two
    std::uint64_t numbers;
};

/// OpenMesh believes sizes in its native format and asserts on what it does not expect, so the
/// whole chain of chunks is walked first. Read are version 2.2 files with positions, normals and
/// topology: what this program and plain OpenMesh programs write.
Status checkOmChunks(std::string_view bytes, const std::filesystem::path& path) {
    const auto refuse = [&](const char* what, std::uint64_t at) {
        return makeError(ErrorCode::InvalidArgument, std::string("is not a readable om mesh: ") + what, path, at);
    };
    if (bytes.size() < 18 || !bytes.starts_with("OM") || (bytes[2] != 'T' && bytes[2] != 'P') || bytes[3] != 0x42)
        return refuse("OpenMesh 2.2 expected in its first bytes", 0);
    std::uint32_t counts[3]; // vertices, faces, edges
    std::memcpy(counts, bytes.data() + 4, sizeof counts);
    const std::uint64_t vertices = counts[0], faces = counts[1], edges = counts[2];
    const OmChunk known[] = {{0x1600, 4, 1, 3 * vertices},
                             {0x1620, 4, 1, 3 * vertices},
                             {0x16f8, 1, 2, 6 * edges}, // per halfedge: next, vertex, face
                             {0x06e0, 1, 2, vertices},
                             {0x06e8, 1, 2, faces}};
    std::size_t rank = 0;
    for (std::uint64_t at = 16; at + 2 <= bytes.size();) {
        const auto word = static_cast<std::uint16_t>(static_cast<unsigned char>(bytes[at]) |
                                                     static_cast<unsigned char>(bytes[at + 1]) << 8);
        if (word == 0x001c && at + 2 == bytes.size() && (rank == std::size(known) || vertices == 0))
            return {};
        while (rank < std::size(known) && known[rank].word != (word & 0x3fff))
            ++rank;
        const unsigned factor = word >> 14;
        if (rank == std::size(known) || factor > known[rank].largestFactor)
            return refuse("a chunk of unknown kind", at);
        at += 2 + (known[rank].numbers * known[rank].unitBytes << factor);
        ++rank;
    }
    return makeError(ErrorCode::Corruption, "file ends early, or its chunks do not add up", path);
}

// A native OpenMesh file holds halfedges, which only a real mesh can take.
Result<TriangleSoup> readOm(std::string_view bytes, const std::filesystem::path& path, const JobControl& job) {
    ISO_TRY(checkOmChunks(bytes, path));
    PolyMesh mesh;
    bool isRead = false;
    {
        const QuietStream quietErrors(std::cerr), quietLog(std::clog);
        CheckedImporter importer(mesh, job);
        OpenMesh::IO::Options options = OpenMesh::IO::Options::Binary;
        isRead = OpenMesh::IO::IOManager().read(path.string(), importer, options);
    }
    if (!isRead)
        return makeError(ErrorCode::InvalidArgument, "is not a readable om mesh", path);
    ISO_TRY(checkHandles(mesh, path));
    TriangleSoup soup;
    for (const auto vertex : mesh.vertices()) {
        const auto& p = mesh.point(vertex);
        soup.positions.emplace_back(p[0], p[1], p[2]);
    }
    LoopControl loop(job, mesh.n_faces(), "reading");
    for (const auto face : mesh.faces()) {
        if (!loop.goesOn(static_cast<std::uint64_t>(face.idx())))
            return cancelledError();
        const auto corners = cornersOf(mesh, face);
        if (corners.empty())
            return makeError(ErrorCode::Corruption, "the halfedges of a face do not close", path);
        ISO_TRY(addPolygon(soup, corners, path));
    }
    ISO_TRY(checkIndices(soup, path));
    return soup;
}

Result<TriangleSoup> readAs(const std::string& suffix, std::string_view bytes, const std::filesystem::path& path,
                            const JobControl& job) {
    if (suffix == ".ply")
        return readPly(bytes, path, job);
    if (suffix == ".obj")
        return readObj(bytes, path, job);
    if (suffix == ".off")
        return readOff(bytes, path, job);
    if (suffix == ".stl")
        return readStl(bytes, path, job);
    return readOm(bytes, path, job);
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

/// A whole file; refuses folders, pipes and devices.
Result<std::vector<std::byte>> readBytes(const std::filesystem::path& path, const JobControl& job) {
    constexpr std::uint64_t kChunkBytes = std::uint64_t{16} << 20;
    const auto file = defaultFileSystem().openForReading(path);
    if (!file.isOk())
        return file.error();
    const std::uint64_t size = file.value()->sizeBytes();
    if (size > kMaxFileBytes)
        return makeError(ErrorCode::InvalidArgument, "has more bytes than a mesh that is read may have", path);
    std::vector<std::byte> bytes(size);
    for (std::uint64_t at = 0; at < size; at += kChunkBytes) {
        if (job.isStopRequested())
            return cancelledError();
        job.report(0.5 * static_cast<double>(at) / static_cast<double>(size), "reading");
        ISO_TRY(file.value()->readExactlyAt(at, std::span(bytes).subspan(at, std::min(kChunkBytes, size - at))));
    }
    return bytes;
}

Result<TriangleSoup> readChecked(const std::filesystem::path& path, const JobControl& job) {
    const auto file = readBytes(path, job);
    if (!file.isOk())
        return file.error();
    const std::string suffix = meshSuffix(path);
    if (suffix.empty())
        return makeError(ErrorCode::InvalidArgument, "is not a mesh file: expected .ply .obj .stl .off or .om", path);
    const JobControl parsing = job.part(0.5, 1.0);
    auto soup =
        readAs(suffix, {reinterpret_cast<const char*>(file.value().data()), file.value().size()}, path, parsing);
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

Result<TriangleSoup> readMeshFile(const std::filesystem::path& path, const JobControl& job) {
    silenceOpenMesh();
    try {
        return readChecked(path, job);
    } catch (const Stopped&) {
        return cancelledError();
    } catch (const BadMesh& problem) {
        return makeError(ErrorCode::Corruption, problem.what(), path);
    } catch (const std::bad_alloc&) {
        return makeError(ErrorCode::OutOfSpace, "does not fit in memory", path);
    } catch (const std::exception& problem) {
        return makeError(ErrorCode::InvalidArgument, std::string("cannot be read as a mesh: ") + problem.what(), path);
    }
}

} // namespace isoslider::mesh
