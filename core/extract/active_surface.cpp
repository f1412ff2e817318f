#include "core/extract/active_surface.h"

#include <algorithm>
#include <atomic>
#include <bit>

#include <tbb/parallel_for.h>

#include "core/base/check.h"
#include "core/extract/active_surface_detail.h"
#include "core/extract/inner_vertices.h"
#include "core/extract/vertex_interpolation.h"

namespace isoslider::extract {

static_assert(kVertexGranule % kInterpolationGroup == 0, "runs hold whole groups");

template <class Live>
ActiveSurface<Live>::ActiveSurface(const GridGeometry& geometry, const std::vector<index::MissingCells>& missingCells,
                                   HiddenScalars& hidden)
    : geometry_(geometry), inverseSpacing_(1.0 / glm::abs(geometry.spacing)), hidden_(hidden), table_(BrickGrid(geometry.dims), missingCells), scalars1_(kMaxVertices), scalars2_(kMaxVertices),
      edgeNormals_(kMaxVertices), edges_(kMaxVertices), positions_(kMaxVertices), normals_(kMaxVertices),
      indices_(3 * kMaxTriangles), runOwners_(kMaxTriangles), vertexRuns_(kVertexGranule, kMaxVertices),
      triangleRuns_(kTriangleGranule, kMaxTriangles) {
    for (const cell::CellState& state : cell::cellStates())
        ISO_CHECK(state.triangleCount == 0 || kRunLengths[kBucketOf[state.triangleCount]] == state.triangleCount);
}

template <class Live>
ActiveSurface<Live>::~ActiveSurface() = default;

template <class Live>
void ActiveSurface<Live>::clear() {
    // Index memory past the runs must read as zeros again; columns keep their pages for the next surface.
    for (Brick* brick : table_.bricks())
        if (brick->triangleBegin != kNoRun)
            std::fill_n(indices_.data() + 3 * std::size_t{brick->triangleBegin}, 3 * std::size_t{brick->triangleCapacity}, 0u);
    table_.clear();
    slowCells_.clear();
    vertexRuns_.clear();
    triangleRuns_.clear();
    dirtyBricks_.clear();
    activeEdges_ = triangles_ = ambiguousCells_ = 0;
}

template <class Live>
Status ActiveSurface<Live>::apply(const ChangeSet<Live>& changes, double isovalue, SlideStats& stats) {
    for (Brick* brick : dirtyBricks_)
        brick->changedCells = {};
    dirtyBricks_.clear();

    // 1. Edges. A partition's bricks belong to one task.
    for (Scratch& scratch : scratches_)
        scratch.beginMove();
    std::atomic<bool> isConsistent{true};
    tbb::parallel_for(0u, ChangeSet<Live>::kPartitions, [&](unsigned partition) {
        Scratch& scratch = scratches_.local();
        chainChanges(changes, partition, scratch);
        // In brick order, so that step 2 finds a brick's neighbours still in the cache.
        std::sort(scratch.touched.begin(), scratch.touched.end(), [](const Brick* a, const Brick* b) { return a->index < b->index; });
        for (std::size_t i = 0; i < scratch.touched.size(); ++i) {
            if (i + 1 < scratch.touched.size())
                prefetchBrick(*scratch.touched[i + 1]);
            if (!applyToBrick(*scratch.touched[i], scratch))
                isConsistent.store(false, std::memory_order_relaxed);
        }
    });
    std::int64_t edgeDifference = 0;
    for (Scratch& scratch : scratches_) {
        dirtyBricks_.insert(dirtyBricks_.end(), scratch.dirty.begin(), scratch.dirty.end());
        stats.edgesAdded += scratch.added;
        stats.edgesRemoved += scratch.removed;
        edgeDifference += static_cast<std::int64_t>(scratch.added) - static_cast<std::int64_t>(scratch.removed);
    }
    if (!isConsistent)
        return makeError(ErrorCode::Corruption, "index contradicts itself: an edge changes twice");
    activeEdges_ += static_cast<std::uint64_t>(edgeDifference);

    // 2. Triangles.
    listCrossedBricks(isovalue);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, dirtyBricks_.size(), 64), [&](const tbb::blocked_range<std::size_t>& range) {
        Scratch& scratch = scratches_.local();
        for (std::size_t i = range.begin(); i < range.end(); ++i) {
            if (i + 1 < range.end())
                prefetchBrick(*dirtyBricks_[i + 1]);
            retriangulate(*dirtyBricks_[i], isovalue, scratch);
        }
    });
    std::int64_t triangleDifference = 0, ambiguousDifference = 0;
    for (Scratch& scratch : scratches_) {
        if (scratch.error)
            return std::move(*scratch.error);
        triangleDifference += scratch.triangleDifference;
        ambiguousDifference += scratch.ambiguousDifference;
        stats.cellsRetriangulated += scratch.cells;
        stats.cellsResolved += scratch.resolved;
        stats.resolveMs += std::chrono::duration<double, std::milli>(scratch.resolving).count();
        if (!scratch.isConsistent)
            return makeError(ErrorCode::Corruption, "index contradicts itself: active edges that no scalars have");
    }
    triangles_ += static_cast<std::uint64_t>(triangleDifference);
    ambiguousCells_ += static_cast<std::uint64_t>(ambiguousDifference);
    for (Brick* brick : dirtyBricks_) {
        if (brick->slow)
            slowCells_.refreshInterval(*brick->slow);
        if (table_.entry(brick->index).isTouched) {
            brick->touched = {};
            table_.setTouched(*brick, false);
        }
    }
    releaseEmptyBricks(dirtyBricks_);
    std::erase_if(dirtyBricks_, [](const Brick* brick) { return brick->vertexBegin == kNoRun && brick->triangleBegin == kNoRun; });
    stats.activeEdges = activeEdges_;
    stats.triangles = triangles_;
    stats.ambiguousCells = ambiguousCells_;
    return {};
}

// Bricks in which a cell changes though none of its edges does.
template <class Live>
void ActiveSurface<Live>::listCrossedBricks(double isovalue) {
    slowCells_.forEachCrossed(isovalue, [&](Brick& brick) {
        if (!brick.isListedDirty.exchange(true, std::memory_order_relaxed))
            dirtyBricks_.push_back(&brick);
    });
}

template <class Live>
void ActiveSurface<Live>::releaseEmptyBricks(const std::vector<Brick*>& candidates) {
    for (Brick* brick : candidates) {
        if (brick->vertexCount == 0 && brick->vertexBegin != kNoRun) {
            vertexRuns_.free(brick->vertexBegin, brick->vertexCapacity);
            brick->vertexBegin = kNoRun;
            brick->vertexCapacity = 0;
        }
        if (brick->slow && brick->slow->ambiguous.empty() && brick->slow->inner.empty()) {
            releaseInnerRun(*brick->slow);
            slowCells_.remove(*brick);
        }
        if (brick->vertexBegin == kNoRun && brick->triangleBegin == kNoRun)
            table_.remove(*brick);
    }
}

template <class Live>
void ActiveSurface<Live>::interpolate(double isovalue) {
    const std::vector<Brick*>& bricks = table_.bricks();
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, bricks.size(), 32), [&](const tbb::blocked_range<std::size_t>& range) {
        for (std::size_t i = range.begin(); i < range.end(); ++i) {
            const Brick& brick = *bricks[i];
            if (i + 1 < range.end() && bricks[i + 1]->vertexCount > 0) {
                const std::size_t next = bricks[i + 1]->vertexBegin, count = bricks[i + 1]->vertexCount;
                prefetchLines(scalars1_.data() + next, count);
                prefetchLines(scalars2_.data() + next, count);
                prefetchLines(edgeNormals_.data() + next, count);
                prefetchLines(edges_.data() + next, count);
            }
            if (i + 2 < range.end())
                __builtin_prefetch(bricks[i + 2]);
            if (brick.vertexCount == 0)
                continue;
            const std::size_t begin = brick.vertexBegin;
            const EdgeColumns<Live> columns{scalars1_.data() + begin, scalars2_.data() + begin, edgeNormals_.data() + begin,
                                            edges_.data() + begin};
            interpolateVertices(columns, brick.vertexCount, brick.origin, static_cast<Live>(isovalue),
                                      positions_.data() + begin, normals_.data() + begin);
        }
        orderInterpolatedVertices();
    });
    const std::vector<SlowCells*>& slow = slowCells_.list();
    tbb::parallel_for(std::size_t{0}, slow.size(), [&](std::size_t i) { placeInnerVertices(*slow[i], isovalue); });
}

template <class Live>
void ActiveSurface<Live>::placeInnerVertices(const SlowCells& slow, double isovalue) {
    if (slow.inner.empty())
        return;
    const Brick& brick = *slow.brick;
    const Neighbourhood around = neighbourhood(brick);
    const auto states = cell::cellStates();
    // All vertices round the cells first: they were written past the caches, and are fetched together.
    std::vector<std::array<std::uint32_t, 12>>& vertices = scratches_.local().innerEdges;
    vertices.resize(slow.inner.size());
    for (std::size_t i = 0; i < slow.inner.size(); ++i) {
        const LocalPoint local = slow.inner[i].cell;
        for (unsigned mask = cell::activeEdges(states[stateOf(brick, local)].signs); mask != 0; mask &= mask - 1) {
            const auto e = static_cast<std::size_t>(std::countr_zero(mask));
            const EdgePlace place = edgePlaces()[local][e];
            vertices[i][e] = around.bricks[place >> kEdgeBits]->vertexOf(place & kEdgeMask);
            __builtin_prefetch(positions_.data() + vertices[i][e]);
            __builtin_prefetch(normals_.data() + vertices[i][e]);
        }
    }
    InnerVertexCell placed;
    for (std::size_t i = 0; i < slow.inner.size(); ++i) {
        const InnerCell& inner = slow.inner[i];
        placed.state = &states[stateOf(brick, inner.cell)];
        const std::array<std::int32_t, 3> local{inner.cell & 7, inner.cell >> 3 & 7, inner.cell >> 6};
        for (std::size_t a = 0; a < 3; ++a)
            placed.origin[a] = brick.origin[a] + local[a];
        for (unsigned mask = cell::activeEdges(placed.state->signs); mask != 0; mask &= mask - 1) {
            const auto e = static_cast<std::size_t>(std::countr_zero(mask));
            placed.edgePositions[e] = positions_[vertices[i][e]];
            placed.edgeNormals[e] = normals_[vertices[i][e]];
        }
        if (placed.state->tunnel != cell::Tunnel::None) {
            placed.scalars = scalarsOf(around, inner.cell, placed.state->signs);
            if (const int hidden = cell::hiddenCorner(placed.state->signs); hidden >= 0)
                placed.scalars[static_cast<std::size_t>(hidden)] = inner.hiddenScalar;
        }
        const std::size_t first = slow.innerBegin + inner.first;
        extract::placeInnerVertices(placed, isovalue, inverseSpacing_, positions_.data() + first, normals_.data() + first);
    }
}

template <class Live>
std::uint64_t ActiveSurface<Live>::memoryBytes() const {
    constexpr std::uint64_t kVertexBytes = 2 * sizeof(Live) + 4 + sizeof(LocalEdge) + 2 * sizeof(glm::vec3);
    return vertexRuns_.top() * kVertexBytes + triangleRuns_.top() * (3 * 4 + sizeof(LocalPoint)) + table_.memoryBytes() +
           slowCells_.memoryBytes();
}

template <class Live>
void ActiveSurface<Live>::copyFrame(SurfaceFrame& frame) const {
    frame.geometry = geometry_;
    const std::size_t vertices = vertexRuns_.top();
    const std::size_t indexCount = 3 * triangleRuns_.top();
    frame.positions.assign(positions_.data(), positions_.data() + vertices);
    frame.normals.assign(normals_.data(), normals_.data() + vertices);
    frame.indices.assign(indices_.data(), indices_.data() + indexCount);
    frame.changedIndices.clear();
    for (const Brick* brick : dirtyBricks_)
        forEachBit(brick->changedCells, [&](LocalPoint cell) {
            const int t = cell::cellStates()[stateOf(*brick, cell)].triangleCount;
            if (t == 0)
                return;
            const std::uint32_t* run = indices_.data() + 3 * std::size_t{runBegin(*brick, cell, t)};
            frame.changedIndices.insert(frame.changedIndices.end(), run, run + 3 * t);
        });
}

template <class Live>
SurfaceMesh ActiveSurface<Live>::mesh(double isovalue) const {
    SurfaceMesh mesh;
    mesh.geometry = geometry_;
    mesh.isovalue = isovalue;
    const GridDims& dims = geometry_.dims;

    // Vertices in edge id order, inner ones and triangles in cell order: what a scan of the grid gives.
    std::vector<std::pair<EdgeId, std::uint32_t>> order;
    std::vector<std::pair<std::uint64_t, std::pair<const Brick*, LocalPoint>>> cells;
    order.reserve(activeEdges_);
    const auto pointIndex = [&](const Brick& brick, unsigned local) {
        const std::int64_t x = brick.origin[0] + (local & 7), y = brick.origin[1] + (local >> 3 & 7), z = brick.origin[2] + (local >> 6);
        return static_cast<std::uint64_t>(x + dims[0] * (y + dims[1] * z));
    };
    for (const Brick* brick : table_.bricks()) {
        for (std::uint32_t i = 0; i < brick->vertexCount; ++i) {
            const LocalEdge edge = edges_[brick->vertexBegin + i];
            order.emplace_back(4 * pointIndex(*brick, edge & 511) + (edge >> 9), brick->vertexBegin + i);
        }
        forEachBit(brick->activeCells, [&](LocalPoint cell) { cells.push_back({pointIndex(*brick, cell), {brick, cell}}); });
    }
    std::sort(order.begin(), order.end());
    std::sort(cells.begin(), cells.end(), [](const auto& a, const auto& b) { return a.first < b.first; });

    std::vector<std::uint32_t> newIndex(vertexRuns_.top());
    for (std::size_t i = 0; i < order.size(); ++i) {
        newIndex[order[i].second] = static_cast<std::uint32_t>(i);
        mesh.edgeIds.push_back(order[i].first);
        mesh.positions.push_back(positions_[order[i].second]);
        mesh.normals.push_back(normals_[order[i].second]);
    }
    for (const auto& [point, where] : cells) {
        const auto [brick, cell] = where;
        const cell::CellState& state = cell::cellStates()[stateOf(*brick, cell)];
        const int t = state.triangleCount;
        if (state.innerVertices > 0) {
            const std::uint32_t first = brick->slow->innerBegin + brick->slow->innerOf(cell).first;
            for (std::uint32_t k = first; k < first + state.innerVertices; ++k) {
                newIndex[k] = static_cast<std::uint32_t>(mesh.positions.size());
                mesh.positions.push_back(positions_[k]);
                mesh.normals.push_back(normals_[k]);
            }
        }
        const std::uint32_t* run = indices_.data() + 3 * std::size_t{runBegin(*brick, cell, t)};
        for (int k = 0; k < 3 * t; ++k)
            mesh.triangles.push_back(newIndex[run[k]]);
    }
    return mesh;
}

template class ActiveSurface<float>;
template class ActiveSurface<double>;

} // namespace isoslider::extract
