#include "tests/bench/flat_baseline.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>

#include <glm/geometric.hpp>

#include "core/base/check.h"
#include "core/cell/cell_states.h"

namespace isoslider::bench {

using cell::kCellEdges;

namespace {

/// For each 12-bit mask of active edges: the signs in which corner 0 is below. The other solution is their complement.
const std::array<std::uint8_t, 4096>& signsFromActiveEdges() {
    static const std::array<std::uint8_t, 4096> table = [] {
        std::array<std::uint8_t, 4096> signs{};
        for (int s = 0; s < 256; s += 2) // even: corner 0 is below
            signs[cell::activeEdges(static_cast<std::uint8_t>(s))] = static_cast<std::uint8_t>(s);
        return signs;
    }();
    return table;
}

// All codes decoded, because E keeps normals as codes and the Taylor series wants unit vectors.
const std::vector<glm::vec3>& unitNormals() {
    static const std::vector<glm::vec3> table = [] {
        std::vector<glm::vec3> normals(65536);
        for (std::size_t code = 0; code < normals.size(); ++code)
            normals[code] = decodeNormal(static_cast<NormalCode>(code));
        return normals;
    }();
    return table;
}

// PAPER 3.2: 1 / sqrt(1 - 2 m t (1 - t)) by its series for small arguments.
// DEVIATION: the paper does not state what happens to large ones; the root is taken.
float inverseNorm(float m, float t) {
    const float x = 2.0f * m * t * (1.0f - t);
    if (x > 0.25f)
        return 1.0f / std::sqrt(std::max(1.0f - x, 1e-12f));
    return 1.0f + x * (0.5f + x * (0.375f + x * (0.3125f + x * 0.2734375f)));
}

} // namespace

template <class Live>
FlatBaseline<Live>::FlatBaseline(const GridGeometry& geometry, const std::vector<index::MissingCells>& missingCells,
                                 std::uint64_t expectedEdges)
    : grid_(geometry.dims), edgeTable_(2 * expectedEdges, 1), cellTable_(2 * expectedEdges, 2) {
    for (std::size_t axis = 0; axis < 3; ++axis)
        dims_[axis] = static_cast<std::uint64_t>(geometry.dims[axis]);
    strides_ = {1, dims_[0], dims_[0] * dims_[1]};
    for (const index::MissingCells& missing : missingCells)
        missingCells_[missing.brick] = &missing;
}

template <class Live>
void FlatBaseline<Live>::apply(const EdgeChanges<Live>& changes) {
    // PAPER 3.3: Delete before Add, so that additions fill the holes.
    for (const DeactivatedEdge& change : changes.deactivated)
        remove(edgeIdOf(change.brick, change.edge));
    for (const ActivatedEdge<Live>& change : changes.activated)
        add(change);
    compactEdges();
    for (const CellId cell : staleCells_)
        retriangulate(cell);
    staleCells_.clear();
    for (std::uint32_t t = 1; t < buckets_.size(); ++t)
        compact(buckets_[t], t);
}

template <class Live>
void FlatBaseline<Live>::remove(EdgeId edge) {
    const std::uint32_t* at = edgeTable_.find(edge);
    ISO_CHECK(at != nullptr);
    edgeHoles_.push_back(*at);
    edgeTable_.erase(edge);
    toggleCells(edge);
}

template <class Live>
void FlatBaseline<Live>::add(const ActivatedEdge<Live>& change) {
    const EdgeId edge = edgeIdOf(change.brick, change.edge);
    std::uint32_t at = static_cast<std::uint32_t>(edges_.size());
    if (edgeHoles_.empty()) {
        edges_.emplace_back();
        edgeIds_.emplace_back();
    } else {
        at = edgeHoles_.back();
        edgeHoles_.pop_back();
    }
    edges_[at] = makeEdge(change);
    edgeIds_[at] = edge;
    edgeTable_.insert(edge, at);
    toggleCells(edge);
}

template <class Live>
typename FlatBaseline<Live>::Edge FlatBaseline<Live>::makeEdge(const ActivatedEdge<Live>& change) const {
    const std::size_t axis = change.edge.number() >> 9;
    const auto point = grid_.pointCoords(pointIn(change.brick, LocalPoint(change.edge.number() & 511)));
    Edge edge{};
    edge.v1 = {static_cast<float>(point[0]), static_cast<float>(point[1]), static_cast<float>(point[2])};
    edge.s1 = change.scalar1;
    edge.dv[static_cast<int>(axis)] = static_cast<float>(Live(1) / (change.scalar2 - change.scalar1));
    edge.n1 = change.normal1;
    edge.n2 = change.normal2;
    edge.m = 1.0f - glm::dot(unitNormals()[edge.n1], unitNormals()[edge.n2]); // 1 - cos alpha
    return edge;
}

template <class Live>
bool FlatBaseline<Live>::isLowerEndBelow(const Edge& edge) const {
    return edge.dv.x + edge.dv.y + edge.dv.z > 0.0f; // an active edge that rises starts below
}

template <class Live>
extract::EdgeId FlatBaseline<Live>::edgeIdOf(BrickIndex brick, LocalEdge edge) const {
    const auto point = grid_.pointCoords(pointIn(brick, LocalPoint(edge.number() & 511)));
    std::uint64_t linear = 0;
    for (std::size_t axis = 0; axis < 3; ++axis)
        linear += strides_[axis] * static_cast<std::uint64_t>(point[axis]);
    return 4 * linear + (edge.number() >> 9);
}

// visit(cell, number of the edge in it) for the one to four cells around an edge.
template <class Live>
template <class Visit>
void FlatBaseline<Live>::forEachCellAt(EdgeId edge, const Visit& visit) const {
    const std::size_t axis = edge & 3;
    const std::uint64_t linear = edge >> 2;
    const std::array<std::uint64_t, 3> point{linear % dims_[0], linear / dims_[0] % dims_[1], linear / strides_[2]};
    const std::size_t u = axis == 0 ? 1 : 0;
    const std::size_t v = axis == 2 ? 1 : 2;
    for (std::uint64_t offset = 0; offset < 4; ++offset) {
        const std::uint64_t du = offset & 1, dv = offset >> 1;
        const bool isInBox =
            point[u] >= du && point[v] >= dv && point[u] - du + 1 < dims_[u] && point[v] - dv + 1 < dims_[v];
        if (isInBox)
            visit(linear - du * strides_[u] - dv * strides_[v], static_cast<int>(4 * axis + offset));
    }
}

template <class Live>
void FlatBaseline<Live>::toggleCells(EdgeId edge) {
    forEachCellAt(edge, [&](CellId id, int number) {
        Cell& cell = cellTable_.findOrInsert(id);
        cell.edgeMask = static_cast<std::uint16_t>(cell.edgeMask ^ (1u << number));
        makeStale(cell, id);
    });
}

// PAPER 3.3: the cell's entries in I are deleted, which leaves a hole until others fill it.
template <class Live>
void FlatBaseline<Live>::makeStale(Cell& cell, CellId id) {
    if (cell.isStale)
        return;
    cell.isStale = true;
    staleCells_.push_back(id);
    if (cell.list > 0)
        buckets_[cell.list].holes.push_back(cell.start);
    cell.list = 0;
}

// PAPER 3.3: entries from the end fill the holes that are left.
template <class Live>
void FlatBaseline<Live>::compactEdges() {
    std::sort(edgeHoles_.begin(), edgeHoles_.end(), std::greater<>());
    for (const std::uint32_t hole : edgeHoles_) {
        const std::uint32_t last = static_cast<std::uint32_t>(edges_.size()) - 1;
        if (hole != last) {
            edges_[hole] = edges_[last];
            edgeIds_[hole] = edgeIds_[last];
            *edgeTable_.find(edgeIds_[hole]) = hole;
            renameVertex(edgeIds_[hole], last, hole);
        }
        edges_.pop_back();
        edgeIds_.pop_back();
    }
    edgeHoles_.clear();
}

template <class Live>
void FlatBaseline<Live>::renameVertex(EdgeId edge, std::uint32_t from, std::uint32_t to) {
    forEachCellAt(edge, [&](CellId id, int) {
        const Cell* cell = cellTable_.find(id);
        if (cell->isStale || cell->list == 0)
            return;
        std::uint32_t* run = buckets_[cell->list].indices.data() + std::size_t{3} * cell->list * cell->start;
        std::replace(run, run + 3 * cell->list, from, to);
    });
}

template <class Live>
void FlatBaseline<Live>::retriangulate(CellId id) {
    Cell& cell = *cellTable_.find(id);
    cell.isStale = false;
    if (cell.edgeMask == 0) {
        cellTable_.erase(id);
        return;
    }
    if (isMissingCell(id))
        return;
    const auto vertexOf = [&](int number) {
        const auto& cellEdge = kCellEdges[static_cast<std::size_t>(number)];
        CellId corner = id;
        for (std::size_t axis = 0; axis < 3; ++axis)
            corner += cellEdge.lowerCorner >> axis & 1 ? strides_[axis] : 0;
        return *edgeTable_.find(4 * corner + cellEdge.axis);
    };
    // The mask leaves two cases, complements of each other; one active edge reports which.
    std::size_t signs = signsFromActiveEdges()[cell.edgeMask];
    const int first = std::countr_zero(cell.edgeMask);
    const bool isCornerAbove = signs >> kCellEdges[static_cast<std::size_t>(first)].lowerCorner & 1;
    if (isCornerAbove == isLowerEndBelow(edges_[vertexOf(first)]))
        signs = 255 - signs;

    // The paper's one triangulation per sign pattern: above corners of ambiguous faces stay parted.
    const cell::CellState& state = cell::cellStates()[cell::stateOf(static_cast<std::uint8_t>(signs), 0)];
    Bucket& bucket = buckets_[state.triangleCount];
    cell.list = state.triangleCount;
    cell.start = static_cast<std::uint32_t>(bucket.owners.size());
    const std::size_t runLength = std::size_t{3} * cell.list;
    if (bucket.holes.empty()) {
        bucket.owners.emplace_back();
        bucket.indices.resize(bucket.indices.size() + runLength);
    } else {
        cell.start = bucket.holes.back();
        bucket.holes.pop_back();
    }
    bucket.owners[cell.start] = id;
    std::array<std::uint32_t, 12> vertices{};
    for (unsigned mask = cell.edgeMask; mask != 0; mask &= mask - 1)
        vertices[static_cast<std::size_t>(std::countr_zero(mask))] = vertexOf(std::countr_zero(mask));
    for (std::size_t i = 0; i < runLength; ++i)
        bucket.indices[runLength * cell.start + i] = vertices[state.triangles[i]];
}

template <class Live>
void FlatBaseline<Live>::compact(Bucket& bucket, std::uint32_t triangles) {
    const std::size_t runLength = std::size_t{3} * triangles;
    std::sort(bucket.holes.begin(), bucket.holes.end(), std::greater<>());
    for (const std::uint32_t hole : bucket.holes) {
        const std::size_t last = bucket.owners.size() - 1;
        if (hole != last) {
            std::copy_n(bucket.indices.data() + runLength * last, runLength, bucket.indices.data() + runLength * hole);
            bucket.owners[hole] = bucket.owners[last];
            cellTable_.find(bucket.owners[hole])->start = hole;
        }
        bucket.owners.pop_back();
        bucket.indices.resize(runLength * last);
    }
    bucket.holes.clear();
}

template <class Live>
bool FlatBaseline<Live>::isMissingCell(CellId cell) const {
    if (missingCells_.empty())
        return false;
    const PointId point =
        grid_.pointId(static_cast<std::int64_t>(cell % dims_[0]), static_cast<std::int64_t>(cell / dims_[0] % dims_[1]),
                      static_cast<std::int64_t>(cell / strides_[2]));
    const auto found = missingCells_.find(brickOf(point));
    const unsigned local = localOf(point).number();
    return found != missingCells_.end() && (found->second->cells[local >> 6] >> (local & 63) & 1);
}

template <class Live>
void FlatBaseline<Live>::interpolate(double isovalue) {
    const std::vector<glm::vec3>& unit = unitNormals();
    positions_.resize(edges_.size());
    normals_.resize(edges_.size());
    for (std::size_t i = 0; i < edges_.size(); ++i) {
        const Edge& edge = edges_[i];
        const glm::vec3 along = static_cast<float>(static_cast<Live>(isovalue) - edge.s1) * edge.dv;
        positions_[i] = edge.v1 + along;
        const float t = along.x + along.y + along.z;
        normals_[i] = (unit[edge.n1] + t * (unit[edge.n2] - unit[edge.n1])) * inverseNorm(edge.m, t);
    }
}

template <class Live>
std::uint64_t FlatBaseline<Live>::triangles() const {
    std::uint64_t count = 0;
    for (std::size_t t = 1; t < buckets_.size(); ++t)
        count += t * buckets_[t].owners.size();
    return count;
}

template <class Live>
std::uint64_t FlatBaseline<Live>::memoryBytes() const {
    const auto bytes = [](const auto& array) { return array.capacity() * sizeof(array[0]); };
    std::uint64_t sum = bytes(edges_) + bytes(edgeIds_) + bytes(positions_) + bytes(normals_) +
                        edgeTable_.memoryBytes() + cellTable_.memoryBytes();
    for (const Bucket& bucket : buckets_)
        sum += bytes(bucket.indices) + bytes(bucket.owners);
    return sum;
}

template class FlatBaseline<float>;
template class FlatBaseline<double>;

} // namespace isoslider::bench
