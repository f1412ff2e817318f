#include "core/extract/live/live_surface.h"

#include <algorithm>
#include <bit>
#include <span>
#include <utility>
#include <vector>

#include "core/extract/inner_vertices.h"
#include "core/extract/live/vertex_kernels.h"

// What depends on the inside of cells: states of ambiguous cells, and vertices inside.

namespace isoslider::extract {
namespace {

// Decides the first of the undecided cells.
template <class Live>
void decide(std::span<const cell::CellState> states, BrickDraft<Live>& draft, const CornerScalarsOfBrick& corners,
            double isovalue, std::size_t count) {
    UndecidedOfBrick& undecided = draft.undecided;
    undecided.cells.count = count;
    corners.fill(std::span(undecided.places).first(count), undecided.cells);
    cell::resolveCells(undecided.cells, isovalue, undecided.resolved.data());
    for (std::size_t i = 0; i < count; ++i) {
        const cell::ResolvedCell& resolved = undecided.resolved[i];
        const ClosedPoint cell = undecided.places[i];
        const std::uint16_t number = undecided.numbers[i];
        const cell::CellState& state = states[resolved.state];
        draft.ambiguous[number] = {resolved.interval, cell, resolved.state, state.signs, state.innerVertices};
        draft.cells.states[draft.cells.ambiguous[number]] = resolved.state;
        // It may have changed though its signs have not.
        if (undecided.before[i] != resolved.state && !draft.changed.test(cell)) {
            draft.changed.set(cell);
            ++draft.counts.cellsChanged;
        }
    }
    draft.counts.cellsDecided += count;
}

} // namespace

// States of ambiguous cells: as they were while the isovalue stays in their intervals and their signs are the same,
// else decided by their corner scalars. The brick's list of before is in cell order too.
template <class Live>
void LiveSurface<Live>::findStates(const Brick& brick, BrickDraft<Live>& draft, const CornerScalarsOfBrick& corners,
                                   double isovalue) const {
    CellList& list = draft.cells;
    UndecidedOfBrick& undecided = draft.undecided;
    draft.ambiguous.resize(list.ambiguousCount);
    const AmbiguousCell* known = brick.ambiguousCells > 0 ? ambiguous_.at(brick.ambiguous.begin) : nullptr;
    const AmbiguousCell* const knownEnd = known + brick.ambiguousCells;
    std::size_t count = 0;
    for (std::uint32_t k = 0; k < list.ambiguousCount; ++k) {
        const std::uint16_t at = list.ambiguous[k];
        const ClosedPoint cell = list.cells[at];
        while (known != knownEnd && known->cell < cell)
            ++known;
        const bool isKnown = known != knownEnd && known->cell == cell;
        if (isKnown && known->signs == list.signs[at] && known->interval.contains(isovalue)) {
            draft.ambiguous[k] = *known;
            list.states[at] = known->state;
            continue;
        }
        undecided.cells.signs[count] = list.signs[at];
        undecided.places[count] = cell;
        undecided.numbers[count] = static_cast<std::uint16_t>(k);
        undecided.before[count] = isKnown ? known->state : -1;
        if (++count == cell::UndecidedCells::kMost)
            decide(states_, draft, corners, isovalue, std::exchange(count, 0));
    }
    if (count > 0)
        decide(states_, draft, corners, isovalue, count);
}

// Appends the vertices inside merged cells to draft.inner. `indices`: of their triangles; those round a centre are in
// the order of the polygon's corners.
template <class Live>
void LiveSurface<Live>::placeCentres(const std::array<std::int32_t, 3>& origin, const Record* records,
                                     std::span<const MergedLeaf> merged, const std::uint16_t* indices,
                                     BrickDraft<Live>& draft, double isovalue) const {
    std::vector<glm::vec3> positions, normals;
    for (const MergedLeaf& leaf : merged) {
        if (leaf.hasCentre) {
            positions.clear();
            normals.clear();
            for (std::uint32_t k = 0; k < leaf.indexCount; k += 3) {
                const MeshVertex vertex = vertexOf(records[indices[k]], origin, static_cast<Live>(isovalue));
                positions.push_back(vertex.position);
                normals.push_back(vertex.normal);
            }
            const auto local = coordsOf(leaf.cell);
            const InnerVertex centre =
                placeLoopCentre(positions, normals, {origin[0] + local[0], origin[1] + local[1], origin[2] + local[2]},
                                1 << leaf.level);
            draft.inner.push_back({centre.place, centre.normal, leaf.level});
        }
        indices += leaf.indexCount;
    }
}

// Appends the vertices inside the listed cells to draft.inner. `points`: those of the brick. First the vertices on the
// edges that they depend on, all together: their codes follow from cell and edge.
template <class Live>
void LiveSurface<Live>::placeInner(const std::array<std::int32_t, 3>& origin, const PointLine* points,
                                   std::span<const AmbiguousCell> ambiguous, BrickDraft<Live>& draft,
                                   const CornerScalarsOfBrick& corners, double isovalue) const {
    auto& edges = draft.innerEdges;
    edges.codes.clear();
    for (const AmbiguousCell& listed : ambiguous)
        for (unsigned mask = edgesOfInner_[listed.state]; mask != 0; mask &= mask - 1)
            edges.codes.push_back(static_cast<VertexCode>(
                4 * listed.cell.index() + kPlaceOfCellEdge[static_cast<std::size_t>(std::countr_zero(mask))]));
    const std::size_t count = edges.codes.size();
    if (edges.normals.size() < count) { // these last: memory may be short in between
        edges.positions.resize(count);
        edges.normals.resize(count);
    }
    placeVertices(arenas_->type, points, edges.codes.data(), static_cast<std::uint32_t>(count), origin,
                  static_cast<Live>(isovalue),
                  {edges.positions.data(), edges.normals.data(), static_cast<std::uint32_t>(edges.normals.size())});
    InnerVertexCell placed;
    std::array<InnerVertex, cell::kMaxInnerVertices> inside;
    std::size_t next = 0;
    for (const AmbiguousCell& listed : ambiguous) {
        if (listed.innerVertices == 0)
            continue;
        const auto local = coordsOf(listed.cell);
        for (std::size_t a = 0; a < 3; ++a)
            placed.origin[a] = origin[a] + local[a];
        if (listed.innerVertices == 1) { // nearly all: the mean of one loop, whose vertices stand side by side
            const auto around = static_cast<std::size_t>(std::popcount(edgesOfInner_[listed.state]));
            const InnerVertex centre =
                placeLoopCentre(std::span(edges.positions).subspan(next, around),
                                std::span(edges.normals).subspan(next, around), placed.origin, 1);
            draft.inner.push_back({centre.place, centre.normal, 0});
            next += around;
            continue;
        }
        const cell::CellState& state = states_[listed.state];
        placed.state = &state;
        for (unsigned mask = edgesOfInner_[listed.state]; mask != 0; mask &= mask - 1, ++next) {
            const auto e = static_cast<std::size_t>(std::countr_zero(mask));
            placed.edgePositions[e] = edges.positions[next];
            placed.edgeNormals[e] = edges.normals[next];
        }
        if (state.tunnel != cell::Tunnel::None)
            placed.scalars = corners.scalarsOf(listed.cell);
        placeInnerVertices(placed, isovalue, inverseSpacing_, inside.data());
        for (std::size_t k = 0; k < state.innerVertices; ++k)
            draft.inner.push_back({inside[k].place, inside[k].normal, 0});
    }
}

template <class Live>
void LiveSurface<Live>::refreshInnerVertices(BrickSlot slot, BrickDraft<Live>& draft,
                                             const CornerScalarsOfBrick& corners, double isovalue) {
    Brick& brick = bricks_[slot.index()];
    if (brick.innerVertices == 0)
        return;
    draft.inner.clear();
    const auto origin = shapes_.origin(brick.index);
    if (brick.ambiguousCells > 0)
        placeInner(origin, points(slot), {ambiguous_.at(brick.ambiguous.begin), brick.ambiguousCells}, draft, corners,
                   isovalue);
    if (const auto merged = mergedLeaves(brick); !merged.empty()) {
        std::uint32_t ofMerged = 0;
        for (const MergedLeaf& leaf : merged)
            ofMerged += leaf.indexCount;
        readRecords(points(slot), codes(slot), brick.edgeVertices, draft);
        placeCentres(origin, draft.records.data(), merged,
                     arenas_->indices.at(brick.indices.begin) + brick.indexCount - ofMerged, draft, isovalue);
    }
    if (isWatched_)
        draft.retired.push_back({{}, {}, std::exchange(brick.inner, {}), {}});
    arenas_->inner.resize(brick.inner, brick.innerVertices);
    std::copy(draft.inner.begin(), draft.inner.end(), arenas_->inner.at(brick.inner.begin));
    show(slot);
}

#define ISO_INSTANTIATE(Live) \
    template void LiveSurface<Live>::findStates(const Brick&, BrickDraft<Live>&, const CornerScalarsOfBrick&, double) \
        const; \
    template void LiveSurface<Live>::placeInner(const std::array<std::int32_t, 3>&, const PointLine*, \
                                                std::span<const AmbiguousCell>, BrickDraft<Live>&, \
                                                const CornerScalarsOfBrick&, double) const; \
    template void LiveSurface<Live>::placeCentres(const std::array<std::int32_t, 3>&, const Record*, \
                                                  std::span<const MergedLeaf>, const std::uint16_t*, \
                                                  BrickDraft<Live>&, double) const; \
    template void LiveSurface<Live>::refreshInnerVertices(BrickSlot, BrickDraft<Live>&, const CornerScalarsOfBrick&, \
                                                          double);
ISO_INSTANTIATE(float)
ISO_INSTANTIATE(double)
#undef ISO_INSTANTIATE

} // namespace isoslider::extract
