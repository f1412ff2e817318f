#include "core/mesh/open_mesh_adapter.h"

#include <mutex>

namespace isoslider::mesh {
namespace {

template <class Mesh>
class Filler {
public:
    Filler(const TriangleSoup& soup, Mesh& mesh) : soup_(soup), mesh_(mesh) {
        mesh_.reserve(soup.positions.size(), 3 * soup.triangles.size() / 2 + 1, soup.triangles.size());
        if (!soup.normals.empty())
            mesh_.request_vertex_normals();
        for (std::uint32_t i = 0; i < soup.positions.size(); ++i)
            addVertex(i);
    }

    std::uint64_t run(RefusedFaces refused) {
        std::uint64_t refusals = 0;
        for (const Triangle& t : soup_.triangles) {
            if (hasThreeVertices(t) && mesh_.add_face(handle(t[0]), handle(t[1]), handle(t[2])).is_valid())
                continue;
            ++refusals;
            if (refused == RefusedFaces::Separate && hasThreeVertices(t))
                mesh_.add_face(addVertex(t[0]), addVertex(t[1]), addVertex(t[2]));
        }
        return refusals;
    }

private:
    static OpenMesh::VertexHandle handle(std::uint32_t index) {
        return OpenMesh::VertexHandle(static_cast<int>(index));
    }

    OpenMesh::VertexHandle addVertex(std::uint32_t i) {
        using Point = typename Mesh::Point;
        using Scalar = typename OpenMesh::vector_traits<Point>::value_type;
        const glm::dvec3& p = soup_.positions[i];
        const auto vertex = mesh_.add_vertex(
            Point(static_cast<Scalar>(p.x), static_cast<Scalar>(p.y), static_cast<Scalar>(p.z)));
        if (!soup_.normals.empty()) {
            const glm::vec3& n = soup_.normals[i];
            mesh_.set_normal(vertex, typename Mesh::Normal(n.x, n.y, n.z));
        }
        return vertex;
    }

    const TriangleSoup& soup_;
    Mesh& mesh_;
};

} // namespace

template <class Mesh>
std::uint64_t fillOpenMesh(const TriangleSoup& soup, RefusedFaces refused, Mesh& mesh) {
    silenceOpenMesh();
    return Filler<Mesh>(soup, mesh).run(refused);
}

template std::uint64_t fillOpenMesh(const TriangleSoup&, RefusedFaces, FloatMesh&);
template std::uint64_t fillOpenMesh(const TriangleSoup&, RefusedFaces, DoubleMesh&);

void silenceOpenMesh() {
    static std::once_flag once;
    std::call_once(once, [] {
        omlog().disable();
        omout().disable();
        omerr().disable();
    });
}

} // namespace isoslider::mesh
