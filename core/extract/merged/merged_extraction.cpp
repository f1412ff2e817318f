#include "core/extract/merged/merged_extraction.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <utility>

#include <glm/geometric.hpp>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include "core/cell/cell_states.h"
#include "core/extract/edge_interpolation.h"
#include "core/extract/inner_vertices.h"
#include "core/extract/merged/merged_polygon.h"
#include "core/extract/vertex_fans.h"
#include "core/grid/classification.h"
#include "core/grid/gradient.h"

namespace isoslider::extract {
namespace {

using Place = std::array<std::int64_t, 3>;

// In the triangles of a layer, before vertices are numbered: vertices inside cells, by their number in the layer.
constexpr std::uint64_t kInner = std::uint64_t{1} << 63;

struct Vertex {
    glm::vec3 position, normal;
};

template <class Sample>
class MergedExtractor {
    using Live = LiveOf<Sample>;

public:
    MergedExtractor(const ScalarGrid& grid, double isovalue, const JobControl& job)
        : view_{grid.values<Sample>().data(), grid.dims()},
          isovalue_(isovalue),
          job_(job),
          inverseSpacing_(inverseSpacingOf(grid.geometry())) {}

    Status run(const MergeBound& bound, int maxLevel, SurfaceMesh& mesh) {
        if (std::any_of(view_.dims.begin(), view_.dims.end(), [](std::int64_t n) { return n < 2; }))
            return {};
        leaves_ = LeafLevels::find(view_, isovalue_, bound, maxLevel, job_);
        job_.report(0.3, "extracting");
        if (job_.isStopRequested())
            return cancelledError();
        layers_.resize(static_cast<std::size_t>((leaves_.cells()[2] + kLayer - 1) / kLayer));
        tbb::parallel_for(std::size_t{0}, layers_.size(), [&](std::size_t i) {
            if (!job_.isStopRequested())
                extractLayer(static_cast<std::int64_t>(i) * kLayer, layers_[i]);
        });
        job_.report(0.8, "extracting");
        if (job_.isStopRequested())
            return cancelledError();
        ISO_TRY(assemble(mesh));
        if constexpr (std::is_floating_point_v<Sample>)
            ISO_TRY(splitVerticesOfSeveralFans(mesh, job_));
        return {};
    }

    LeafCounts activeLeaves() const {
        LeafCounts sum{};
        for (const Layer& layer : layers_)
            for (std::size_t n = 0; n < sum.size(); ++n)
                sum[n] += layer.activeLeaves[n];
        return sum;
    }

private:
    static constexpr std::int64_t kLayer = std::int64_t{1} << kMaxMergeLevel; // cells: no leaf is in two layers

    // What is made of the leaves of one layer.
    struct Layer {
        std::vector<std::uint64_t> corners; // of triangles, three each: edge ids, or kInner + number
        std::vector<Vertex> inner;
        LeafCounts activeLeaves{};
    };

    Sample sampleAt(const Place& p) const { return view_.samples[view_.offset(p[0], p[1], p[2])]; }
    bool isAboveAt(const Place& p) const { return isAbove(sampleAt(p), isovalue_); }
    EdgeId edgeIdOf(const Place& start, int axis) const {
        return 4 * static_cast<EdgeId>(view_.offset(start[0], start[1], start[2])) + static_cast<EdgeId>(axis);
    }
    Place placeOf(std::int64_t point) const {
        const GridDims& dims = view_.dims;
        return {point % dims[0], point / dims[0] % dims[1], point / (dims[0] * dims[1])};
    }

    // --- leaves --------------------------------------------------------------------------------------

    void extractLayer(std::int64_t firstZ, Layer& layer) {
        const GridDims& cells = leaves_.cells();
        for (std::int64_t z = firstZ; z < std::min(firstZ + kLayer, cells[2]); ++z)
            for (std::int64_t y = 0; y < cells[1]; ++y)
                for (std::int64_t x = 0; x < cells[0]; ++x) {
                    const int level = leaves_.level(x, y, z);
                    const std::int64_t inside = (std::int64_t{1} << level) - 1;
                    if ((x & inside) == 0 && (y & inside) == 0 && (z & inside) == 0)
                        extractLeaf({x, y, z}, level, layer);
                }
    }

    void extractLeaf(const Place& origin, int level, Layer& layer) const {
        const std::int64_t side = std::int64_t{1} << level;
        unsigned signs = 0;
        cell::CornerScalars scalars;
        for (std::int64_t c = 0; c < 8; ++c) {
            const Sample sample =
                sampleAt({origin[0] + side * (c & 1), origin[1] + side * (c >> 1 & 1), origin[2] + side * (c >> 2)});
            if (isMissing(sample))
                return;
            signs |= static_cast<unsigned>(isAbove(sample, isovalue_)) << c;
            scalars[static_cast<std::size_t>(c)] = static_cast<double>(sample);
        }
        if (signs == 0 || signs == 255)
            return;
        ++layer.activeLeaves[static_cast<std::size_t>(level)];
        if (level == 0)
            extractCell(origin, static_cast<std::uint8_t>(signs), scalars, layer);
        else
            extractMergedCell(origin, level, layer);
    }

    void extractCell(const Place& origin, std::uint8_t signs, const cell::CornerScalars& scalars, Layer& layer) const {
        const cell::StateId id =
            cell::isAmbiguous(signs) ? cell::resolveCell(signs, scalars, isovalue_).state : cell::StateId{signs};
        const cell::CellState& state = cell::cellStates()[id];
        std::array<EdgeId, 12> edges{};
        for (std::size_t e = 0; e < 12; ++e) {
            const int corner = cell::kCellEdges[e].lowerCorner;
            edges[e] = edgeIdOf({origin[0] + (corner & 1), origin[1] + (corner >> 1 & 1), origin[2] + (corner >> 2)},
                                cell::kCellEdges[e].axis);
        }
        for (const std::uint8_t v : state.triangles)
            layer.corners.push_back(v < cell::kInnerVertex ? edges[v]
                                                           : kInner + layer.inner.size() + v - cell::kInnerVertex);
        if (state.innerVertices == 0)
            return;
        InnerVertexCell placed;
        placed.state = &state;
        placed.origin = origin;
        placed.scalars = scalars;
        for (unsigned mask = cell::activeEdges(signs); mask != 0; mask &= mask - 1) {
            const auto e = static_cast<std::size_t>(std::countr_zero(mask));
            const Vertex vertex = vertexOn(edges[e]);
            placed.edgePositions[e] = vertex.position;
            placed.edgeNormals[e] = vertex.normal;
        }
        std::array<InnerVertex, cell::kMaxInnerVertices> inner;
        placeInnerVertices(placed, isovalue_, inverseSpacing_, inner.data());
        for (std::size_t k = 0; k < state.innerVertices; ++k)
            layer.inner.push_back({positionOf(inner[k], origin), decodeNormal(inner[k].normal)});
    }

    // --- merged cells ----------------------------------------------------------------------------------

    // What polygons and vertices ask of the leaves.
    struct Leaves {
        const MergedExtractor& of;
        std::int64_t pointStride(std::size_t axis) const { return of.view_.stride(static_cast<int>(axis)); }
        std::int64_t cellStride(std::size_t axis) const { return of.leaves_.stride(axis); }
        std::array<std::int32_t, 3> coordsOf(std::int64_t point) const {
            const Place p = of.placeOf(point);
            return {static_cast<std::int32_t>(p[0]), static_cast<std::int32_t>(p[1]), static_cast<std::int32_t>(p[2])};
        }
        std::int64_t cellAt(std::int64_t point) const {
            const Place p = of.placeOf(point);
            return of.leaves_.placeOf(p[0], p[1], p[2]);
        }
        bool isAboveAt(std::int64_t point) const { return isAbove(of.view_.samples[point], of.isovalue_); }
        int levelAt(std::int64_t cell) const { return of.leaves_.levelAt(cell); }
    };

    void extractMergedCell(const Place& origin, int level, Layer& layer) const {
        thread_local MergedPolygon<Leaves> polygon;
        polygon.make(Leaves{*this}, {view_.offset(origin[0], origin[1], origin[2]),
                                     leaves_.placeOf(origin[0], origin[1], origin[2]), level});
        const auto corners = polygon.corners();
        for (const auto& triangle : polygon.triangles())
            for (const std::uint32_t corner : triangle)
                layer.corners.push_back(static_cast<EdgeId>(corners[corner]));
        if (polygon.triangles().empty())
            spanFromCentre(origin, level, corners, layer);
    }

    void spanFromCentre(const Place& origin, int level, std::span<const std::int64_t> loop, Layer& layer) const {
        std::vector<glm::vec3> positions, normals;
        for (std::size_t i = 0; i < loop.size(); ++i) {
            const auto edge = static_cast<EdgeId>(loop[i]);
            const Vertex vertex = vertexOn(edge);
            positions.push_back(vertex.position);
            normals.push_back(vertex.normal);
            layer.corners.insert(layer.corners.end(),
                                 {edge, static_cast<EdgeId>(loop[(i + 1) % loop.size()]), kInner + layer.inner.size()});
        }
        const InnerVertex centre = placeLoopCentre(positions, normals, origin, 1 << level);
        layer.inner.push_back({positionOf(centre, origin), decodeNormal(centre.normal)});
    }

    // --- vertices --------------------------------------------------------------------------------------

    Vertex vertexOn(EdgeId id) const {
        const Leaves leaves{*this};
        const auto edge = static_cast<std::int64_t>(id);
        const int axis = static_cast<int>(id % 4), level = smallestLevelAt(leaves, edge);
        const Place lower = placeOf(leafEdgeStart(leaves, edge, level));
        Place upper = lower;
        upper[id % 4] += std::int64_t{1} << level;
        const Live s1 = static_cast<Live>(sampleAt(lower)), s2 = static_cast<Live>(sampleAt(upper));
        const float t = static_cast<float>(edgeFraction<Live>(s1, s2, static_cast<Live>(isovalue_)));
        glm::vec3 position(static_cast<float>(lower[0]), static_cast<float>(lower[1]), static_cast<float>(lower[2]));
        position[axis] += t * static_cast<float>(std::int64_t{1} << level);
        return {position, edgeNormal(normalAt(lower), normalAt(upper), t, axis, s1 < s2)};
    }

    NormalCode normalAt(const Place& p) const {
        return normalOfGradient(gradientAt(view_, p[0], p[1], p[2], inverseSpacing_));
    }

    Status assemble(SurfaceMesh& mesh) {
        std::vector<std::uint64_t> innerBegin(layers_.size() + 1, 0), cornerBegin(layers_.size() + 1, 0);
        for (std::size_t i = 0; i < layers_.size(); ++i) {
            innerBegin[i + 1] = innerBegin[i] + layers_[i].inner.size();
            cornerBegin[i + 1] = cornerBegin[i] + layers_[i].corners.size();
            for (const std::uint64_t corner : layers_[i].corners)
                if (corner < kInner)
                    mesh.edgeIds.push_back(corner);
        }
        tbb::parallel_sort(mesh.edgeIds.begin(), mesh.edgeIds.end());
        mesh.edgeIds.erase(std::unique(mesh.edgeIds.begin(), mesh.edgeIds.end()), mesh.edgeIds.end());
        const std::uint64_t edges = mesh.edgeIds.size();
        if (edges + innerBegin.back() >= std::numeric_limits<std::uint32_t>::max())
            return makeError(ErrorCode::OutOfSpace, "the surface has more than 2^32 vertices");
        mesh.positions.resize(edges + innerBegin.back());
        mesh.normals.resize(edges + innerBegin.back());
        mesh.triangles.resize(cornerBegin.back());
        tbb::parallel_for(std::uint64_t{0}, edges, [&](std::uint64_t i) {
            const Vertex vertex = vertexOn(mesh.edgeIds[i]);
            mesh.positions[i] = vertex.position;
            mesh.normals[i] = vertex.normal;
        });
        tbb::parallel_for(std::size_t{0}, layers_.size(), [&](std::size_t i) {
            Layer& layer = layers_[i];
            for (std::size_t k = 0; k < layer.inner.size(); ++k) {
                mesh.positions[edges + innerBegin[i] + k] = layer.inner[k].position;
                mesh.normals[edges + innerBegin[i] + k] = layer.inner[k].normal;
            }
            for (std::size_t k = 0; k < layer.corners.size(); ++k) {
                const std::uint64_t corner = layer.corners[k];
                const std::uint64_t number =
                    corner >= kInner ? edges + innerBegin[i] + (corner - kInner)
                                     : static_cast<std::uint64_t>(
                                           std::lower_bound(mesh.edgeIds.begin(), mesh.edgeIds.end(), corner) -
                                           mesh.edgeIds.begin());
                mesh.triangles[cornerBegin[i] + k] = static_cast<std::uint32_t>(number);
            }
            layer.corners = {};
            layer.inner = {};
        });
        return {};
    }

    SampleView<Sample> view_;
    double isovalue_;
    const JobControl& job_;
    glm::vec3 inverseSpacing_{1.0f};
    LeafLevels leaves_;
    std::vector<Layer> layers_;
};

} // namespace

Result<SurfaceMesh> extractMerged(const ScalarGrid& grid, double isovalue, const MergeBound& bound, int maxLevel,
                                  const JobControl& job, LeafCounts* leaves) {
    SurfaceMesh mesh;
    mesh.geometry = grid.geometry();
    mesh.isovalue = isovalue;
    mesh.mergeBound = bound;
    const Status status = visitScalarType(grid.type(), [&](auto sample) {
        MergedExtractor<decltype(sample)> extractor(grid, isovalue, job);
        const Status done = extractor.run(bound, maxLevel, mesh);
        if (leaves != nullptr)
            *leaves = extractor.activeLeaves();
        return done;
    });
    ISO_TRY(status);
    return mesh;
}

} // namespace isoslider::extract
