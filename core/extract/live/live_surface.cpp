#include "core/extract/live/live_surface.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>
#include <span>
#include <utility>

#include "core/base/check.h"
#include "core/base/worker_team.h"
#include "core/extract/live/cell_triangles.h"
#include "core/extract/live/stream_copy.h"
#include "core/extract/live/vertex_kernels.h"

namespace isoslider::extract {
namespace {

constexpr cell::StateInterval kAlways{-std::numeric_limits<double>::infinity(),
                                      std::numeric_limits<double>::infinity()};

// Whether one of the cells in a leaf is in the string.
bool hasAnyCell(const BitString& cells, ClosedPoint first, int level) {
    const int side = 1 << level;
    const std::uint64_t row = (std::uint64_t{1} << side) - 1;
    std::uint64_t any = 0;
    for (int z = 0; z < side; ++z)
        for (int y = 0; y < side; ++y)
            any |= bitsFrom(cells, first + kPointStride[1] * y + kPointStride[2] * z) & row;
    return any != 0;
}

} // namespace

template <class Live>
LiveSurface<Live>::LiveSurface(const GridGeometry& geometry, ScalarType type,
                               const std::vector<index::MissingCells>& missingCells, bool keepsGroups)
    : geometry_(geometry),
      pointLines_(pointLineCount(scalarTypeSizeBytes(type))),
      inverseSpacing_(1.0 / glm::abs(geometry.spacing)),
      shapes_(geometry.dims, missingCells),
      hasMissing_(!missingCells.empty()),
      bricks_(shapes_.grid().brickCount()),
      arenas_(std::make_shared<BrickArenas>(type, keepsGroups)),
      kept_(shapes_.grid().brickCount()) {
    for (const cell::CellState& state : cell::cellStates())
        ISO_CHECK(state.innerVertices <= cell::kMaxInnerVertices && state.triangles.size() <= kMaxCellIndices);
}

template <class Live>
void LiveSurface<Live>::clear() {
    if (leases_->oldest() == PictureLeases::kNone) {
        arenas_->clear();
        retired_.clear();
    } else { // pictures refer to them until the next move at least
        std::vector<RetiredRuns> all;
        all.reserve(liveBricks_);
        for (const BrickSlot slot : slots())
            if (Brick& brick = bricks_[slot.index()]; brick.isLive)
                all.push_back(takeRuns(brick));
        addKeptRuns(all);
        retired_.add(version_ + 1, all);
    }
    forgetBricks();
}

template <class Live>
void LiveSurface<Live>::drop() noexcept {
    if (leases_->oldest() == PictureLeases::kNone) {
        arenas_->clear();
    } else if (spare_) {
        arenas_ = std::move(spare_); // which run is whose, a move that failed may have left open
    }
    retired_.clear();
    forgetBricks();
    trim();
}

template <class Live>
void LiveSurface<Live>::forgetBricks() noexcept {
    kept_.clear();
    ambiguous_.clear();
    merged_.clear();
    nearMissing_.clear();
    intervals_.clear();
    hasInner_.clear();
    free_.clear();
    shown_.clear();
    replaced_.clear();
    liveBricks_ = activeEdges_ = triangles_ = ambiguousCells_ = 0;
    activeLeaves_ = {};
    hasCleared_ = true;
}

template <class Live>
void LiveSurface<Live>::trim() noexcept {
    arenas_->trim();
    ambiguous_.trim();
    merged_.trim();
    bricks_.shrink(slotCount());
    hasCleared_ = false;
}

template <class Live>
template <class Counts>
void LiveSurface<Live>::countLeaves(const Brick& brick, int sign, Counts& counts) {
    using Count = typename Counts::value_type;
    counts[0] += static_cast<Count>(sign * brick.cellCount);
    for (std::size_t level = 1; level <= brick.mergedByLevel.size(); ++level)
        counts[level] += static_cast<Count>(sign * brick.mergedByLevel[level - 1]);
}

// What may fail comes before anything is added: afterwards all tables have one length.
template <class Live>
void LiveSurface<Live>::makeRoomFor(std::size_t bricks) {
    const std::size_t slots = slotCount() + bricks - std::min(bricks, free_.size());
    bricks_.grow(slots);
    if (slots <= intervals_.capacity())
        return;
    const std::size_t room = std::max(slots, 2 * slotCount());
    nearMissing_.reserve(room);
    intervals_.reserve(room);
    hasInner_.reserve(room);
    shown_.reserve(room);
    free_.reserve(room);
}

template <class Live>
BrickSlot LiveSurface<Live>::add(BrickIndex index, const std::optional<KeptPoints::Kept>& points) {
    if (free_.empty()) {
        makeRoomFor(1);
        static_cast<LiveBrickHead&>(bricks_[slotCount()]) = {};
        nearMissing_.emplace_back();
        intervals_.push_back(kAlways);
        hasInner_.push_back(0);
        shown_.emplace_back();
        free_.push_back(BrickSlot(slotCount() - 1));
    }
    const BrickSlot slot = free_.back();
    const bool isNearMissing = shapes_.isNearMissing(index);
    if (isNearMissing)
        nearMissing_[slot.index()] = std::make_unique<BrickMasks>(shapes_.masksNearMissing(index));
    Brick& brick = bricks_[slot.index()]; // new, or as remove() leaves it
    if (points) {
        KeptPoints::Kept kept = *points;
        moveDown(kept); // moveRunsDown() may have been here
        brick.points = kept.run;
        brick.pointsVersion = kept.version;
        brick.hasPoints = true;
    } else {
        arenas_->points.resize(brick.points, pointLines_); // here, where no other thread wants any
    }
    free_.pop_back();
    brick.index = index;
    brick.isLive = true;
    brick.isNearMissing = isNearMissing;
    ++liveBricks_;
    return slot;
}

template <class Live>
void LiveSurface<Live>::remove(BrickSlot slot) {
    Brick& brick = bricks_[slot.index()];
    activeEdges_ -= brick.ownedEdges;
    triangles_ -= brick.indexCount / 3;
    countLeaves(brick, -1, activeLeaves_);
    ambiguousCells_ -= brick.ambiguousCells;
    leavePoints(brick);
    RetiredRuns runs = takeRuns(brick);
    leave(runs);
    ambiguous_.release(brick.ambiguous);
    merged_.release(brick.merged);
    shown_[slot.index()] = {};
    nearMissing_[slot.index()].reset();
    intervals_[slot.index()] = kAlways;
    hasInner_[slot.index()] = 0;
    static_cast<LiveBrickHead&>(brick) = {};
    free_.push_back(slot);
    --liveBricks_;
}

template <class Live>
void LiveSurface<Live>::prefetch(BrickSlot slot) const {
    const Brick& brick = bricks_[slot.index()];
    for (std::size_t line = 0; line < sizeof(Brick); line += 64)
        __builtin_prefetch(reinterpret_cast<const char*>(&brick) + line);
    if (brick.ambiguousCells == 0)
        return;
    const auto* const known = reinterpret_cast<const char*>(ambiguous_.at(brick.ambiguous.begin));
    for (std::size_t line = 0; line < brick.ambiguousCells * sizeof(AmbiguousCell); line += 64)
        __builtin_prefetch(known + line);
}

template <class Live>
void LiveSurface<Live>::beginMove() {
    if (!spare_)
        spare_ = arenas_->alike();
    replaced_.clear();
    ++version_;
    const std::uint32_t oldest = leases_->oldest();
    isWatched_ = oldest != PictureLeases::kNone;
    // What was replaced in move m is part of the pictures made before it.
    retired_.releaseUntil(oldest, [this](std::span<const RetiredRuns> runs) { release(runs); });
}

template <class Live>
void LiveSurface<Live>::finishMove(BrickDraft<Live>& draft) {
    arenas_->vertices.takeBack(draft.verticesAhead);
    arenas_->indices.takeBack(draft.indicesAhead);
    activeEdges_ += static_cast<std::uint64_t>(draft.counts.activeEdges);
    triangles_ += static_cast<std::uint64_t>(draft.counts.triangles);
    ambiguousCells_ += static_cast<std::uint64_t>(draft.counts.ambiguousCells);
    for (std::size_t level = 0; level < activeLeaves_.size(); ++level)
        activeLeaves_[level] += static_cast<std::uint64_t>(draft.counts.leaves[level]);
    replaced_.insert(replaced_.end(), draft.replaced.begin(), draft.replaced.end());
    retired_.add(version_, draft.retired);
}

// PAPER 3.2, 3.3: there, arrays E, I, V and N hold the whole surface, changed edge by edge, deletions first, so that
// additions fill the holes. DEVIATION: the same arrays once for each brick, replaced whole (LIVE.md): no holes are
// left, no cell looks for its neighbours' vertices, and all bricks of a move may be replaced at once.
template <class Live>
void LiveSurface<Live>::replace(BrickSlot slot, BrickDraft<Live>& draft, const CornerScalarsOfBrick& corners,
                                double isovalue) {
    Brick& brick = bricks_[slot.index()];
    const std::uint64_t before = brick.cellCount > 0 ? ~std::uint64_t{0} : 0; // else what stands there is none of its
    const BitsInMemory had = brick.cells();
    for (std::size_t w = 0; w < kBitWords; ++w)
        draft.counts.cellsChanged += static_cast<std::uint64_t>(
            std::popcount(draft.changed.words[w] & (draft.active.cells.words[w] | (had.words[w] & before))));
    if (const auto leaves = draft.merged.leaves(); !leaves.empty()) {
        const std::uint64_t changed = anyOfEight(draft.changed);
        for (const MergedLeaf& leaf : leaves)
            draft.counts.cellsChanged += (changed & pairsOfLeaf(leaf.cell, leaf.level)) != 0;
    }
    triangulate(slot, draft, corners, isovalue);
    draft.inner.clear();
    const PointLine* const its = draft.newPoints ? draft.newPoints : points(slot);
    if (hasInner_[slot.index()] != 0)
        placeInner(shapes_.origin(brick.index), its, draft.ambiguous, draft, corners, isovalue);
    if (draft.merged.hasCentres())
        readRecords(its, draft.codes.data(), draft.edgeVertices, draft);
    if (!draft.merged.leaves().empty())
        triangulateMerged(slot, draft, isovalue);

    draft.counts.activeEdges += static_cast<std::int64_t>(draft.ownedEdges) - brick.ownedEdges;
    draft.counts.triangles += (static_cast<std::int64_t>(draft.indexCount) - brick.indexCount) / 3;
    draft.counts.ambiguousCells += static_cast<std::int64_t>(draft.ambiguous.size()) - brick.ambiguousCells;
    brick.ownedEdges = static_cast<std::uint16_t>(draft.ownedEdges);
    countLeaves(brick, -1, draft.counts.leaves);
    commit(slot, draft);
    countLeaves(brick, 1, draft.counts.leaves);
    draft.replaced.push_back(slot);
}

template <class Live>
RetiredRuns LiveSurface<Live>::takeRuns(Brick& brick) {
    return {std::exchange(brick.vertices, {}), std::exchange(brick.indices, {}), std::exchange(brick.inner, {}),
            std::exchange(brick.points, {})};
}

template <class Live>
void LiveSurface<Live>::release(RetiredRuns& runs) {
    arenas_->vertices.release(runs.vertices);
    arenas_->indices.release(runs.indices);
    arenas_->inner.release(runs.inner);
    arenas_->points.release(runs.points);
}

template <class Live>
void LiveSurface<Live>::release(std::span<const RetiredRuns> runs) {
    constexpr std::size_t kWorthATeam = 512;
    const auto releaseSome = [&](std::size_t part) {
        if (part == 0) {
            arenas_->vertices.releaseEach(runs, &RetiredRuns::vertices);
            arenas_->inner.releaseEach(runs, &RetiredRuns::inner);
        } else {
            arenas_->indices.releaseEach(runs, &RetiredRuns::indices);
            arenas_->points.releaseEach(runs, &RetiredRuns::points);
        }
    };
    if (runs.size() >= kWorthATeam) {
        forEachIndex(2, 1, releaseSome);
    } else {
        releaseSome(0);
        releaseSome(1);
    }
}

template <class Live>
void LiveSurface<Live>::readRecords(const PointLine* points, const VertexCode* codes, std::uint32_t count,
                                    BrickDraft<Live>& draft) const {
    extract::readRecords(arenas_->type, points, codes, count, draft.records.data());
}

template <class Live>
auto LiveSurface<Live>::recordOf(BrickSlot slot, std::uint32_t vertex) const -> Record {
    const Brick& brick = bricks_[slot.index()];
    if (vertex < brick.edgeVertices)
        return readRecord<Live>(arenas_->type, points(slot), codes(slot)[vertex]);
    return Record::inside(*arenas_->inner.at(brick.inner.begin + (vertex - brick.edgeVertices)));
}

template <class Live>
void LiveSurface<Live>::show(BrickSlot slot) {
    const Brick& brick = bricks_[slot.index()];
    PictureBrick& shown = shown_[slot.index()];
    const auto origin = shapes_.origin(brick.index);
    for (std::size_t a = 0; a < 3; ++a)
        shown.place[a] = static_cast<std::uint16_t>(origin[a] / kCellSide);
    shown.vertexCount = static_cast<std::uint16_t>(brick.edgeVertices + brick.innerVertices);
    shown.firstVertex = brick.vertices.begin;
    shown.firstIndex = brick.indices.begin;
    shown.indexCount = brick.indexCount;
    shown.version = version_;
    shown.firstInner = brick.inner.begin;
    shown.innerCount = brick.innerVertices;
    shown.firstPointLine = brick.points.begin;
    shown.pointsVersion = brick.pointsVersion;
}

// Puts the draft's vertices, triangles and ambiguous cells into the brick's runs, and new points.
template <class Live>
void LiveSurface<Live>::commit(BrickSlot slot, BrickDraft<Live>& draft) {
    Brick& brick = bricks_[slot.index()];
    const auto inner = static_cast<std::uint32_t>(draft.inner.size());
    if (isWatched_ && brick.vertices.capacity > 0) {
        RetiredRuns& retired = draft.retired.emplace_back(); // written in place: a copy would wait for its parts
        retired.vertices = std::exchange(brick.vertices, {});
        retired.indices = std::exchange(brick.indices, {});
        retired.inner = std::exchange(brick.inner, {});
    }
    const bool hasGroups = arenas_->hasGroups && draft.edgeVertices > 0;
    if (hasGroups) { // what was just written in parts cannot be read in vectors at once: copied last
        const PointLine* const its = draft.newPoints ? draft.newPoints : points(slot); // those that are in the cache
        gatherVertices(arenas_->type, its, draft.codes.data(), draft.edgeVertices, draft.groups.data());
    }
    putPoints(slot, draft);
    std::uint32_t vertices = draft.edgeVertices;
    for (std::uint32_t k = 0; k < inner; ++k)
        draft.codes[vertices++] = insideCode(k);
    arenas_->vertices.resize(brick.vertices, vertices, draft.verticesAhead);
    arenas_->indices.resize(brick.indices, draft.indexCount, draft.indicesAhead);
    arenas_->inner.resize(brick.inner, inner);
    const auto merged = draft.merged.leaves();
    merged_.resize(brick.merged, static_cast<std::uint32_t>(merged.size()));
    ambiguous_.resize(brick.ambiguous, static_cast<std::uint32_t>(draft.ambiguous.size()));
    if (vertices > 0)
        streamCopy(arenas_->vertices.at(brick.vertices.begin), draft.codes.data(), vertices * sizeof(VertexCode));
    if (draft.indexCount > 0)
        streamCopy(arenas_->indices.at(brick.indices.begin), draft.indices.data(),
                   draft.indexCount * sizeof(std::uint16_t));
    if (inner > 0)
        std::memcpy(arenas_->inner.at(brick.inner.begin), draft.inner.data(), inner * sizeof(InnerRecord));
    if (!draft.ambiguous.empty())
        std::memcpy(ambiguous_.at(brick.ambiguous.begin), draft.ambiguous.data(),
                    draft.ambiguous.size() * sizeof(AmbiguousCell));
    if (hasGroups)
        streamCopy(arenas_->template groupsFor<Live>(brick.vertices), draft.groups.data(),
                   groupCount(draft.edgeVertices) * sizeof(VertexGroup<Live>));
    std::copy(merged.begin(), merged.end(), merged.empty() ? nullptr : merged_.at(brick.merged.begin));
    brick.mergedCells = static_cast<std::uint16_t>(merged.size());
    brick.mergedByLevel = {};
    for (const MergedLeaf& leaf : merged)
        ++brick.mergedByLevel[leaf.level - 1u];
    brick.edgeVertices = static_cast<std::uint16_t>(draft.edgeVertices);
    brick.innerVertices = static_cast<std::uint16_t>(inner);
    brick.indexCount = draft.indexCount;
    brick.ambiguousCells = static_cast<std::uint16_t>(draft.ambiguous.size());
    brick.cellCount = static_cast<std::uint16_t>(draft.active.cells.count());
    brick.set(draft.above, draft.active.cells, draft.changed);
    show(slot);
}

// Indices of the active cells' triangles, in cell order; states of ambiguous cells first.
template <class Live>
void LiveSurface<Live>::triangulate(BrickSlot slot, BrickDraft<Live>& draft, const CornerScalarsOfBrick& corners,
                                    double isovalue) {
    const Brick& brick = bricks_[slot.index()];
    if (draft.active.cells.isEmpty()) { // all are merged
        draft.ambiguous.clear();
        draft.indexCount = 0;
        intervals_[slot.index()] = kAlways;
        hasInner_[slot.index()] = 0;
        return;
    }
    CellList& list = draft.cells;
    listCells(draft.active.cells, draft.above, list);
    findStates(brick, draft, corners, isovalue);
    cell::StateInterval interval = kAlways;
    std::uint32_t innerVertices = 0;
    for (const AmbiguousCell& each : draft.ambiguous) {
        interval = {std::max(interval.below, each.interval.below), std::min(interval.above, each.interval.above)};
        innerVertices += each.innerVertices;
    }
    // Plain cells have at most five triangles.
    const std::size_t room = 15 * std::size_t{list.count} + kMaxCellIndices * list.ambiguousCount + kIndexOverrun;
    if (draft.indices.size() < room)
        draft.indices.resize(room);
    draft.indexCount = writeTriangles(list, draft.edgeVertices, draft.vertices, draft.indices.data());
    intervals_[slot.index()] = interval;
    hasInner_[slot.index()] = innerVertices > 0;
}

// Appends the triangles of the merged cells to those of the others.
template <class Live>
void LiveSurface<Live>::triangulateMerged(BrickSlot slot, BrickDraft<Live>& draft, double isovalue) {
    const auto corners = draft.merged.corners();
    const auto firstCentre = static_cast<std::uint32_t>(draft.edgeVertices + draft.inner.size());
    const std::uint32_t first = draft.indexCount;
    draft.indexCount += static_cast<std::uint32_t>(draft.merged.triangles().size());
    if (const std::size_t room = draft.indexCount + kIndexOverrun; draft.indices.size() < room)
        draft.indices.resize(room); // it is copied in whole vectors
    std::uint16_t* out = draft.indices.data() + first;
    for (const std::uint16_t corner : draft.merged.triangles())
        *out++ = corner < MergedCells::kCentre
                     ? draft.vertices.of(corners[corner].edge)
                     : static_cast<std::uint16_t>(firstCentre + (corner - MergedCells::kCentre));
    placeCentres(shapes_.origin(bricks_[slot.index()].index), draft.records.data(), draft.merged.leaves(),
                 draft.indices.data() + first, draft, isovalue);
    hasInner_[slot.index()] = !draft.inner.empty();
}

template <class Live>
void LiveSurface<Live>::listChanges(std::vector<ChangedTriangles>& triangles,
                                    std::vector<std::uint16_t>& indices) const {
    constexpr std::size_t kTogether = 64;
    std::vector<std::vector<std::uint16_t>> parts((replaced_.size() + kTogether - 1) / kTogether);
    triangles.resize(replaced_.size());
    forEachIndex(parts.size(), 1, [&](std::size_t part) {
        for (std::size_t i = part * kTogether; i < std::min(replaced_.size(), (part + 1) * kTogether); ++i) {
            const Brick& brick = bricks_[replaced_[i].index()];
            triangles[i] = {replaced_[i].number(), 0};
            if (brick.indexCount == 0)
                continue;
            const std::uint16_t* const own = arenas_->indices.at(brick.indices.begin);
            const std::size_t before = parts[part].size();
            const BitString changed = brick.changed().copy();
            forEachCell(replaced_[i], [&](const SurfaceCell& cell) {
                const std::uint16_t* const its = own + cell.firstIndex;
                if (hasAnyCell(changed, cell.cell, cell.level))
                    parts[part].insert(parts[part].end(), its, its + cell.indexCount);
            });
            triangles[i].indexCount = static_cast<std::uint32_t>(parts[part].size() - before);
        }
    });
    std::erase_if(triangles, [](const ChangedTriangles& changed) { return changed.indexCount == 0; });
    for (const std::vector<std::uint16_t>& part : parts)
        indices.insert(indices.end(), part.begin(), part.end());
}

template <class Live>
std::shared_ptr<const BrickPicture<Live>> LiveSurface<Live>::picture(bool pointsOutChanges) const {
    std::vector<PictureBrick> table = leases_->takeTable();
    table.assign(shown_.begin(), shown_.end());
    auto picture = std::make_shared<BrickPicture<Live>>(arenas_, leases_, version_, std::move(table));
    picture->vertexEnd_ = arenas_->vertices.top();
    picture->indexEnd_ = arenas_->indices.top();
    picture->innerEnd_ = arenas_->inner.top();
    picture->pointLineEnd_ = arenas_->points.top();
    if (pointsOutChanges)
        listChanges(picture->changedTriangles_, picture->changedIndices_);
    return picture;
}

template class LiveSurface<float>;
template class LiveSurface<double>;

} // namespace isoslider::extract
