// The welded mesh: what the bricks hold several times is kept once, in grid order.

#include <algorithm>
#include <limits>
#include <utility>

#include <tbb/parallel_for.h>

#include "core/extract/live/live_surface.h"
#include "core/extract/vertex_fans.h"

namespace isoslider::extract {

// Edges are sorted plane by plane, cells by the plane of their first corners: planes follow each other in the order of
// edge ids and cells, no list is long, and a wish to stop is noticed soon. Copies of a vertex in several bricks are
// equal to the bit, so any of them stands for all. O(n log n) for n vertices of a plane.
template <class Live>
class LiveSurface<Live>::Welding {
public:
    Welding(const LiveSurface& surface, double isovalue, const JobControl& job)
        : surface_(surface),
          isovalue_(static_cast<Live>(isovalue)),
          job_(job),
          dims_(surface.geometry_.dims),
          planes_(static_cast<std::size_t>(dims_[2])),
          bricksByLayer_(planes_.size() / kCellSide + 1) {
        mesh_.geometry = surface.geometry_;
        mesh_.isovalue = isovalue;
    }

    Result<SurfaceMesh> run() {
        listBricks();
        constexpr double kSteps = 5;
        ISO_TRY(forEachPlane([&](std::size_t z) { findVertices(z); }, 1 / kSteps));
        ISO_TRY(forEachLayer([&](std::size_t layer) { findCells(layer); }, 2 / kSteps));
        ISO_TRY(makeRoom());
        ISO_TRY(forEachPlane([&](std::size_t z) { writeVertices(z); }, 3 / kSteps));
        ISO_TRY(forEachPlane([&](std::size_t z) { writeCells(z); }, 4 / kSteps));
        if (surface_.hasMissing_)
            ISO_TRY(splitVerticesOfSeveralFans(mesh_, job_));
        job_.report(1.0, kStage);
        return std::move(mesh_);
    }

private:
    static constexpr std::string_view kStage = "joining the bricks";
    struct Vertex {
        EdgeId edge;
        BrickSlot slot;
        std::uint32_t number; ///< within the brick
    };
    struct Cell {
        std::uint64_t place; ///< of its first point in the grid
        BrickSlot slot;
        std::uint32_t firstIndex;
        std::uint16_t indexCount, firstInner; ///< within the brick
        std::uint8_t innerVertices;
    };
    struct Plane {
        std::vector<Vertex> vertices; ///< one for each edge that starts in it, in order
        std::vector<Cell> cells; ///< that start in it, in order
        std::uint64_t innerVertices = 0, indices = 0;
        std::uint64_t firstVertex = 0, firstInner = 0, firstIndex = 0; ///< in the mesh
    };

    template <class Work>
    Status forEachPlane(const Work& work, double done) {
        return forEachOf(planes_.size(), work, done);
    }
    template <class Work>
    Status forEachLayer(const Work& work, double done) {
        return forEachOf(bricksByLayer_.size(), work, done);
    }
    template <class Work>
    Status forEachOf(std::size_t count, const Work& work, double done) {
        tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
            if (!job_.isStopRequested())
                work(i);
        });
        if (job_.isStopRequested())
            return cancelledError();
        job_.report(done, kStage);
        return {};
    }

    void listBricks() {
        firstVertex_.resize(surface_.slotCount() + 1, 0);
        for (const BrickSlot slot : surface_.slots()) {
            const Brick& brick = surface_.bricks_[slot.index()];
            firstVertex_[slot.index() + 1] = firstVertex_[slot.index()] + brick.edgeVertices + brick.innerVertices;
            if (brick.indexCount > 0)
                bricksByLayer_[static_cast<std::size_t>(surface_.shapes_.origin(brick.index)[2] / kCellSide)].push_back(
                    slot);
        }
        newNumbers_.resize(firstVertex_.back());
    }

    std::uint64_t placeOf(const std::array<std::int32_t, 3>& origin, ClosedPoint p) const {
        const auto c = coordsOf(p);
        return static_cast<std::uint64_t>(origin[0] + c[0] +
                                          dims_[0] * (origin[1] + c[1] + dims_[1] * std::int64_t{origin[2] + c[2]}));
    }

    // Of a brick's vertices those on edges that start in one of its planes: a stretch for each axis.
    template <class Visit>
    void forEachEdgeIn(BrickSlot slot, int z, const Visit& visit) const {
        const VertexCode* const first = surface_.codes(slot);
        const VertexCode* const last = first + surface_.bricks_[slot.index()].edgeVertices;
        const auto isBefore = [](VertexCode code, ClosedEdge edge) { return edgeOf(code) < edge; };
        for (int axis = 0; axis < 3; ++axis) {
            const ClosedEdge edge = closedEdge(axis, closedPoint(0, 0, z));
            const VertexCode* code = std::lower_bound(first, last, edge, isBefore);
            for (; code != last && edgeOf(*code) < edge + kPointStride[2]; ++code)
                visit(edgeOf(*code), static_cast<std::uint32_t>(code - first));
        }
    }

    void findVertices(std::size_t z) {
        std::vector<Vertex> copies;
        const auto take = [&](std::size_t layer, int local) {
            for (const BrickSlot slot : bricksByLayer_[layer]) {
                const auto origin = surface_.shapes_.origin(surface_.bricks_[slot.index()].index);
                forEachEdgeIn(slot, local, [&](ClosedEdge edge, std::uint32_t number) {
                    copies.push_back(
                        {4 * placeOf(origin, startOf(edge)) + static_cast<unsigned>(axisOf(edge)), slot, number});
                });
            }
        };
        if (z % kCellSide == 0 && z > 0)
            take(z / kCellSide - 1, kCellSide);
        take(z / kCellSide, static_cast<int>(z % kCellSide));
        std::sort(copies.begin(), copies.end(), [](const Vertex& a, const Vertex& b) {
            return a.edge != b.edge ? a.edge < b.edge : a.slot < b.slot;
        });
        std::size_t kept = 0;
        for (const Vertex& copy : copies) {
            if (kept == 0 || copies[kept - 1].edge != copy.edge)
                copies[kept++] = copy;
            newNumbers_[firstVertex_[copy.slot.index()] + copy.number] = static_cast<std::uint32_t>(kept - 1);
        }
        copies.resize(kept);
        copies.shrink_to_fit();
        planes_[z].vertices = std::move(copies);
    }

    void findCells(std::size_t layer) {
        const std::size_t firstPlane = layer * kCellSide;
        for (const BrickSlot slot : bricksByLayer_[layer]) {
            const auto origin = surface_.shapes_.origin(surface_.bricks_[slot.index()].index);
            std::uint16_t inner = surface_.bricks_[slot.index()].edgeVertices;
            surface_.forEachCell(slot, [&](const SurfaceCell& cell) {
                Plane& plane = planes_[firstPlane + static_cast<std::size_t>(coordsOf(cell.cell)[2])];
                plane.cells.push_back(
                    {placeOf(origin, cell.cell), slot, cell.firstIndex, cell.indexCount, inner, cell.innerVertices});
                plane.innerVertices += cell.innerVertices;
                plane.indices += cell.indexCount;
                inner = static_cast<std::uint16_t>(inner + cell.innerVertices);
            });
        }
        for (std::size_t z = firstPlane;
             z < std::min(firstPlane + kCellSide, planes_.size()) && !job_.isStopRequested(); ++z)
            std::sort(planes_[z].cells.begin(), planes_[z].cells.end(),
                      [](const Cell& a, const Cell& b) { return a.place < b.place; });
    }

    Status makeRoom() {
        std::uint64_t edgeVertices = 0, innerVertices = 0, indices = 0;
        for (Plane& plane : planes_) {
            plane.firstVertex = std::exchange(edgeVertices, edgeVertices + plane.vertices.size());
            plane.firstInner = std::exchange(innerVertices, innerVertices + plane.innerVertices);
            plane.firstIndex = std::exchange(indices, indices + plane.indices);
        }
        if (edgeVertices + innerVertices > std::numeric_limits<std::uint32_t>::max())
            return makeError(ErrorCode::OutOfSpace, "the surface has more than 2^32 vertices");
        for (Plane& plane : planes_)
            plane.firstInner += edgeVertices;
        mesh_.positions.resize(edgeVertices + innerVertices);
        mesh_.normals.resize(edgeVertices + innerVertices);
        mesh_.edgeIds.resize(edgeVertices);
        mesh_.triangles.resize(indices);
        return {};
    }

    void writeVertex(std::uint64_t at, BrickSlot slot, std::uint32_t number) {
        const Brick& brick = surface_.bricks_[slot.index()];
        const MeshVertex vertex =
            vertexOf(surface_.recordOf(slot, number), surface_.shapes_.origin(brick.index), isovalue_);
        mesh_.positions[at] = vertex.position;
        mesh_.normals[at] = vertex.normal;
    }

    void writeVertices(std::size_t z) {
        Plane& plane = planes_[z];
        std::uint64_t at = plane.firstVertex;
        for (const Vertex& vertex : plane.vertices) {
            mesh_.edgeIds[at] = vertex.edge;
            writeVertex(at++, vertex.slot, vertex.number);
        }
        plane.vertices = {};
    }

    void writeCells(std::size_t z) {
        Plane& plane = planes_[z];
        std::uint64_t inner = plane.firstInner, index = plane.firstIndex;
        std::array<std::uint64_t, kPointSide> firstVertex{}; // of the planes of the cells' layer
        const std::size_t layerPlane = z / kCellSide * kCellSide;
        for (std::size_t k = 0; k < kPointSide && layerPlane + k < planes_.size(); ++k)
            firstVertex[k] = planes_[layerPlane + k].firstVertex;
        for (const Cell& cell : plane.cells) {
            const Brick& brick = surface_.bricks_[cell.slot.index()];
            const VertexCode* const codes = surface_.codes(cell.slot);
            const std::uint64_t ownInner = inner;
            for (std::uint32_t k = 0; k < cell.innerVertices; ++k)
                writeVertex(inner++, cell.slot, cell.firstInner + k);
            const std::uint16_t* const local = surface_.arenas_->indices.at(brick.indices.begin) + cell.firstIndex;
            for (std::size_t k = 0; k < cell.indexCount; ++k) {
                const std::uint32_t number = local[k];
                mesh_.triangles[index++] = static_cast<std::uint32_t>(
                    number >= brick.edgeVertices
                        ? ownInner + (number - cell.firstInner)
                        : firstVertex[static_cast<std::size_t>(coordsOf(startOf(edgeOf(codes[number])))[2])] +
                              newNumbers_[firstVertex_[cell.slot.index()] + number]);
            }
        }
        plane.cells = {};
    }

    const LiveSurface& surface_;
    Live isovalue_;
    const JobControl& job_;
    const GridDims& dims_;
    SurfaceMesh mesh_;
    std::vector<Plane> planes_;
    std::vector<std::vector<BrickSlot>> bricksByLayer_;
    std::vector<std::uint64_t> firstVertex_; ///< by slot: where its vertices' numbers begin in newNumbers_
    std::vector<std::uint32_t> newNumbers_; ///< within the plane; of vertices on edges only
};

template <class Live>
Result<SurfaceMesh> LiveSurface<Live>::mesh(double isovalue, const JobControl& job) const {
    return Welding(*this, isovalue, job).run();
}

template Result<SurfaceMesh> LiveSurface<float>::mesh(double, const JobControl&) const;
template Result<SurfaceMesh> LiveSurface<double>::mesh(double, const JobControl&) const;

} // namespace isoslider::extract
