#include "core/mesh/mesh_import.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>

#include <OpenMesh/Core/IO/MeshIO.hh>
#include <OpenMesh/Core/Mesh/PolyMesh_ArrayKernelT.hh>

#include "core/base/file_system.h"
#include "core/mesh/open_mesh_adapter.h"

namespace isoslider::mesh {
namespace {

using PolyMesh = OpenMesh::PolyMesh_ArrayKernelT<DoubleTraits>;

struct BadMesh : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// Takes vertices and faces from OpenMesh's readers as they stand in the file. OpenMesh's own
/// importer builds a halfedge mesh, which cannot hold the faces that a check is looking for.
class SoupImporter final : public OpenMesh::IO::ImporterT<PolyMesh> {
public:
    // Every vertex and face takes more than a byte in any of the formats, so `maxElements`, the
    // file's size, bounds what a header may ask for.
    SoupImporter(PolyMesh& unused, TriangleSoup& soup, std::uint64_t maxElements)
        : ImporterT(unused), soup_(soup), maxElements_(maxElements) {}

    using ImporterT::add_face;

    void reserve(unsigned int vertices, unsigned int, unsigned int faces) override {
        if (vertices > maxElements_ || faces > maxElements_)
            throw BadMesh("the header asks for more vertices or faces than the file can hold");
        announced_ = {vertices, faces};
        soup_.positions.reserve(vertices);
        soup_.triangles.reserve(faces);
    }

    OpenMesh::VertexHandle add_vertex() override { return add_vertex(OpenMesh::Vec3d(0.0)); }
    OpenMesh::VertexHandle add_vertex(const OpenMesh::Vec3f& p) override {
        return add_vertex(OpenMesh::Vec3d(p[0], p[1], p[2]));
    }
    OpenMesh::VertexHandle add_vertex(const OpenMesh::Vec3d& p) override {
        if (soup_.positions.size() >= std::min<std::uint64_t>(maxElements_, std::numeric_limits<int>::max()))
            throw BadMesh("has more vertices than the file can hold");
        soup_.positions.emplace_back(p[0], p[1], p[2]);
        return OpenMesh::VertexHandle(static_cast<int>(soup_.positions.size() - 1));
    }
    void set_point(OpenMesh::VertexHandle vertex, const OpenMesh::Vec3f& p) override {
        soup_.positions.at(static_cast<std::size_t>(vertex.idx())) = {p[0], p[1], p[2]};
    }

    OpenMesh::FaceHandle add_face(const VHandles& corners) override {
        for (const auto corner : corners)
            if (corner.idx() < 0 || static_cast<std::size_t>(corner.idx()) >= soup_.positions.size())
                throw BadMesh("face " + std::to_string(faces_) + " names vertex " + std::to_string(corner.idx()) +
                              " of " + std::to_string(soup_.positions.size()));
        const auto index = [&](std::size_t i) { return static_cast<std::uint32_t>(corners[i].idx()); };
        for (std::size_t i = 2; i < corners.size(); ++i)
            soup_.triangles.push_back({index(0), index(i - 1), index(i)});
        return OpenMesh::FaceHandle(static_cast<int>(faces_++));
    }

    // The base class would look these up in its mesh, which stays empty.
    void add_face_texcoords(OpenMesh::FaceHandle, OpenMesh::VertexHandle,
                            const std::vector<OpenMesh::Vec2f>&) override {}
    void add_face_texcoords(OpenMesh::FaceHandle, OpenMesh::VertexHandle,
                            const std::vector<OpenMesh::Vec3f>&) override {}
    void set_face_texindex(OpenMesh::FaceHandle, int) override {}
    void add_texture_information(int, std::string) override {}
    void request_face_texcoords2D() override {}
    size_t n_vertices() const override { return soup_.positions.size(); }
    size_t n_faces() const override { return faces_; }
    void prepare() override {}
    void finish() override {}

    bool hasAllAnnounced() const {
        return !announced_ || (announced_->first == soup_.positions.size() && announced_->second == faces_);
    }

private:
    TriangleSoup& soup_;
    std::uint64_t maxElements_;
    std::uint64_t faces_ = 0;
    std::optional<std::pair<std::uint64_t, std::uint64_t>> announced_;
};

Error notAMesh(const std::filesystem::path& path) {
    return makeError(ErrorCode::InvalidArgument, "is not a readable " + meshSuffix(path).substr(1) + " mesh", path);
}

Result<TriangleSoup> readThroughOpenMesh(const std::filesystem::path& path, std::uint64_t sizeBytes) {
    PolyMesh unused;
    TriangleSoup soup;
    SoupImporter importer(unused, soup, sizeBytes);
    OpenMesh::IO::Options options;
    if (!OpenMesh::IO::IOManager().read(path.string(), importer, options))
        return notAMesh(path);
    if (meshSuffix(path) != ".obj" && !importer.hasAllAnnounced())
        return makeError(ErrorCode::Corruption, "file ends early: fewer vertices or faces than its header says", path);
    return soup;
}

// A native OpenMesh file holds halfedges, which only a real mesh can take.
Result<TriangleSoup> readOm(const std::filesystem::path& path) {
    PolyMesh mesh;
    if (!OpenMesh::IO::read_mesh(mesh, path.string()))
        return notAMesh(path);
    TriangleSoup soup;
    for (const auto vertex : mesh.vertices()) {
        const auto& p = mesh.point(vertex);
        soup.positions.emplace_back(p[0], p[1], p[2]);
    }
    for (const auto face : mesh.faces()) {
        std::vector<std::uint32_t> corners;
        for (const auto vertex : mesh.fv_range(face))
            corners.push_back(static_cast<std::uint32_t>(vertex.idx()));
        for (std::size_t i = 2; i < corners.size(); ++i)
            soup.triangles.push_back({corners[0], corners[i - 1], corners[i]});
    }
    return soup;
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
    auto file = defaultFileSystem().openForReading(path); // before OpenMesh, which would wait on a pipe
    if (!file.isOk())
        return std::move(file).error();
    const std::string suffix = meshSuffix(path);
    if (suffix.empty())
        return makeError(ErrorCode::InvalidArgument, "is not a mesh file: expected .ply .obj .stl .off or .om", path);
    try {
        auto soup = suffix == ".stl"  ? readStl(path)
                    : suffix == ".om" ? readOm(path)
                                      : readThroughOpenMesh(path, file.value()->sizeBytes());
        if (soup.isOk())
            ISO_TRY(checkFinite(soup.value(), path));
        return soup;
    } catch (const BadMesh& problem) {
        return makeError(ErrorCode::InvalidArgument, problem.what(), path);
    } catch (const std::bad_alloc&) {
        return makeError(ErrorCode::OutOfSpace, "does not fit in memory", path);
    } catch (const std::exception& problem) {
        return makeError(ErrorCode::InvalidArgument, std::string("cannot be read as a mesh: ") + problem.what(), path);
    }
}

} // namespace isoslider::mesh
