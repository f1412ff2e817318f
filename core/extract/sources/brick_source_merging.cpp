// Bricks with merged cells: what depends on the bricks beside.

#include <algorithm>
#include <bit>
#include <utility>

#include "core/extract/sources/brick_scratch.h"
#include "core/extract/sources/leaf_finding.h"
#include "core/grid/scalar_type.h"

namespace isoslider::extract {

// In two steps, because a brick's merged cells depend on the leaves beside it: first each brick that has changed finds
// its leaves, if they may be others, and is made if none is merged; then the others are made, and with them those
// beside whose neighbours' leaves have become others.
template <class Sample>
Status BrickSource<Sample>::runMerging(const Move& move, LiveSurface<Live>& surface, std::vector<Job> jobs,
                                       SlideStats& stats, const JobControl& control) {
    edgeSamples_.grow(watch_.size());
    exceedingEdges_.grow(watch_.size());
    foundSigns_.grow(watch_.size());
    for (Scratch& scratch : *scratches_)
        scratch.otherLeaves.clear();
    const auto firstKnown = std::partition(jobs.begin(), jobs.end(), [this](const Job& job) {
        return job.isNew || hasNewBound_ || isOneLeaf_[job.slot.index()] == 0;
    });
    ISO_TRY(runJobs(move, surface, {jobs.begin(), firstKnown}, stats, control.part(0.0, 0.5),
                    {&BrickSource::findLeaves, &BrickSource::prefetchForLeaves}));
    std::erase_if(jobs, [this](const Job& job) { return !leavesOf(job.slot).hasMerged(); });
    addBricksBeside(surface, jobs);
    return runJobs(move, surface, std::move(jobs), stats, control.part(0.5, 1.0),
                   {&BrickSource::rebuildMerged, &BrickSource::prefetchMerged});
}

template <class Sample>
void BrickSource<Sample>::prefetchForLeaves(const LiveSurface<Live>& surface, const Job& job, LinesAhead& ahead) const {
    prefetchPoints(surface, job, ahead);
    const std::size_t slot = job.slot.index();
    const auto fetch = [](const auto& what) { LinesAhead(&what, sizeof what).fetchRest(); };
    fetch(sureCellsOf(job.slot));
    fetch(leavesOf(job.slot));
    fetch(usableLeaves_[slot]);
    fetch(shownLeaves_[slot]);
    if (!job.isNew)
        fetch(exceedingEdges_[slot]);
}

template <class Sample>
bool BrickSource<Sample>::findLeaves(const Move& move, LiveSurface<Live>& surface, const Job& job, Scratch& scratch) {
    if (!begin(surface, job, scratch))
        return false;
    const Stored* const samples = pointsOf(surface, job, scratch).samples;
    BrickLeaves& usable = usableLeaves_[job.slot.index()];
    SureCells& sure = sureCellsOf(job.slot);
    const BitString& validCells = surface.masks(job.slot).cells;
    const bool startsAgain = job.isNew || hasNewBound_;
    if (!sure.isKnown)
        sure = findSureCells<Sample>(samples, validCells, bound_);
    isOneLeaf_[job.slot.index()] = sure.isOneLeaf;
    if (sure.isOneLeaf) { // a brick that is live is crossed
        edgeSamples_[job.slot.index()].fill(samples);
        usable = leafBits(3, 0);
        const BrickLeaves before = std::exchange(leavesOf(job.slot), usable);
        if (!job.isNew && before != usable)
            scratch.otherLeaves.emplace_back(job.slot, before);
        surface.putPoints(job.slot, scratch.draft);
        scratch.ahead.fetchRest();
        return true;
    }
    scratch.ahead.fetchPart();
    classifyFor(move, surface, job, scratch);
    scratch.ahead.fetchPart();
    ExceedingEdges& exceeding = exceedingEdges_[job.slot.index()];
    FoundLeaves both;
    if (startsAgain) {
        exceeding.forget();
        both = findBrickLeaves<Sample>(samples, scratch.found.above, scratch.found.active, validCells, bound_, sure,
                                       exceeding);
    } else {
        both = updateBrickLeaves<Sample>(usable, aboveBefore(surface, job, scratch)->copy(), scratch.found.changed,
                                         samples, scratch.found.above, scratch.found.active, validCells, bound_, sure,
                                         exceeding);
    }
    usable = both.usable;
    const BrickLeaves& found = both.ofSurface;
    BrickLeaves& leaves = leavesOf(job.slot);
    if (!job.isNew && found != leaves)
        scratch.otherLeaves.emplace_back(job.slot, leaves);
    leaves = found;
    scratch.ahead.fetchRest();
    if (found.hasMerged()) {
        surface.putPoints(job.slot, scratch.draft);
        if (isMadeOfEdges_[job.slot.index()] == 0)
            foundSigns_[job.slot.index()] = {scratch.found.above, scratch.found.up, scratch.found.down, moves_};
    } else {
        addOtherLeaves(job.slot, scratch);
        makeUnmerged(move, surface, job, scratch);
    }
    return true;
}

// A cell that has merged or split has changed, whatever its signs.
template <class Sample>
void BrickSource<Sample>::addOtherLeaves(BrickSlot slot, Scratch& scratch) {
    const BrickLeaves before = std::exchange(shownLeaves_[slot.index()], leavesOf(slot));
    if (before == leavesOf(slot))
        return;
    const BitString others = cellsOfOtherLevel(before, leavesOf(slot));
    for (std::size_t w = 0; w < kBitWords; ++w)
        scratch.found.changed.words[w] |= others.words[w];
}

template <class Sample>
void BrickSource<Sample>::prefetchMerged(const LiveSurface<Live>& surface, const Job& job, LinesAhead& ahead) const {
    // Of a row of bricks they lie together.
    const BrickGrid& grid = surface.shapes().grid();
    const auto brick = static_cast<std::int64_t>(brickOf_[job.slot.index()].number()),
               last = static_cast<std::int64_t>(grid.brickCount()) - 1;
    for (std::int64_t z = -1; z <= 1; ++z)
        for (std::int64_t y = -1; y <= 1; ++y) {
            const std::int64_t other = brick + grid.bricks()[0] * (y + grid.bricks()[1] * z);
            __builtin_prefetch(&leavesOf_[static_cast<std::size_t>(std::clamp<std::int64_t>(other, 0, last))]);
        }
    __builtin_prefetch(&shownLeaves_[job.slot.index()]);
    if (isOneLeaf_[job.slot.index()] == 0) {
        const FoundSigns& found = foundSigns_[job.slot.index()];
        LinesAhead(&found, sizeof found).fetchRest();
        // Ambiguous cells and vertices inside cells want scalars.
        if (found.move != moves_ || surface.brick(job.slot).ambiguousCells + surface.brick(job.slot).innerVertices > 0)
            prefetchPoints(surface, job, ahead);
        return;
    }
    LinesAhead(&edgeSamples_[job.slot.index()], sizeof(LeafEdgeSamples<Stored>)).fetchRest();
    if (!job.isNew && isMadeOfEdges_[job.slot.index()] == 0)
        prefetchPoints(surface, job, ahead); // it was not alone, and mostly is not now
}

// Bricks that arrive or leave change nothing beside them: what they share with a brick in which no sample is crossed
// is on one side of the isovalue.
template <class Sample>
void BrickSource<Sample>::addBricksBeside(const LiveSurface<Live>& surface, std::vector<Job>& jobs) const {
    std::vector<bool> isListed(watch_.size(), false);
    for (const Job& job : jobs)
        isListed[job.slot.index()] = true;
    const BrickGrid& grid = surface.shapes().grid();
    for (const Scratch& scratch : *scratches_)
        for (const auto& [slot, before] : scratch.otherLeaves)
            forEachBesideChanged(
                grid, grid.brickCoords(brickOf_[slot.index()]), before, leavesOf(slot),
                [this](BrickIndex brick) { return slotOf_[brick.index()]; },
                [&](BrickSlot other) {
                    if (isListed[other.index()] || !leavesOf(other).hasMerged())
                        return;
                    isListed[other.index()] = true;
                    jobs.push_back({other, false});
                });
}

template <class Sample>
bool BrickSource<Sample>::rebuildMerged(const Move& move, LiveSurface<Live>& surface, const Job& job,
                                        Scratch& scratch) {
    BrickDraft<Live>& draft = scratch.draft;
    draft.newPoints = nullptr;
    const BrickLeaves& leaves = leavesOf(job.slot);
    const BrickGrid& grid = surface.shapes().grid();
    const auto coords = grid.brickCoords(brickOf_[job.slot.index()]);
    const auto leavesInBox = [&](const BrickStep& step) {
        return &leaves + step[0] + grid.bricks()[0] * (step[1] + grid.bricks()[1] * step[2]);
    };
    const auto leavesAt = [&](const BrickStep& step) -> const BrickLeaves* {
        for (std::size_t a = 0; a < 3; ++a) // the last bricks along an axis may have no cells
            if (coords[a] + step[a] < 0 || (coords[a] + step[a]) * kCellSide >= reader_.info().geometry.dims[a] - 1)
                return nullptr;
        return leavesInBox(step);
    };
    if (isOneLeaf_[job.slot.index()] != 0) {
        classifyLeafEdges(edgeSamples_[job.slot.index()], storedThreshold<Sample>(move.to), scratch.foundOnEdges);
        if (const OneLeaf leaf = oneLeafOf(scratch.foundOnEdges.above); isAloneAsOneLeaf(leaf.signs, leavesAt)) {
            makeOneLeaf(move, surface, job, leaf, scratch);
            scratch.ahead.fetchRest();
            return true;
        }
    }
    if (const FoundSigns& found = foundSigns_[job.slot.index()]; found.move == moves_) {
        scratch.found.above = found.above;
        scratch.found.up = found.up;
        scratch.found.down = found.down;
        classifyAgain(surface.masks(job.slot), aboveBefore(surface, job, scratch), scratch.found);
    } else {
        classifyFor(move, surface, job, scratch);
    }
    addOtherLeaves(job.slot, scratch);
    draft.active = scratch.found.active;
    draft.ownedEdges = scratch.found.ownedEdges;
    draft.merged.clear();
    if (leaves.hasMerged()) {
        scratch.around.fill(reader_.info().geometry.dims, surface.shapes().origin(brickOf_[job.slot.index()]),
                            scratch.found.above, leavesInBox);
        draft.merged.find(leaves, scratch.around, draft.active);
        const std::array<BitString, 3>& owned = surface.masks(job.slot).owned;
        draft.ownedEdges = 0;
        for (std::size_t a = 0; a < 3; ++a)
            for (std::size_t w = 0; w < kBitWords; ++w)
                draft.ownedEdges +=
                    static_cast<std::uint32_t>(std::popcount(draft.active.edges[a].words[w] & owned[a].words[w]));
    }
    finish(move, surface, job, scratch);
    return true;
}

// Makes a brick that is one leaf at any isovalue, and alone: from its leaf edges. As long as no sample on these is
// crossed, the surface in it stays as it is, whatever else is: the brick's samples ascend or descend throughout along
// each axis, so each face has a sign where its corners have, and what arrives beside it, or leaves, meets it nowhere.
template <class Sample>
void BrickSource<Sample>::makeOneLeaf(const Move& move, LiveSurface<Live>& surface, const Job& job, const OneLeaf& leaf,
                                      Scratch& scratch) {
    BrickDraft<Live>& draft = scratch.draft;
    draft.active.cells = {};
    draft.merged.set(leaf);
    const auto corners = draft.merged.corners();
    std::array<VertexCode, 12> codes;
    std::transform(corners.begin(), corners.end(), codes.begin(),
                   [](const MergedCells::Corner& corner) { return vertexCode(corner.edge, corner.level); });
    const std::span<VertexCode> now(codes.data(), corners.size());
    std::sort(now.begin(), now.end(), [](VertexCode a, VertexCode b) { return edgeOf(a) < edgeOf(b); });
    std::copy(now.begin(), now.end(), draft.codes.begin());
    draft.edgeVertices = static_cast<std::uint32_t>(now.size());
    for (std::size_t i = 0; i < now.size(); ++i)
        draft.vertices.of(edgeOf(now[i])) = static_cast<std::uint16_t>(i);

    const std::array<BitString, 3>& owned = surface.masks(job.slot).owned;
    const auto isOwned = [&](VertexCode code) {
        return owned[static_cast<std::size_t>(axisOf(edgeOf(code)))].test(startOf(edgeOf(code)));
    };
    draft.ownedEdges = static_cast<std::uint32_t>(std::count_if(now.begin(), now.end(), isOwned));
    const LiveBrick& brick = surface.brick(job.slot);
    const std::span<const VertexCode> before(brick.edgeVertices > 0 ? surface.codes(job.slot) : nullptr,
                                             brick.edgeVertices);
    const auto countOnly = [&](std::span<const VertexCode> some, std::span<const VertexCode> others) {
        return std::count_if(some.begin(), some.end(), [&](VertexCode code) {
            return isOwned(code) && std::none_of(others.begin(), others.end(),
                                                 [&](VertexCode other) { return edgeOf(other) == edgeOf(code); });
        });
    };
    scratch.edgesAdded += static_cast<std::uint64_t>(countOnly(now, before));
    scratch.edgesRemoved += static_cast<std::uint64_t>(countOnly(before, now));
    const bool isSame = std::equal(now.begin(), now.end(), before.begin(), before.end());
    draft.changed.words.fill(isSame ? 0 : ~std::uint64_t{0});
    shownLeaves_[job.slot.index()] = leavesOf(job.slot);

    surface.replace(job.slot, draft, Corners(pointsOf(surface, job, scratch)), move.isovalue);
    watch_[job.slot.index()] = {keyOf(sampleOf<Sample>(scratch.foundOnEdges.up)),
                                keyOf(sampleOf<Sample>(scratch.foundOnEdges.down))};
    isMadeOfEdges_[job.slot.index()] = true;
    ++scratch.bricks;
    compareEdgeCount(surface, job, scratch);
}

#define ISO_INSTANTIATE(Sample, Name) \
    template void BrickSource<Sample>::addOtherLeaves(BrickSlot, Scratch&); \
    template Status BrickSource<Sample>::runMerging(const Move&, LiveSurface<Live>&, std::vector<Job>, SlideStats&, \
                                                    const JobControl&);
ISO_FOR_EACH_SAMPLE_TYPE(ISO_INSTANTIATE)
#undef ISO_INSTANTIATE

} // namespace isoslider::extract
