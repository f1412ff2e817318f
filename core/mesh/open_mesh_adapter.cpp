#include "core/mesh/open_mesh_adapter.h"

#include <mutex>

#include "core/mesh/loop_control.h"

namespace isoslider::mesh {
namespace {

template <class Mesh>
class Filler {
public:
    Filler(const TriangleSoup& soup, Mesh& mesh, const JobControl& job)
        : soup_(soup),
          mesh_(mesh),
          loop_(job, soup.positions.size() + soup.triangles.size(), "checking with OpenMesh") {
        mesh_.reserve(soup.positions.size(), 3 * soup.triangles.size() / 2 + 1, soup.triangles.size());
        if (!soup.normals.empty())
            mesh_.request_vertex_normals();
    }

    Result<std::uint64_t> run(RefusedFaces refused) {
        const std::size_t vertices = soup_.positions.size();
        for (std::uint32_t i = 0; i < vertices; ++i) {
            addVertex(i);
            if (!loop_.goesOn(i))
                return cancelledError();
        }
        std::uint64_t refusals = 0;
        for (std::size_t i = 0; i < soup_.triangles.size(); ++i) {
            const Triangle& t = soup_.triangles[i];
            if (!loop_.goesOn(vertices + i))
                return cancelledError();
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
        const auto vertex =
            mesh_.add_vertex(Point(static_cast<Scalar>(p.x), static_cast<Scalar>(p.y), static_cast<Scalar>(p.z)));
        if (!soup_.normals.empty()) {
            const glm::vec3& n = soup_.normals[i];
            mesh_.set_normal(vertex, typename Mesh::Normal(n.x, n.y, n.z));
        }
        return vertex;
    }

    const TriangleSoup& soup_;
    Mesh& mesh_;
    LoopControl loop_;
};

} // namespace

template <class Mesh>
Result<std::uint64_t> fillOpenMesh(const TriangleSoup& soup, RefusedFaces refused, Mesh& mesh, const JobControl& job) {
    silenceOpenMesh();
    return Filler<Mesh>(soup, mesh, job).run(refused);
}

template Result<std::uint64_t> fillOpenMesh(const TriangleSoup&, RefusedFaces, FloatMesh&, const JobControl&);
template Result<std::uint64_t> fillOpenMesh(const TriangleSoup&, RefusedFaces, DoubleMesh&, const JobControl&);

void silenceOpenMesh() {
    static std::once_flag once;
    std::call_once(once, [] {
        omlog().disable();
        omout().disable();
        omerr().disable();
    });
}

} // namespace isoslider::mesh
