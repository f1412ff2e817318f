#include "core/extract/sources/brick_source.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <exception>
#include <limits>
#include <system_error>
#include <utility>

#include <glm/common.hpp>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_sort.h>
#include <tbb/task_arena.h>

#include "core/base/job_control.h"
#include "core/base/shared_progress.h"
#include "core/base/worker_team.h"
#include "core/extract/live/stream_copy.h"
#include "core/extract/sources/brick_scratch.h"
#include "core/grid/classification.h"
#include "core/grid/gradient.h"

namespace isoslider::extract {
template <class Sample>
BrickSource<Sample>::BrickSource(const index::IndexReader& list, SampleReader<Sample>& samples,
                                 std::uint64_t cacheBytes, const MergeBound& listBound)
    : reader_(list),
      isListOfEdges_(list.info().kind == index::IndexKind::Edges),
      activity_(list.grid(), isListOfEdges_ ? BrickActivity<Key>::ListOf::Edges : BrickActivity<Key>::ListOf::Bricks),
      walk_(list, cacheBytes, [this](const auto& records, auto& totals) { activity_.sumUp(records, totals); }),
      samples_(samples),
      inverseSpacing_(inverseSpacingOf(list.info().geometry)),
      listBound_(listBound),
      slotOf_(list.grid().brickCount()),
      leavesOf_(list.grid().brickCount()),
      sureCells_(list.grid().brickCount()),
      edgeSamples_(list.grid().brickCount()),
      exceedingEdges_(list.grid().brickCount()),
      foundSigns_(list.grid().brickCount()),
      scratches_(std::make_unique<tbb::enumerable_thread_specific<Scratch>>()) {
    slotOf_.grow(list.grid().brickCount());
}

template <class Sample>
BrickSource<Sample>::~BrickSource() = default;

template <class Sample>
void BrickSource<Sample>::setMergeBound(const MergeBound& bound) {
    hasNewBound_ = hasNewBound_ || (bound != bound_ && (bound.limit > 0.0 || bound_.limit > 0.0));
    bound_ = bound;
}

template <class Sample>
void BrickSource<Sample>::reset() {
    for (const BrickIndex brick : brickOf_) {
        slotOf_[brick.index()] = 0;
        leavesOf_[brick.index()] = {};
    }
    watch_.clear();
    brickOf_.clear();
    usableLeaves_.clear();
    shownLeaves_.clear();
    isOneLeaf_.clear();
    isMadeOfEdges_.clear();
    edgeSamples_.shrink(0);
    exceedingEdges_.shrink(0);
    foundSigns_.shrink(0);
}

// Bricks that come or go between two thresholds. `isAhead`: the position stays what it is.
template <class Sample>
Status BrickSource<Sample>::netBricks(KeyThreshold lower, KeyThreshold upper, bool goesUp, bool isAhead,
                                      SlideStats& stats, std::stop_token stop, NetBricks& net) {
    activity_.beginWalk(goesUp);
    ISO_TRY(walk_.visit(lower, upper, stats, stop, [this](const Part& part) { activity_.add(part); }));
    const auto changes = activity_.changes();
    if (!hasCounts_) {
        std::vector<BrickIndex> touched;
        for (const auto& change : changes)
            if (isInRegion(change.brick))
                touched.push_back(change.brick);
        return netBricksBySamples(std::move(touched), goesUp ? upper : lower, stats, stop, net);
    }
    for (const auto& change : changes) {
        const std::uint32_t before = activity_.count(change.brick);
        const bool arrives = before == 0, leaves = static_cast<int>(before) + change.count == 0;
        if ((arrives || leaves) && isInRegion(change.brick))
            (arrives ? net.arrive : net.leave).push_back(change.brick);
    }
    if (!isAhead && !activity_.apply(changes))
        return makeError(ErrorCode::Corruption, "index contradicts itself: something becomes active twice",
                         reader_.pathString());
    return {};
}

// All that are active at a threshold: from whichever end there are fewer.
template <class Sample>
Status BrickSource<Sample>::activeBricks(KeyThreshold at, SlideStats& stats, std::stop_token stop, NetBricks& net) {
    const auto cost = [&](KeyThreshold lower, KeyThreshold upper) {
        return std::pair(walk_.isBlocked(lower, upper), walk_.estimate(lower, upper));
    };
    for (;;) {
        const bool fromBelow = cost(lowest(), at) <= cost(at, highest());
        const std::uint64_t lost = walk_.pagesLost();
        net = {};
        activity_.clear();
        hasCounts_ = true;
        Status found = fromBelow ? netBricks(lowest(), at, true, false, stats, stop, net)
                                 : netBricks(at, highest(), false, false, stats, stop, net);
        if (found.isOk() || found.isCancelled())
            return found;
        if (walk_.isBlocked(lowest(), at) && walk_.isBlocked(at, highest()))
            return bricksBySamples(at, stats, stop, net);
        if (walk_.pagesLost() == lost)
            return found;
    }
}

// The same without the list: what its damaged pages say of the bricks, their samples say too.
template <class Sample>
Status BrickSource<Sample>::bricksBySamples(KeyThreshold at, SlideStats& stats, std::stop_token stop, NetBricks& net) {
    hasCounts_ = false;
    std::vector<BrickIndex> all;
    for (const BrickIndex brick : firstIds<BrickIndex>(reader_.grid().brickCount()))
        if (isInRegion(brick))
            all.push_back(brick);
    net = {};
    return findActive(std::move(all), at, stats, stop, net.arrive);
}

// What comes and goes where counts are not known: among the bricks whose counts the move changes, all others stay as
// they are.
template <class Sample>
Status BrickSource<Sample>::netBricksBySamples(std::vector<BrickIndex> touched, KeyThreshold to, SlideStats& stats,
                                               std::stop_token stop, NetBricks& net) {
    std::vector<BrickIndex> active;
    ISO_TRY(findActive(touched, to, stats, stop, active));
    std::sort(active.begin(), active.end());
    for (const BrickIndex brick : touched) {
        const bool isActive = std::binary_search(active.begin(), active.end(), brick),
                   isLive = slotOf_[brick.index()] != 0;
        if (isActive != isLive)
            (isActive ? net.arrive : net.leave).push_back(brick);
    }
    return {};
}

// Those of the bricks that have samples on both sides of the threshold.
template <class Sample>
Status BrickSource<Sample>::findActive(std::vector<BrickIndex> among, KeyThreshold at, SlideStats& stats,
                                       std::stop_token stop, std::vector<BrickIndex>& active) {
    sortForReading(among, false);
    tbb::enumerable_thread_specific<std::vector<BrickIndex>> found;
    const auto isActive = [&](BrickIndex brick, SampleBlock<Sample>& block) {
        readBlock(samples_.rows(brick), block);
        Key least = std::numeric_limits<Key>::max(), greatest = 0;
        const auto end = [&](std::size_t axis) { return std::min(kBrickSide + 1, block.end[axis]); };
        for (int z = 0; z < end(2); ++z)
            for (int y = 0; y < end(1); ++y)
                for (int x = 0; x < end(0); ++x)
                    if (const Sample sample = block.samples[static_cast<std::size_t>(block.offset(x, y, z))];
                        !isMissing(sample)) {
                        least = std::min(least, keyOf(sample));
                        greatest = std::max(greatest, keyOf(sample));
                    }
        return least < at && greatest >= at;
    };
    for (std::span<const BrickIndex> rest(among); !rest.empty();) {
        const auto ready = samples_.prepare(rest, stats, stop);
        if (!ready.isOk())
            return ready.error();
        forRanges(ready.value(), kBricksTogether, [&](std::size_t begin, std::size_t end) {
            SampleBlock<Sample> block;
            for (std::size_t i = begin; i < end && !stop.stop_requested(); ++i)
                if (isActive(rest[i], block))
                    found.local().push_back(rest[i]);
        });
        if (stop.stop_requested())
            return cancelledError();
        rest = rest.subspan(ready.value());
    }
    for (const std::vector<BrickIndex>& some : found)
        active.insert(active.end(), some.begin(), some.end());
    return {};
}

// Whether the bricks that are active after the move are all looked up: where the region has become another one, and,
// with a list of edges, where that is cheaper: from an end of the list there are fewer entries on the way, but all
// bricks are gone through.
template <class Sample>
bool BrickSource<Sample>::isLookedUp(const Move& move) const {
    if (hasNewRegion_ || !isListOfEdges_ || !hasCounts_ ||
        (isWayBlocked(lowest(), move.to) && isWayBlocked(move.to, highest())))
        return hasNewRegion_;
    const std::uint64_t fromEnd = std::min(estimateWay(lowest(), move.to), estimateWay(move.to, highest()));
    constexpr std::uint64_t kEntriesPerBrick = 8; // that cost as much
    return estimateWay(move.from, move.to) > fromEnd + kEntriesPerBrick * watch_.size();
}

// What comes and goes where all are looked up: of all that are active after the move those that are not
// live yet; and all others that are.
template <class Sample>
Status BrickSource<Sample>::lookUpBricks(const Move& move, const LiveSurface<Live>& surface, SlideStats& stats,
                                         std::stop_token stop, NetBricks& net) {
    ISO_TRY(activeBricks(move.to, stats, stop, net));
    std::vector<bool> stays(watch_.size(), false);
    std::erase_if(net.arrive, [&](BrickIndex brick) {
        const std::uint32_t slot = slotOf_[brick.index()];
        if (slot != 0)
            stays[slot - 1] = true;
        return slot != 0;
    });
    net.leave.clear();
    for (const BrickSlot slot : firstIds<BrickSlot>(watch_.size()))
        if (surface.brick(slot).isLive && !stays[slot.index()])
            net.leave.push_back(brickOf_[slot.index()]);
    return {};
}

template <class Sample>
Status BrickSource<Sample>::changeActiveSet(const Move& move, LiveSurface<Live>& surface, SlideStats& stats,
                                            std::stop_token stop, std::vector<Job>& jobs) {
    NetBricks net;
    if (!isEnd(move.from) && isLookedUp(move))
        ISO_TRY(lookUpBricks(move, surface, stats, stop, net));
    else if (isEnd(move.from))
        ISO_TRY(activeBricks(move.to, stats, stop, net));
    else
        ISO_TRY(netBricks(std::min(move.from, move.to), std::max(move.from, move.to), move.from < move.to, false, stats,
                          stop, net));
    // Before others leave, for which some may be given up.
    std::erase_if(net.arrive, [&](BrickIndex brick) { return !surface.shapes().hasCells(brick); });
    sortForReading(net.arrive, false);
    std::vector<std::optional<KeptPoints::Kept>> kept(net.arrive.size());
    std::transform(net.arrive.begin(), net.arrive.end(), kept.begin(),
                   [&](BrickIndex brick) { return surface.takeKeptPoints(brick); });
    constexpr std::size_t kAhead = 8;
    for (std::size_t i = 0; i < net.leave.size(); ++i) {
        if (i + 2 * kAhead < net.leave.size())
            __builtin_prefetch(&slotOf_[net.leave[i + 2 * kAhead].index()], 1);
        if (i + kAhead < net.leave.size())
            if (const std::uint32_t ahead = slotOf_[net.leave[i + kAhead].index()]; ahead != 0)
                surface.prefetchHead(BrickSlot(ahead - 1));
        const BrickIndex brick = net.leave[i];
        if (slotOf_[brick.index()] == 0)
            continue; // points without cells
        const BrickSlot slot(std::exchange(slotOf_[brick.index()], 0) - 1);
        stats.edgesRemoved += surface.brick(slot).ownedEdges;
        stats.cellsRetriangulated += surface.brick(slot).cellCount;
        surface.remove(slot);
        watch_[slot.index()] = {};
        if (bound_.limit > 0.0 || hasNewBound_)
            leavesOf_[brick.index()] = {};
    }
    surface.makeRoomFor(net.arrive.size());
    for (std::size_t i = 0; i < net.arrive.size(); ++i) {
        const BrickIndex brick = net.arrive[i];
        if (slotOf_[brick.index()] != 0)
            return makeError(ErrorCode::Corruption, "index contradicts itself: a brick becomes active twice",
                             reader_.pathString());
        const BrickSlot slot = surface.add(brick, kept[i]);
        if (slot.index() >= watch_.size()) {
            watch_.resize(slot.index() + 1);
            brickOf_.resize(slot.index() + 1);
            isOneLeaf_.resize(slot.index() + 1);
            isMadeOfEdges_.resize(slot.index() + 1);
        }
        watch_[slot.index()] = {};
        brickOf_[slot.index()] = brick;
        slotOf_[brick.index()] = slot.number() + 1; // the last: whatever fails before, reset() finds all that is set
        jobs.push_back({slot, true});
    }
    return {};
}

// Bricks active before and after: those in which something changes, and others whose vertices inside cells move. Which
// ones cannot be predicted, so lists are written without branches.
template <class Sample>
void BrickSource<Sample>::listCrossed(const Move& move, const LiveSurface<Live>& surface, std::vector<Job>& jobs,
                                      std::vector<BrickSlot>& refreshed) const {
    constexpr std::size_t kTogether = 512;
    std::array<BrickSlot, kTogether> crossed, others;
    const bool goesUp = move.from < move.to;
    for (std::size_t begin = 0; begin < watch_.size(); begin += kTogether) {
        std::size_t crossedCount = 0, otherCount = 0;
        for (std::size_t s = begin; s < std::min(watch_.size(), begin + kTogether); ++s) {
            const BrickSlot slot(s);
            const Watch& watch = watch_[s];
            const bool isCrossed =
                watch.isSet() & ((goesUp ? watch.up < move.to : watch.down >= move.to) | hasNewBound_ |
                                 !surface.stateInterval(slot).contains(move.isovalue));
            crossed[crossedCount] = others[otherCount] = slot;
            crossedCount += isCrossed;
            otherCount += !isCrossed & surface.hasInnerVertices(slot); // none, where there is no brick
        }
        for (std::size_t i = 0; i < crossedCount; ++i)
            jobs.push_back({crossed[i], false});
        refreshed.insert(refreshed.end(), others.begin(), others.begin() + static_cast<std::ptrdiff_t>(otherCount));
    }
}

template <class Sample>
Status BrickSource<Sample>::move(const Move& move, LiveSurface<Live>& surface, SlideStats& stats,
                                 const JobControl& control) {
    ahead_ = {}; // stops it
    stats.bytesAhead += std::exchange(bytesAhead_, 0);
    ++moves_;
    if (move.from == lowest() || move.from == highest()) // nothing is active there; perhaps a move was broken off
        reset();
    // Merged cells look different where there are none beside them: a brick at the region's border may be no longer.
    hasNewBound_ = hasNewBound_ || (hasNewRegion_ && bound_.limit > 0.0);
    std::vector<Job> arrived, jobs;
    std::vector<BrickSlot> refreshed;
    ISO_TRY(changeActiveSet(move, surface, stats, control.stop, arrived));
    listCrossed(move, surface, jobs, refreshed); // nothing crosses those that have left or are to be made
    jobs.insert(jobs.end(), arrived.begin(), arrived.end());

    for (Scratch& scratch : *scratches_) {
        scratch.draft.beginMove();
        scratch.bricks = scratch.edgesAdded = scratch.edgesRemoved = 0;
        scratch.isConsistent = true;
    }
    if (bound_.limit > 0.0 && bound_ != sureBound_) { // a handle that is dragged merges cells, one that rests may not
        sureCells_.release(0);
        sureBound_ = bound_;
    }
    if (bound_.limit > 0.0 || hasNewBound_) {
        usableLeaves_.resize(watch_.size());
        shownLeaves_.resize(watch_.size());
    }
    if (hasNewBound_ && bound_.limit == 0.0) {
        for (const BrickIndex brick : brickOf_)
            leavesOf_[brick.index()] = {};
        edgeSamples_.shrink(0);
        exceedingEdges_.shrink(0);
        foundSigns_.shrink(0);
    }
    if (bound_.limit > 0.0)
        ISO_TRY(runMerging(move, surface, std::move(jobs), stats, control));
    else
        ISO_TRY(runJobs(move, surface, std::move(jobs), stats, control,
                        {&BrickSource::rebuild, &BrickSource::prefetchPoints}));
    if (hasNewBound_ && bound_.limit == 0.0)
        for (auto* const leaves : {&usableLeaves_, &shownLeaves_}) // none is any more
            std::vector<BrickLeaves>().swap(*leaves);
    hasNewBound_ = hasNewRegion_ = false;
    forRanges(refreshed.size(), kBricksTogether, [&](std::size_t begin, std::size_t end) {
        Scratch& scratch = scratches_->local();
        for (std::size_t i = begin; i != end; ++i) {
            constexpr std::size_t kAhead = 3; // few of a brick's lines are read
            if (i + 2 * kAhead < refreshed.size())
                surface.prefetchHead(refreshed[i + 2 * kAhead]);
            if (i + kAhead < refreshed.size())
                surface.prefetch(refreshed[i + kAhead]);
            Corners corners(pointsIn<Sample>(surface.points(refreshed[i])));
            surface.refreshInnerVertices(refreshed[i], scratch.draft, corners, move.isovalue);
        }
    });
    for (Scratch& scratch : *scratches_) {
        if (!scratch.isConsistent)
            return makeError(ErrorCode::Corruption, "index contradicts itself: its edges are not those of its samples",
                             reader_.pathString());
        surface.finishMove(scratch.draft);
        stats.bricksRead += scratch.bricks;
        stats.edgesAdded += scratch.edgesAdded;
        stats.edgesRemoved += scratch.edgesRemoved;
        if (!isListOfEdges_) // else those of the list have been
            stats.edgesTouched += scratch.edgesAdded + scratch.edgesRemoved;
        stats.cellsResolved += scratch.draft.counts.cellsDecided;
        stats.cellsRetriangulated += scratch.draft.counts.cellsChanged;
    }
    return {};
}

template <class Sample>
void BrickSource<Sample>::sortForReading(std::vector<BrickIndex>& bricks, bool backwards) const {
    struct Placed {
        std::uint64_t order;
        BrickIndex brick;
    };
    std::vector<Placed> placed;
    placed.reserve(bricks.size());
    for (const BrickIndex brick : bricks)
        placed.push_back({samples_.orderOf(brick), brick});
    tbb::parallel_sort(placed.begin(), placed.end(), [backwards](const Placed& a, const Placed& b) {
        return backwards ? a.order > b.order : a.order < b.order;
    });
    std::transform(placed.begin(), placed.end(), bricks.begin(), [](const Placed& p) { return p.brick; });
}

// Most of a move is waiting for memory: a brick's lines are asked for while those before are made.
template <class Sample>
void BrickSource<Sample>::prefetchPoints(const LiveSurface<Live>& surface, const Job& job, LinesAhead& ahead) const {
    if (!surface.brick(job.slot).hasPoints) {
        samples_.prefetch(brickOf_[job.slot.index()]);
        return;
    }
    // Without groups nothing reads the normals until the picture is drawn.
    ahead = {surface.points(job.slot), surface.keepsGroups() ? sizeof(Points) : sizeof(Points::samples)};
}

// First what needs nothing but what is in memory; then, in batches and in the order in which samples lie, what must be
// read.
template <class Sample>
Status BrickSource<Sample>::runJobs(const Move& move, LiveSurface<Live>& surface, std::vector<Job> jobs,
                                    SlideStats& stats, const JobControl& control, const Work& work) {
    constexpr std::size_t kAhead = 2; // bricks; one is too few with other programs in the caches, three are no better
    const std::stop_token& stop = control.stop;
    SharedProgress progress(control, jobs.size(), "extracting");
    const auto run = [&](std::span<const Job> some) {
        forRanges(some.size(), kBricksTogether, [&](std::size_t begin, std::size_t end) {
            Scratch& scratch = scratches_->local();
            std::size_t done = 0;
            for (std::size_t i = begin; i < std::min(begin + kAhead, end); ++i) {
                (this->*work.prefetch)(surface, some[i], scratch.ahead);
                scratch.ahead.fetchRest();
            }
            for (std::size_t i = begin; i != end && !stop.stop_requested(); ++i) {
                if (i + 2 * kAhead < some.size())
                    surface.prefetchHead(some[i + 2 * kAhead].slot);
                if (i + kAhead < end) { // beyond, another thread may be changing them
                    (this->*work.prefetch)(surface, some[i + kAhead], scratch.ahead);
                    surface.prefetch(some[i + kAhead].slot);
                }
                if ((this->*work.make)(move, surface, some[i], scratch))
                    ++done;
                else
                    scratch.pending.push_back(some[i]);
            }
            finishStreams();
            progress.add(done);
        });
        return stop.stop_requested() ? Status(cancelledError()) : Status();
    };
    for (Scratch& scratch : *scratches_) {
        scratch.pending.clear();
        scratch.read.clear();
    }
    ISO_TRY(run(jobs));
    std::vector<BrickIndex> bricks;
    for (const Scratch& scratch : *scratches_) {
        samples_.touch(scratch.read);
        for (const Job& job : scratch.pending)
            bricks.push_back(brickOf_[job.slot.index()]);
    }
    if (bricks.empty())
        return {};
    // Alternately forwards and backwards: what a cache smaller than the surface still holds is used before it is
    // evicted.
    readsBackwards_ = !readsBackwards_;
    sortForReading(bricks, readsBackwards_);
    for (std::span<const BrickIndex> rest(bricks); !rest.empty();) {
        const auto ready = samples_.prepare(rest, stats, stop);
        if (!ready.isOk())
            return ready.error();
        std::vector<Job> batch;
        for (const BrickIndex brick : rest.first(ready.value()))
            batch.push_back({BrickSlot(slotOf_[brick.index()] - 1), true});
        ISO_TRY(run(batch));
        rest = rest.subspan(ready.value());
    }
    return {};
}

// The signs that the brick had, if it was there. A brick that was made from its edges has left none: classifyFor()
// finds them again.
template <class Sample>
std::optional<BitsInMemory> BrickSource<Sample>::aboveBefore(const LiveSurface<Live>& surface, const Job& job,
                                                             const Scratch& scratch) const {
    if (job.isNew)
        return std::nullopt;
    return isMadeOfEdges_[job.slot.index()] != 0 ? BitsInMemory(scratch.aboveBefore) : surface.brick(job.slot).above();
}

template <class Sample>
void BrickSource<Sample>::classifyFor(const Move& move, const LiveSurface<Live>& surface, const Job& job,
                                      Scratch& scratch) const {
    const Stored* const samples = pointsOf(surface, job, scratch).samples;
    const BrickMasks& masks = surface.masks(job.slot);
    if (!job.isNew && isMadeOfEdges_[job.slot.index()] != 0) {
        classify(samples, storedThreshold<Sample>(move.from), masks, {}, scratch.found);
        scratch.aboveBefore = scratch.found.above;
    }
    classify(samples, storedThreshold<Sample>(move.to), masks, aboveBefore(surface, job, scratch), scratch.found);
}

// Reads the points of a brick that arrives, with the normals of all: a handle that moves on goes through the brick, and
// to find out which are needed costs as much as to find them. False when samples are wanted that are not ready.
template <class Sample>
bool BrickSource<Sample>::begin(const LiveSurface<Live>& surface, const Job& job, Scratch& scratch) const {
    scratch.draft.newPoints = nullptr;
    if (surface.brick(job.slot).hasPoints) // it was there before, or is back
        return true;
    const BrickIndex brick = brickOf_[job.slot.index()];
    if (!samples_.isReady(brick))
        return false;
    scratch.read.push_back(brick);
    if (std::is_integral_v<Sample> || !surface.brick(job.slot).isNearMissing)
        readPoints(samples_.rows(brick), inverseSpacing_, scratch.points);
    else
        readPointsReference(samples_.rows(brick), inverseSpacing_, scratch.points);
    scratch.draft.newPoints = linesOf<Sample>(scratch.points);
    return true;
}

// False when samples are wanted that are not ready.
template <class Sample>
bool BrickSource<Sample>::rebuild(const Move& move, LiveSurface<Live>& surface, const Job& job, Scratch& scratch) {
    if (!begin(surface, job, scratch))
        return false;
    scratch.ahead.fetchPart();
    classifyFor(move, surface, job, scratch);
    scratch.ahead.fetchPart();
    if (hasNewBound_)
        addOtherLeaves(job.slot, scratch);
    makeUnmerged(move, surface, job, scratch);
    return true;
}

template <class Sample>
void BrickSource<Sample>::makeUnmerged(const Move& move, LiveSurface<Live>& surface, const Job& job, Scratch& scratch) {
    scratch.draft.merged.clear();
    scratch.draft.active = scratch.found.active;
    scratch.draft.ownedEdges = scratch.found.ownedEdges;
    finish(move, surface, job, scratch);
}

// Makes the brick's surface of what has been found out of it. REQUIRES: the draft's active edges and cells, and how
// many edges it owns.
template <class Sample>
void BrickSource<Sample>::finish(const Move& move, LiveSurface<Live>& surface, const Job& job, Scratch& scratch) {
    const ClassifiedBrick<Stored>& found = scratch.found;
    BrickDraft<Live>& draft = scratch.draft;
    draft.above = found.above;
    draft.changed = found.changed;
    draft.edgeVertices = numberEdges(draft.active, draft.codes.data(), draft.vertices);
    for (const MergedCells::Corner& corner : draft.merged.corners())
        draft.codes[draft.vertices.of(corner.edge)] = vertexCode(corner.edge, corner.level);
    scratch.ahead.fetchPart();
    Corners corners(pointsOf(surface, job, scratch));
    surface.replace(job.slot, draft, corners, move.isovalue);
    scratch.ahead.fetchRest();
    watch_[job.slot.index()] = {keyOf(sampleOf<Sample>(found.up)), keyOf(sampleOf<Sample>(found.down))};
    isMadeOfEdges_[job.slot.index()] = 0;
    scratch.edgesAdded += found.edgesAdded;
    scratch.edgesRemoved += found.edgesRemoved;
    ++scratch.bricks;
    compareEdgeCount(surface, job, scratch);
}

// A list of edges has as many of the brick as its surface. Beside missing samples it has edges, too, that only cells of
// other bricks have; at the border of a region cells are smaller than it knows.
template <class Sample>
void BrickSource<Sample>::compareEdgeCount(const LiveSurface<Live>& surface, const Job& job, Scratch& scratch) const {
    if (isListOfEdges_ && hasCounts_ && bound_ == listBound_ && (bound_.limit == 0.0 || !region_) &&
        !surface.brick(job.slot).isNearMissing)
        scratch.isConsistent =
            scratch.isConsistent && activity_.count(brickOf_[job.slot.index()]) == scratch.draft.edgeVertices;
}

template <class Sample>
void BrickSource<Sample>::prefetch(KeyThreshold from, KeyThreshold to) {
    // More than that is a jump, of which there is no knowing where the next one goes. A brick has some hundred edges.
    const std::uint64_t maxEntries = isListOfEdges_ ? 1u << 20 : 1u << 16;
    if (from == to || !samples_.fetchesAhead() || !hasCounts_ || estimateWay(from, to) > maxEntries)
        return;
    ahead_ = {}; // before another begins
    // If anything goes wrong, the move itself will report it; without a thread, nothing is made ahead.
    try {
        ahead_ = std::jthread([this, from, to](std::stop_token stop) {
            try {
                (void)readAhead(from, to, stop);
            } catch (const std::exception&) {}
        });
    } catch (const std::system_error&) {}
}

template <class Sample>
Status BrickSource<Sample>::readAhead(KeyThreshold from, KeyThreshold to, std::stop_token stop) {
    tbb::task_arena one(1); // the picture is being drawn meanwhile
    return one.execute([&]() -> Status {
        SlideStats stats;
        NetBricks net;
        Status fetched = netBricks(std::min(from, to), std::max(from, to), from < to, true, stats, stop, net);
        if (fetched.isOk()) {
            sortForReading(net.arrive, !readsBackwards_);
            fetched = samples_.fetch(net.arrive, stats, stop);
        }
        bytesAhead_ = stats.bytesRead;
        return fetched;
    });
}

#define ISO_INSTANTIATE(Sample, Name) template class BrickSource<Sample>;
ISO_FOR_EACH_SAMPLE_TYPE(ISO_INSTANTIATE)
#undef ISO_INSTANTIATE

} // namespace isoslider::extract
