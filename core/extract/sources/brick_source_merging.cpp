// Bricks with merged cells: what depends on the bricks beside.

#include <algorithm>
#include <bit>
#include <utility>

#include "core/extract/sources/brick_scratch.h"
#include "core/extract/sources/leaf_finding.h"
#include "core/grid/scalar_type.h"

namespace isoslider::extract {

// In two steps, because a brick's merged cells depend on the leaves beside it: first each brick that has changed finds
// its leaves, and is made if none is merged; then the others are made, and with them those beside whose neighbours'
// leaves have become others.
template <class Sample>
Status BrickSource<Sample>::runMerging(const Move& move, LiveSurface<Live>& surface, std::vector<Job> jobs,
                                       SlideStats& stats, const JobControl& control) {
    for (Scratch& scratch : *scratches_)
        scratch.otherLeaves.clear();
    ISO_TRY(runJobs(move, surface, jobs, stats, control.part(0.0, 0.5), &BrickSource::findLeaves));
    std::erase_if(jobs, [this](const Job& job) { return !leavesOf(job.slot).hasMerged(); });
    addBricksBeside(surface, jobs);
    return runJobs(move, surface, std::move(jobs), stats, control.part(0.5, 1.0), &BrickSource::rebuildMerged);
}

template <class Sample>
bool BrickSource<Sample>::findLeaves(const Move& move, LiveSurface<Live>& surface, const Job& job, Scratch& scratch) {
    if (!begin(surface, job, scratch))
        return false;
    const Stored* const samples = pointsOf(surface, job, scratch).samples;
    BrickLeaves& usable = usableLeaves_[job.slot.index()];
    SureCells& sure = sureCells_[job.slot.index()];
    const BitString& validCells = surface.masks(job.slot).cells;
    const bool startsAgain = job.isNew || hasNewBound_;
    if (startsAgain)
        sure = findSureCells<Sample>(samples, validCells, bound_);
    if (sure.isOneLeaf) { // a brick that is live is crossed
        usable = leafBits(3, 0);
        const BrickLeaves before = std::exchange(leavesOf(job.slot), usable);
        if (!job.isNew && before != usable)
            scratch.otherLeaves.emplace_back(job.slot, before);
        surface.putPoints(job.slot, scratch.draft);
        return true;
    }
    classifyFor(move, surface, job, scratch);
    if (startsAgain)
        usable = findBrickLeaves<Sample>(samples, scratch.found.above, scratch.found.active, validCells, bound_, sure);
    else
        usable = updateBrickLeaves<Sample>(usable, scratch.found.changed, samples, scratch.found.above,
                                           scratch.found.active, validCells, bound_, sure);
    BrickLeaves& leaves = leavesOf(job.slot);
    const BrickLeaves found = leavesOfSurface(usable, scratch.found.active.cells);
    if (!job.isNew && found != leaves)
        scratch.otherLeaves.emplace_back(job.slot, leaves);
    leaves = found;
    if (found.hasMerged()) {
        surface.putPoints(job.slot, scratch.draft);
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

// Those of a row of bricks lie together.
template <class Sample>
void BrickSource<Sample>::prefetchLeavesAround(const LiveSurface<Live>& surface, BrickSlot slot) const {
    const BrickGrid& grid = surface.shapes().grid();
    const auto brick = static_cast<std::int64_t>(brickOf_[slot.index()].number()),
               last = static_cast<std::int64_t>(grid.brickCount()) - 1;
    for (std::int64_t z = -1; z <= 1; ++z)
        for (std::int64_t y = -1; y <= 1; ++y) {
            const std::int64_t other = brick + grid.bricks()[0] * (y + grid.bricks()[1] * z);
            __builtin_prefetch(&leavesOf_[static_cast<std::size_t>(std::clamp<std::int64_t>(other, 0, last))]);
        }
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
    classifyFor(move, surface, job, scratch);
    addOtherLeaves(job.slot, scratch);
    draft.active = scratch.found.active;
    draft.ownedEdges = scratch.found.ownedEdges;
    draft.merged.clear();
    if (const BrickLeaves& leaves = leavesOf(job.slot); leaves.hasMerged()) {
        const BrickGrid& grid = surface.shapes().grid();
        const auto coords = grid.brickCoords(brickOf_[job.slot.index()]);
        const auto leavesAt = [&](const BrickStep& step) -> const BrickLeaves* {
            for (std::size_t a = 0; a < 3; ++a)
                if (coords[a] + step[a] < 0 || coords[a] + step[a] >= grid.bricks()[a])
                    return nullptr;
            return &leaves + step[0] + grid.bricks()[0] * (step[1] + grid.bricks()[1] * step[2]);
        };
        if (leaves.level3 && isAloneAsOneLeaf(scratch.found.above, leavesAt)) {
            draft.merged.findOneLeaf(scratch.found.above, draft.active);
        } else {
            scratch.around.fill(reader_.info().geometry.dims, surface.shapes().origin(brickOf_[job.slot.index()]),
                                scratch.found.above, leavesAt);
            draft.merged.find(leaves, scratch.around, draft.active);
        }
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

#define ISO_INSTANTIATE(Sample, Name) \
    template void BrickSource<Sample>::addOtherLeaves(BrickSlot, Scratch&); \
    template void BrickSource<Sample>::prefetchLeavesAround(const LiveSurface<Live>&, BrickSlot) const; \
    template Status BrickSource<Sample>::runMerging(const Move&, LiveSurface<Live>&, std::vector<Job>, SlideStats&, \
                                                    const JobControl&);
ISO_FOR_EACH_SAMPLE_TYPE(ISO_INSTANTIATE)
#undef ISO_INSTANTIATE

} // namespace isoslider::extract
