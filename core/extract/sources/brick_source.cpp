#include "core/extract/sources/brick_source.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <exception>
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

namespace isoslider::extract {
namespace {

constexpr PointRows kAllPointRows = [] {
    PointRows rows{};
    rows.fill((1u << kPointSide) - 1);
    return rows;
}();

// Rows with a point in the string. A plane's 81 bits at a time: each bit becomes the or of itself and the next eight.
PointRows rowsOf(const BitString& points) {
    PointRows rows{};
    const auto bitsAt = [&](std::size_t p) {
        std::uint64_t bits;
        std::memcpy(&bits, reinterpret_cast<const std::byte*>(points.words.data()) + p / 8, sizeof bits);
        return bits >> (p % 8); // 56 of them at least
    };
    constexpr int kRowsAtOnce = 5; // 45 bits, and eight more
    for (std::size_t z = 0; z < rows.size(); ++z) {
        unsigned found = 0;
        for (int first = 0; first < kPointSide; first += kRowsAtOnce) {
            const int count = std::min(kRowsAtOnce, kPointSide - first);
            const std::uint64_t bits = bitsAt(z * kPointStride[2] + static_cast<std::size_t>(kPointSide * first));
            std::uint64_t any = bits | bits >> 1;
            any |= any >> 2;
            any |= any >> 4;
            any |= bits >> 8;
            for (int k = 0; k < count; ++k)
                found |= static_cast<unsigned>(any >> (kPointSide * k) & 1) << (first + k);
        }
        rows[z] = static_cast<std::uint16_t>(found);
    }
    return rows;
}

} // namespace

template <class Sample>
BrickSource<Sample>::BrickSource(const index::IndexReader& bricks, SampleReader<Sample>& samples,
                                 std::uint64_t cacheBytes)
    : WalkedSource<Sample>(bricks, cacheBytes),
      samples_(samples),
      slotOf_(bricks.grid().brickCount()),
      aheadBytes_(std::min(kMaxAheadBytes, cacheBytes / 2)),
      scratches_(std::make_unique<tbb::enumerable_thread_specific<Scratch>>()) {
    slotOf_.grow(bricks.grid().brickCount());
    for (int a = 0; a < 3; ++a) // rounded as where edge blocks are made
        inverseSpacing_[a] = static_cast<float>(1.0 / std::abs(bricks.info().geometry.spacing[a]));
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
    for (const BrickIndex brick : brickOf_)
        slotOf_[brick.index()] = 0;
    watch_.clear();
    brickOf_.clear();
    hasAllNormals_.clear();
    leaves_.clear();
    surelyWithin_.clear();
    shownLeaves_.clear();
}

// Bricks that come or go between two thresholds.
template <class Sample>
Status BrickSource<Sample>::netBricks(KeyThreshold lower, KeyThreshold upper, bool goesUp, SlideStats& stats,
                                      std::stop_token stop, NetBricks& net) {
    tbb::enumerable_thread_specific<NetBricks> nets;
    const auto take = [&](const Part& part) {
        NetBricks& local = nets.local();
        std::size_t entry = part.firstEntry;
        for (std::size_t i = part.begin; i < part.end; ++i, ++entry) { // one entry a record
            const std::uint64_t far = part.page.farKeys[entry];
            if (far >= lower && far < upper)
                continue; // comes and goes within the move
            const BrickIndex brick = brickOf(PointId(part.page.ids[i]));
            ((far > part.page.keys[i]) == goesUp ? local.arrive : local.leave).push_back(brick);
        }
        return entry;
    };
    ISO_TRY(walk_.visit(lower, upper, stats, stop, take));
    for (const NetBricks& local : nets) {
        net.arrive.insert(net.arrive.end(), local.arrive.begin(), local.arrive.end());
        net.leave.insert(net.leave.end(), local.leave.begin(), local.leave.end());
    }
    return {};
}

template <class Sample>
Status BrickSource<Sample>::changeActiveSet(const Move& move, LiveSurface<Live>& surface, SlideStats& stats,
                                            std::stop_token stop, std::vector<Job>& jobs) {
    NetBricks net;
    ISO_TRY(
        netBricks(std::min(move.from, move.to), std::max(move.from, move.to), move.from < move.to, stats, stop, net));
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
    }
    sortForReading(net.arrive, false);
    for (const BrickIndex brick : net.arrive) {
        if (!surface.shapes().hasCells(brick))
            continue;
        if (slotOf_[brick.index()] != 0)
            return makeError(ErrorCode::Corruption, "index contradicts itself: a brick becomes active twice",
                             reader_.pathString());
        const BrickSlot slot = surface.add(brick);
        if (slot.index() >= watch_.size()) {
            watch_.resize(slot.index() + 1);
            brickOf_.resize(slot.index() + 1);
            hasAllNormals_.resize(slot.index() + 1);
            leaves_.resize(slot.index() + 1);
            surelyWithin_.resize(slot.index() + 1);
            shownLeaves_.resize(slot.index() + 1);
        }
        watch_[slot.index()] = {};
        brickOf_[slot.index()] = brick;
        slotOf_[brick.index()] = slot.number() + 1; // the last: whatever fails before, reset() finds all that is set
        jobs.push_back({slot, true});
    }
    return {};
}

// Bricks active before and after: those in which something changes, and others whose vertices inside cells move.
template <class Sample>
void BrickSource<Sample>::listCrossed(const Move& move, const LiveSurface<Live>& surface, std::vector<Job>& jobs,
                                      std::vector<BrickSlot>& refreshed) const {
    for (const BrickSlot slot : firstIds<BrickSlot>(watch_.size())) {
        if (hasNewBound_ ? surface.brick(slot).isLive
                         : watch_[slot.index()].isCrossed(move.from, move.to) ||
                               !surface.stateInterval(slot).contains(move.isovalue))
            jobs.push_back({slot, false});
        else if (surface.hasInnerVertices(slot))
            refreshed.push_back(slot);
    }
}

template <class Sample>
Status BrickSource<Sample>::move(const Move& move, LiveSurface<Live>& surface, SlideStats& stats,
                                 const JobControl& control) {
    ahead_ = {}; // stops it
    stats.bytesAhead += std::exchange(bytesAhead_, 0);
    if (move.from == lowest() || move.from == highest()) // nothing is active there; perhaps a move was broken off
        reset();
    std::vector<Job> jobs;
    std::vector<BrickSlot> refreshed;
    listCrossed(move, surface, jobs, refreshed);
    std::vector<Job> arrived;
    ISO_TRY(changeActiveSet(move, surface, stats, control.stop, arrived));
    std::erase_if(jobs, [&](const Job& job) { return !surface.brick(job.slot).isLive; }); // crossed and left
    std::erase_if(refreshed, [&](BrickSlot slot) { return !surface.brick(slot).isLive; });
    // A slot that a leaving brick gave up may be an arriving one's.
    std::vector<bool> isNew(watch_.size(), false);
    for (const Job& job : arrived)
        isNew[job.slot.index()] = true;
    std::erase_if(jobs, [&](const Job& job) { return isNew[job.slot.index()]; });
    std::erase_if(refreshed, [&](BrickSlot slot) { return isNew[slot.index()]; });
    jobs.insert(jobs.end(), arrived.begin(), arrived.end());
    isJump_ = arrived.size() > watch_.size() / kJumpShare;
    lacksNormals_ = lacksNormals_ || isJump_;

    for (Scratch& scratch : *scratches_) {
        scratch.draft.beginMove();
        scratch.bricks = scratch.edgesAdded = scratch.edgesRemoved = 0;
    }
    if (hasNewBound_ && bound_.limit == 0.0)
        leaves_.assign(leaves_.size(), {});
    if (bound_.limit > 0.0)
        ISO_TRY(runMerging(move, surface, std::move(jobs), stats, control));
    else
        ISO_TRY(runJobs(move, surface, std::move(jobs), stats, control, &BrickSource::rebuild));
    hasNewBound_ = false;
    forRanges(refreshed.size(), kBricksTogether, [&](std::size_t begin, std::size_t end) {
        Scratch& scratch = scratches_->local();
        for (std::size_t i = begin; i != end; ++i) {
            Corners corners(pointsIn<Sample>(surface.points(refreshed[i])));
            surface.refreshInnerVertices(refreshed[i], scratch.draft, corners, move.isovalue);
        }
    });
    for (const Scratch& scratch : *scratches_) {
        surface.finishMove(scratch.draft);
        stats.bricksRead += scratch.bricks;
        stats.edgesAdded += scratch.edgesAdded;
        stats.edgesRemoved += scratch.edgesRemoved;
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

// Most of a move is waiting for memory: a brick's lines are asked for while the one before is made.
template <class Sample>
void BrickSource<Sample>::prefetchPoints(const LiveSurface<Live>& surface, const Job& job) const {
    if (job.isNew) {
        samples_.prefetch(brickOf_[job.slot.index()]);
        return;
    }
    // Of the samples only: nothing reads the normals until the picture is drawn.
    const auto* const points = reinterpret_cast<const char*>(surface.newestPoints(job.slot));
    for (std::size_t line = 0; line < sizeof(Points::samples); line += 64)
        __builtin_prefetch(points + line, 0, 2);
}

// First what needs nothing but what is in memory; then, in batches and in the order in which samples lie, what must be
// read.
template <class Sample>
Status BrickSource<Sample>::runJobs(const Move& move, LiveSurface<Live>& surface, std::vector<Job> jobs,
                                    SlideStats& stats, const JobControl& control, Work work) {
    constexpr std::size_t kAhead =
        2; // bricks; one is too few where other programs have been in the caches, three are no better
    const std::stop_token& stop = control.stop;
    SharedProgress progress(control, jobs.size(), "extracting");
    const auto run = [&](std::span<const Job> some) {
        forRanges(some.size(), kBricksTogether, [&](std::size_t begin, std::size_t end) {
            Scratch& scratch = scratches_->local();
            std::size_t done = 0;
            for (std::size_t i = begin; i < std::min(begin + kAhead, end); ++i)
                prefetchPoints(surface, some[i]);
            for (std::size_t i = begin; i != end && !stop.stop_requested(); ++i) {
                if (i + 2 * kAhead < some.size())
                    surface.prefetchHead(some[i + 2 * kAhead].slot);
                if (i + kAhead < end) { // beyond, another thread may be changing them
                    prefetchPoints(surface, some[i + kAhead]);
                    surface.prefetch(some[i + kAhead].slot);
                }
                if ((this->*work)(move, surface, some[i], scratch))
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
    std::vector<bool> isNew(watch_.size(), false);
    for (const Scratch& scratch : *scratches_) {
        samples_.touch(scratch.read);
        for (const Job& job : scratch.pending) {
            bricks.push_back(brickOf_[job.slot.index()]);
            isNew[job.slot.index()] = job.isNew;
        }
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
            batch.push_back({BrickSlot(slotOf_[brick.index()] - 1), isNew[slotOf_[brick.index()] - 1]});
        ISO_TRY(run(batch));
        rest = rest.subspan(ready.value());
    }
    return {};
}

// The samples of the block that was read as the brick's points: ordered, and without what would disturb comparisons.
// Outside the box and at missing values stands some sample of the brick; masks leave those points out.
template <class Sample>
void BrickSource<Sample>::take(BrickIndex brick, bool isNearMissing, Points& points, Scratch& scratch) const {
    const SampleRows<Sample> rows = samples_.rows(brick);
    const bool isInside = std::min({rows.end[0], rows.end[1], rows.end[2]}) >= kPointSide;
    if (isInside && (std::is_integral_v<Sample> || !isNearMissing)) {
        Stored* out = points.samples;
        for (int z = 0; z < kPointSide; ++z)
            for (int y = 0; y < kPointSide; ++y, out += kPointSide) {
                const auto row = rows.row(y, z);
                if constexpr (std::is_same_v<Sample, Stored>)
                    std::memcpy(out, row.own, kBrickSide * sizeof(Stored));
                else
                    for (int x = 0; x < kBrickSide; ++x)
                        out[x] = storedOf(row.own[x]);
                out[kBrickSide] = storedOf(row.behind[0]);
            }
        std::fill(out, points.samples + kPaddedPoints, points.samples[0]);
        return;
    }
    SampleBlock<Sample>& block = scratch.block;
    readBlock(rows, kAllRows, block);
    Stored any{};
    bool hasAny = false;
    for (int z = 0; z < std::min(kPointSide, block.end[2]) && !hasAny; ++z)
        for (int y = 0; y < std::min(kPointSide, block.end[1]) && !hasAny; ++y)
            for (int x = 0; x < std::min(kPointSide, block.end[0]) && !hasAny; ++x)
                if (const Sample s = block.samples[static_cast<std::size_t>(block.offset(x, y, z))]; !isMissing(s)) {
                    any = storedOf(s);
                    hasAny = true;
                }
    Stored* out = points.samples;
    for (int z = 0; z < kPointSide; ++z)
        for (int y = 0; y < kPointSide; ++y) {
            const Sample* row = block.samples.data() + block.offset(0, y, z);
            for (int x = 0; x < kPointSide; ++x) {
                const bool exists = isInside || block.isInside(x, y, z);
                *out++ = exists && !isMissing(row[x]) ? storedOf(row[x]) : any;
            }
        }
    std::fill(out, points.samples + kPaddedPoints, any);
}

// Normals at the brick's points. In a jump only those that its active edges need: it pays for no more than it shows.
// Else all of them, for a handle that moves on goes through the brick, and finding some at each move would cost more
// than half as much again, most of it waiting for samples. False when samples are wanted that are not ready.
template <class Sample>
bool BrickSource<Sample>::completeNormals(const LiveSurface<Live>& surface, const Job& job, bool wantsAll,
                                          Scratch& scratch) {
    std::uint8_t& hasAll = hasAllNormals_[job.slot.index()];
    if (!job.isNew && hasAll != 0)
        return true;
    const BrickIndex brick = brickOf_[job.slot.index()];
    BitString ends;
    PointRows rows;
    if (wantsAll) {
        rows = kAllPointRows;
    } else {
        endsOfEdges(scratch.found.active.edges, ends);
        rows = rowsOf(ends);
    }
    if (!job.isNew) {
        if (!samples_.isReady(brick))
            return false;
        scratch.read.push_back(brick);
        // Pictures may refer to what is there.
        std::memcpy(scratch.points.samples, pointsOf(surface, job, scratch).samples, sizeof(Points::samples));
        scratch.draft.newPoints = linesOf<Sample>(scratch.points);
    }
    hasAll = wantsAll;
    findNormalsOf(brick, surface.brick(job.slot).isNearMissing, rows, wantsAll ? nullptr : &ends, scratch);
    return true;
}

// Normals of scratch.points in these rows, or only of those points in them that are set in `only`. REQUIRES: the brick
// is ready.
template <class Sample>
void BrickSource<Sample>::findNormalsOf(BrickIndex brick, bool isNearMissing, const PointRows& rows,
                                        const BitString* only, Scratch& scratch) const {
    Points& points = scratch.points;
    if (!kHasNormalKernel<Sample> || isNearMissing) {
        readBlock(samples_.rows(brick), rowsForGradients(rows), scratch.block);
        findNormalsReference(scratch.block, rows, inverseSpacing_, points.normals);
    } else if constexpr (kHasNormalKernel<Sample>) {
        readApron(samples_.rows(brick), rows, scratch.floats);
        if (only)
            findNormalsAt<Sample>(*only, points.samples, scratch.floats, inverseSpacing_, points.normals);
        else
            findNormals<Sample>(points.samples, scratch.floats, rows, inverseSpacing_, points.normals);
    }
}

template <class Sample>
void BrickSource<Sample>::classifyFor(const Move& move, const LiveSurface<Live>& surface, const Job& job,
                                      Scratch& scratch) const {
    classify(pointsOf(surface, job, scratch).samples, storedThreshold<Sample>(move.to), surface.masks(job.slot),
             job.isNew ? nullptr : &surface.brick(job.slot).above, scratch.found);
}

// Reads the samples of a brick that arrives; one that stays gets the points that have been made for it meanwhile. False
// when samples are wanted that are not ready.
template <class Sample>
bool BrickSource<Sample>::begin(LiveSurface<Live>& surface, const Job& job, Scratch& scratch) {
    scratch.draft.newPoints = nullptr;
    if (!job.isNew) {
        if (surface.takeNextPoints(job.slot, scratch.draft))
            hasAllNormals_[job.slot.index()] = 1;
        return true;
    }
    const BrickIndex brick = brickOf_[job.slot.index()];
    if (!samples_.isReady(brick))
        return false;
    scratch.read.push_back(brick);
    take(brick, surface.brick(job.slot).isNearMissing, scratch.points, scratch);
    scratch.draft.newPoints = linesOf<Sample>(scratch.points);
    return true;
}

// False when samples are wanted that are not ready.
template <class Sample>
bool BrickSource<Sample>::rebuild(const Move& move, LiveSurface<Live>& surface, const Job& job, Scratch& scratch) {
    if (!begin(surface, job, scratch))
        return false;
    classifyFor(move, surface, job, scratch);
    if (!completeNormals(surface, job, !isJump_, scratch))
        return false;
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
    Corners corners(pointsOf(surface, job, scratch));
    surface.replace(job.slot, draft, corners, move.isovalue);
    watch_[job.slot.index()] = {keyOf(sampleOf<Sample>(found.up)), keyOf(sampleOf<Sample>(found.down))};
    scratch.edgesAdded += found.edgesAdded;
    scratch.edgesRemoved += found.edgesRemoved;
    ++scratch.bricks;
}

template <class Sample>
void BrickSource<Sample>::prefetch(KeyThreshold from, KeyThreshold to, LiveSurface<Live>& surface) {
    // More than that is a jump, of which there is no knowing where the next one goes.
    constexpr std::uint64_t kMaxEntries = 1u << 16;
    const bool reads =
        from != to && samples_.fetchesAhead() && walk_.estimate(std::min(from, to), std::max(from, to)) <= kMaxEntries;
    ahead_ = {}; // before another begins
    if (!reads && !lacksNormals_)
        return;
    // If anything goes wrong, the move itself will report it; without a thread, nothing is made ahead.
    try {
        ahead_ = std::jthread([this, from, to, reads, &surface](std::stop_token stop) {
            try {
                if (reads)
                    (void)readAhead(from, to, stop);
                if (lacksNormals_)
                    completeAhead(from, surface, stop);
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
        Status fetched = netBricks(std::min(from, to), std::max(from, to), from < to, stats, stop, net);
        if (fetched.isOk()) {
            for (const BrickSlot slot : firstIds<BrickSlot>(watch_.size()))
                if (watch_[slot.index()].isCrossed(from, to))
                    net.arrive.push_back(brickOf_[slot.index()]);
            sortForReading(net.arrive, !readsBackwards_);
            fetched = samples_.fetch(net.arrive, stats, stop);
        }
        bytesAhead_ = stats.bytesRead;
        return fetched;
    });
}

// The bricks whose samples lie nearest to the position are those that the next moves cross, in whichever direction:
// they get points with all normals beside those that they have. Only where a jump has left normals out: a surface that
// has been slid through has them all.
template <class Sample>
void BrickSource<Sample>::completeAhead(KeyThreshold at, LiveSurface<Live>& surface, std::stop_token stop) {
    struct Candidate {
        std::uint64_t distance; // in keys
        BrickSlot slot;
        bool operator<(const Candidate& other) const { return distance < other.distance; }
    };
    std::vector<Candidate> nearest;
    for (const BrickSlot slot : firstIds<BrickSlot>(watch_.size()))
        if (const Watch& watch = watch_[slot.index()]; hasAllNormals_[slot.index()] == 0 && surface.brick(slot).isLive)
            nearest.push_back({std::min(watch.up - at, at - 1 - watch.down), slot});
    lacksNormals_ = !nearest.empty();
    const std::size_t most = aheadBytes_ / sizeof(Points);
    if (nearest.size() > most) {
        std::nth_element(nearest.begin(), nearest.begin() + static_cast<std::ptrdiff_t>(most), nearest.end());
        for (const Candidate& far : std::span(nearest).subspan(most))
            surface.dropNextPoints(far.slot);
        nearest.resize(most);
    }
    std::sort(nearest.begin(), nearest.end());
    if (!aheadScratch_)
        aheadScratch_ = std::make_unique<Scratch>();
    Scratch& scratch = *aheadScratch_;
    for (const Candidate& near : nearest) {
        if (stop.stop_requested())
            return;
        const BrickIndex brick = brickOf_[near.slot.index()];
        if (surface.hasNextPoints(near.slot) || !samples_.isReady(brick))
            continue;
        std::memcpy(scratch.points.samples, pointsIn<Sample>(surface.points(near.slot)).samples,
                    sizeof(Points::samples));
        findNormalsOf(brick, surface.brick(near.slot).isNearMissing, kAllPointRows, nullptr, scratch);
        std::memcpy(static_cast<void*>(surface.roomForNextPoints(near.slot)), &scratch.points, sizeof(Points));
    }
}

#define ISO_INSTANTIATE(Sample, Name) template class BrickSource<Sample>;
ISO_FOR_EACH_SAMPLE_TYPE(ISO_INSTANTIATE)
#undef ISO_INSTANTIATE

} // namespace isoslider::extract
