#include "core/extract/sources/edge_block_source.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cstring>
#include <optional>

#include "core/base/job_control.h"
#include "core/base/shared_progress.h"
#include "core/base/worker_team.h"
#include "core/extract/live/cell_triangles.h"
#include "core/extract/live/stream_copy.h"
#include "core/extract/sources/edge_scratch.h"
#include "core/extract/sources/lines_ahead.h"
#include "core/extract/sources/sample_kernels.h"

namespace isoslider::extract {
namespace {

constexpr std::uint64_t kKeptEntries = 1u << 16;
constexpr std::uint32_t kArriving = ~std::uint32_t{0}; ///< in place of a slot, until there is one

} // namespace

// Corner scalars of cells from the points at the ends of their active edges; the corner that lies on none is looked up.
template <class Sample>
class EdgeBlockSource<Sample>::Corners final : public CornerScalarsOfBrick {
public:
    Corners(index::HiddenCorners& hidden, BrickIndex brick, const Points& points, std::optional<Error>& error)
        : hidden_(hidden), brick_(brick), points_(points), error_(error) {}

    bool cornerScalars(ClosedPoint cell, std::uint8_t signs, cell::CornerScalars& scalars) override {
        for (unsigned mask = cell::activeEdges(signs); mask != 0; mask &= mask - 1) {
            const auto& edge = cell::kCellEdges[static_cast<std::size_t>(std::countr_zero(mask))];
            for (const auto corner : {edge.lowerCorner, edge.upperCorner})
                scalars[corner] = scalarAt(cell, corner);
        }
        const int corner = cell::hiddenCorner(signs);
        if (corner < 0)
            return true;
        scalars[static_cast<std::size_t>(corner)] = 0.0; // matters only for tunnels
        const auto c = coordsOf(cell);
        auto found = hidden_.find(brick_, LocalPoint(c[0] + 8 * (c[1] + 8 * c[2])), corner);
        if (!found.isOk()) {
            error_ = std::move(found).error();
            return false;
        }
        if (!found.value())
            return false;
        scalars[static_cast<std::size_t>(corner)] = *found.value();
        return true;
    }

private:
    double scalarAt(ClosedPoint cell, unsigned corner) const {
        const std::size_t point = cell.index() + (corner & 1) + 9 * (corner >> 1 & 1) + 81 * (corner >> 2);
        return static_cast<double>(sampleOf<Sample>(points_.samples[point]));
    }

    index::HiddenCorners& hidden_;
    BrickIndex brick_;
    const Points& points_;
    std::optional<Error>& error_;
};

template <class Sample>
void EdgeBlockSource<Sample>::Lists::clear() {
    for (std::size_t p = 0; p < kPartitions; ++p) {
        activated[p].clear();
        deactivated[p].clear();
        leaves[p].clear();
    }
    edgesAdded = edgesRemoved = 0;
}

template <class Sample>
EdgeBlockSource<Sample>::EdgeBlockSource(const index::IndexReader& reader, std::uint64_t cacheBytes)
    : WalkedSource<Sample>(reader,
                           hasNormalChunks(reader.info()) ? cacheBytes - cacheBytes / kNormalsShare : cacheBytes),
      merges_(reader.info().mergeError > 0.0),
      normals_(hasNormalChunks(reader.info()) ? std::make_unique<StoredNormals>(reader, cacheBytes / kNormalsShare)
                                              : nullptr),
      hiddenCorners_(reader),
      slotOf_(reader.grid().brickCount()),
      edges_(reader.grid().brickCount()),
      lists_(std::make_unique<tbb::enumerable_thread_specific<Lists>>()),
      scratches_(std::make_unique<tbb::enumerable_thread_specific<Scratch>>()) {
    const std::uint64_t bricks = reader.grid().brickCount();
    partitionScale_ = ((std::uint64_t{kPartitions} << 32) - 1) / std::max<std::uint64_t>(1, bricks);
    slotOf_.grow(bricks);
    for (int a = 0; a < 3; ++a)
        cellBricks_[a] = (reader.grid().dims()[a] + kCellSide - 2) / kCellSide;
    allHaveCells_ = cellBricks_ == reader.grid().bricks();
}

template <class Sample>
EdgeBlockSource<Sample>::~EdgeBlockSource() = default;

template <class Sample>
void EdgeBlockSource<Sample>::reset() {
    slotOf_.shrink(0);
    slotOf_.grow(reader_.grid().brickCount());
    edges_.shrink(0);
    leaves_.clear();
    changes_.clear();
}

template <class Sample>
std::size_t EdgeBlockSource<Sample>::collect(const Part& part, KeyThreshold lower, KeyThreshold upper, bool goesUp) {
    Lists& lists = lists_->local();
    const BrickGrid& grid = reader_.grid();
    const index::DecodedPage<Key>& page = part.page;
    std::size_t entry = part.firstEntry;
    static constexpr int kLocalStride[3] = {1, 8, 64};
    for (std::size_t i = part.begin; i < part.end; ++i) {
        if (page.form(i) != index::record_form::kPoint) {
            if (const std::uint64_t other = page.farKeys[entry]; other < lower || other >= upper)
                collectMerged(part, i, entry, goesUp, lists);
            entry += static_cast<std::size_t>(std::popcount(page.masks[i]));
            continue;
        }
        const PointId id(page.ids[i]);
        const Key key = page.keys[i];
        const Stored near = storedOf(sampleOfKey<Sample>(key));
        for (unsigned mask = page.masks[i]; mask != 0; mask &= mask - 1, ++entry) {
            const std::uint64_t farKey = page.farKeys[entry];
            if (farKey >= lower && farKey < upper)
                continue; // redundant: crossed at both ends
            const int e = std::countr_zero(mask);
            const int axis = e >> 1;
            const bool isUpward = e & 1;
            PointId start = id;
            if (!isUpward) { // the edge starts at the far end
                const int local = localOf(id).number();
                const bool leaves = (local / kLocalStride[axis] & 7) == 0;
                start = leaves ? id - grid.brickStride(axis) * kBrickPoints + 7 * kLocalStride[axis]
                               : id - kLocalStride[axis];
            }
            if ((farKey > key) != goesUp) {
                ++lists.edgesRemoved;
                forEachHolder(start, axis, [&](BrickIndex brick, ClosedEdge edge) {
                    lists.deactivated[partitionOf(brick)].push_back({brick, edge});
                });
                continue;
            }
            ++lists.edgesAdded;
            const Stored far = storedOf(sampleOfKey<Sample>(page.farKeys[entry]));
            const NormalCode nearNormal = page.hasNormals() ? page.normals[i] : kNoNormal,
                             farNormal = page.hasNormals() ? page.farNormals[entry] : kNoNormal;
            forEachHolder(start, axis, [&](BrickIndex brick, ClosedEdge edge) {
                lists.activated[partitionOf(brick)].push_back(
                    isUpward ? Activated{brick, edge, 0, nearNormal, farNormal, near, far}
                             : Activated{brick, edge, 0, farNormal, nearNormal, far, near});
            });
        }
    }
    return entry;
}

// Slots for bricks that have none yet. A partition's bricks are looked at by one thread.
template <class Sample>
Status EdgeBlockSource<Sample>::addArrivingBricks(LiveSurface<Live>& surface, SlideStats& stats,
                                                  const JobControl& job) {
    for (Scratch& scratch : *scratches_)
        scratch.arriving.clear();
    std::atomic<bool> isConsistent{true};
    forEachIndex(kPartitions, 1, [&](std::size_t partition) {
        Scratch& scratch = scratches_->local();
        for (const Lists& lists : *lists_)
            for (const Activated& change : lists.activated[partition])
                if (std::uint32_t& slot = slotOf_[change.brick.index()]; slot == 0) {
                    slot = kArriving;
                    scratch.arriving.push_back(change.brick);
                }
        for (const Lists& lists : *lists_) // only a damaged index takes from a brick that has nothing
            for (const Deactivated& change : lists.deactivated[partition])
                if (slotOf_[change.brick.index()] == 0 && !surface.shapes().isNearMissing(change.brick))
                    isConsistent = false;
    });
    std::vector<BrickIndex> arriving;
    for (const Scratch& scratch : *scratches_)
        for (const BrickIndex brick : scratch.arriving) {
            arriving.push_back(brick);
            const BrickSlot added = surface.add(brick);
            edges_.grow(added.index() + 1);
            edges_[added.index()] = {};
            if (added.index() < leaves_.size())
                leaves_[added.index()] = {};
            slotOf_[brick.index()] = added.number() + 1;
        }
    changes_.resize(surface.slotCount());
    leaves_.resize(surface.slotCount());
    if (!isConsistent)
        return makeError(ErrorCode::Corruption, "index contradicts itself: an edge changes twice",
                         reader_.pathString());
    return normals_ ? startPoints(surface, std::move(arriving), stats, job) : Status();
}

// The normals of all points of bricks that arrive: entries bring scalars only.
template <class Sample>
Status EdgeBlockSource<Sample>::startPoints(LiveSurface<Live>& surface, std::vector<BrickIndex> bricks,
                                            SlideStats& stats, const JobControl& job) {
    std::vector<std::pair<std::uint64_t, BrickIndex>> placed;
    placed.reserve(bricks.size());
    for (const BrickIndex brick : bricks)
        placed.emplace_back(normals_->orderOf(brick), brick);
    std::sort(placed.begin(), placed.end());
    std::transform(placed.begin(), placed.end(), bricks.begin(), [](const auto& entry) { return entry.second; });
    return normals_->read(
        bricks,
        [&](std::size_t i) {
            auto& points = pointsIn<Sample>(surface.pointsToStart(BrickSlot(slotOf_[bricks[i].index()] - 1)));
            std::memset(static_cast<void*>(points.samples), 0, sizeof points.samples);
            return points.normals;
        },
        stats, job);
}

// Brings what was collected for a partition into the order of its bricks: each is made from entries that lie together.
template <class Sample>
void EdgeBlockSource<Sample>::sortChanges(std::size_t partition, Scratch& scratch) {
    scratch.touched.clear();
    const auto forEachChange = [&](const auto& list, const auto& visit) {
        for (const Lists& lists : *lists_)
            for (const auto& change : (lists.*list)[partition])
                if (const std::uint32_t slot = slotOf_[change.brick.index()]; slot != 0)
                    visit(BrickSlot(slot - 1), changes_[slot - 1], change);
    };
    const auto touch = [&](BrickSlot slot, const Changes& changes) {
        if (changes.isEmpty())
            scratch.touched.push_back(slot);
    };
    forEachChange(&Lists::activated, [&](BrickSlot slot, Changes& changes, const Activated&) {
        touch(slot, changes);
        ++changes.activated;
    });
    forEachChange(&Lists::deactivated, [&](BrickSlot slot, Changes& changes, const Deactivated&) {
        touch(slot, changes);
        ++changes.deactivated;
    });
    forEachChange(&Lists::leaves, [&](BrickSlot slot, Changes& changes, const ChangedLeaf&) {
        touch(slot, changes);
        changes.hasChangedLeaves = true;
    });
    std::sort(scratch.touched.begin(), scratch.touched.end());
    std::uint32_t activated = 0, deactivated = 0;
    for (const BrickSlot slot : scratch.touched) {
        Changes& changes = changes_[slot.index()];
        changes.activatedEnd = activated; // where the next one goes
        changes.deactivatedEnd = deactivated;
        activated += changes.activated;
        deactivated += changes.deactivated;
    }
    scratch.activated.resize(activated);
    scratch.deactivated.resize(deactivated);
    forEachChange(&Lists::activated, [&](BrickSlot, Changes& changes, const Activated& change) {
        scratch.activated[changes.activatedEnd++] = change;
    });
    forEachChange(&Lists::deactivated, [&](BrickSlot, Changes& changes, const Deactivated& change) {
        scratch.deactivated[changes.deactivatedEnd++] = change;
    });
}

// Bricks in which a cell changes though none of its edges does, and those whose vertices inside cells move.
template <class Sample>
void EdgeBlockSource<Sample>::listCrossedSaddles(const Move& move, const LiveSurface<Live>& surface,
                                                 std::vector<BrickSlot>& crossed,
                                                 std::vector<BrickSlot>& refreshed) const {
    for (const BrickSlot slot : firstIds<BrickSlot>(changes_.size())) {
        if (!changes_[slot.index()].isEmpty())
            continue;
        if (!surface.stateInterval(slot).contains(move.isovalue))
            crossed.push_back(slot);
        else if (surface.hasInnerVertices(slot))
            refreshed.push_back(slot);
    }
}

template <class Sample>
Status EdgeBlockSource<Sample>::move(const Move& move, LiveSurface<Live>& surface, SlideStats& stats,
                                     const JobControl& job) {
    const std::stop_token& stop = job.stop;
    if (move.from == lowest() || move.from == highest())
        reset();
    const KeyThreshold lower = std::min(move.from, move.to), upper = std::max(move.from, move.to);
    // What a jump has left in the lists is given back when steps become small.
    if (lastCollected_ > 4 * this->estimate(move.from, move.to) + kKeptEntries)
        lists_->clear();
    for (Lists& lists : *lists_)
        lists.clear();
    for (Scratch& scratch : *scratches_)
        scratch.beginMove();
    ISO_TRY(walk_.visit(lower, upper, stats, stop,
                        [&](const Part& part) { return collect(part, lower, upper, move.from < move.to); }));
    lastCollected_ = 0;
    for (const Lists& lists : *lists_) {
        stats.edgesAdded += lists.edgesAdded;
        stats.edgesRemoved += lists.edgesRemoved;
        lastCollected_ += lists.edgesAdded + lists.edgesRemoved;
    }
    ISO_TRY(addArrivingBricks(surface, stats, job.part(0.0, 0.5)));
    const std::uint64_t hiddenBytes = hiddenCorners_.bytesRead();

    std::vector<BrickSlot> beside;
    if (merges_) {
        forEachIndex(kPartitions, 1, [&](std::size_t partition) { changeLeaves(partition, scratches_->local()); });
        listBesideLeaves(surface, beside);
        for (Scratch& scratch : *scratches_)
            for (const auto& [slot, before] : scratch.otherLeaves)
                changes_[slot.index()].hasChangedLeaves = false; // until they are sorted
    }

    // Which bricks change must be known before the others are looked through.
    std::vector<BrickSlot> crossed, refreshed;
    std::array<std::vector<BrickSlot>, kPartitions> changedBy;
    const JobControl making = job.part(normals_ ? 0.5 : 0.0, 1.0);
    SharedProgress progress(making, kPartitions, "extracting");
    forEachIndex(kPartitions, 1, [&](std::size_t partition) {
        Scratch& scratch = scratches_->local();
        sortChanges(partition, scratch);
        changedBy[partition] = scratch.touched;
        const std::vector<BrickSlot>& slots = changedBy[partition];
        for (std::size_t i = 0; i < slots.size(); ++i) {
            if (stop.stop_requested())
                return;
            constexpr std::size_t kAhead = 2;
            if (i + 2 * kAhead < slots.size())
                surface.prefetchHead(slots[i + 2 * kAhead]);
            if (i + kAhead < slots.size())
                prefetchBrick(slots[i + kAhead], surface);
            changeBrick(slots[i], move, surface, scratch);
        }
        finishStreams();
        progress.add(1);
    });
    if (stop.stop_requested())
        return cancelledError();
    const auto mark = [&](std::span<const BrickSlot> slots, const Changes& changes) {
        for (const BrickSlot slot : slots)
            changes_[slot.index()] = changes;
    };
    Changes made;
    made.isMade = true;
    for (const std::vector<BrickSlot>& slots : changedBy)
        mark(slots, made);
    for (const BrickSlot slot : beside)
        if (changes_[slot.index()].isEmpty())
            crossed.push_back(slot);
    mark(crossed, made);
    listCrossedSaddles(move, surface, crossed, refreshed);
    for (const std::vector<BrickSlot>& slots : changedBy)
        mark(slots, {});
    mark(crossed, {});
    forEachIndex(crossed.size(), kBricksTogether, [&](std::size_t i) {
        if (!stop.stop_requested())
            changeBrick(crossed[i], move, surface, scratches_->local());
        finishStreams();
    });
    forEachIndex(refreshed.size(), kBricksTogether, [&](std::size_t i) {
        if (stop.stop_requested())
            return;
        Scratch& scratch = scratches_->local();
        scratch.draft.newPoints = nullptr;
        Corners corners(hiddenCorners_, surface.brick(refreshed[i]).index, pointsOf(refreshed[i], surface, scratch),
                        scratch.error);
        surface.refreshInnerVertices(refreshed[i], scratch.draft, corners, move.isovalue);
    });
    if (stop.stop_requested())
        return cancelledError();

    for (Scratch& scratch : *scratches_) {
        if (scratch.error)
            return std::move(*scratch.error);
        if (!scratch.isConsistent)
            return makeError(ErrorCode::Corruption, "index contradicts itself: its edges are those of no scalars",
                             reader_.pathString());
        surface.finishMove(scratch.draft);
        stats.cellsResolved += scratch.draft.counts.cellsDecided;
        stats.cellsRetriangulated += scratch.draft.counts.cellsChanged;
    }
    for (const Scratch& scratch : *scratches_)
        for (const BrickSlot slot : scratch.emptied) {
            slotOf_[surface.brick(slot).index.index()] = 0;
            surface.remove(slot);
        }
    stats.bytesRead += hiddenCorners_.bytesRead() - hiddenBytes;
    return {};
}

template <class Sample>
void EdgeBlockSource<Sample>::prefetchBrick(BrickSlot slot, const LiveSurface<Live>& surface) const {
    LinesAhead(&edges_[slot.index()], sizeof edges_[slot.index()]).fetchRest();
    surface.prefetch(slot);
    if (surface.brick(slot).hasPoints)
        LinesAhead(surface.points(slot), sizeof(Points)).fetchRest();
}

// Applies the changes of a brick to its bits. False when they contradict each other.
template <class Sample>
bool EdgeBlockSource<Sample>::toggle(BrickSlot slot, const LiveSurface<Live>& surface, const Scratch& scratch) {
    std::array<BitString, 3>& edges = edges_[slot.index()];
    const BrickMasks& masks = surface.masks(slot);
    const auto flip = [&](ClosedEdge edge, bool wasActive) {
        const auto axis = static_cast<std::size_t>(axisOf(edge));
        const ClosedPoint p = startOf(edge);
        if (!masks.edges[axis].test(p))
            return true; // of no valid cell of this brick
        if (edges[axis].test(p) != wasActive)
            return false;
        edges[axis].flip(p);
        return true;
    };
    for (const Deactivated& change : deactivatedIn(slot, scratch))
        if (!flip(change.edge, true))
            return false;
    for (const Activated& change : activatedIn(slot, scratch))
        if (!flip(change.edge, false))
            return false;
    return true;
}

// Where the points of the brick are: those that it will have from now on.
template <class Sample>
auto EdgeBlockSource<Sample>::pointsOf(BrickSlot slot, const LiveSurface<Live>& surface, const Scratch& scratch)
    -> const Points& {
    return scratch.draft.newPoints ? scratch.points : pointsIn<Sample>(surface.points(slot));
}

// Scalars, and normals that entries bring, at the ends of edges that came. A point that is there already gets what it
// has.
template <class Sample>
void EdgeBlockSource<Sample>::fillPoints(BrickSlot slot, const LiveSurface<Live>& surface, Scratch& scratch) const {
    scratch.draft.newPoints = nullptr;
    const bool isNew = !surface.brick(slot).hasPoints;
    if (changes_[slot.index()].activated == 0 && !isNew)
        return;
    if (isNew && !normals_)
        std::memset(static_cast<void*>(&scratch.points), 0, sizeof scratch.points);
    else // pictures may refer to what is there
        std::memcpy(static_cast<void*>(&scratch.points), surface.points(slot), sizeof scratch.points);
    scratch.draft.newPoints = linesOf<Sample>(scratch.points);
    for (const Activated& activated : activatedIn(slot, scratch)) {
        const auto [lower, upper] = endsOf(vertexCode(activated.edge, activated.level));
        scratch.points.samples[lower] = activated.scalar1;
        scratch.points.samples[upper] = activated.scalar2;
        if (normals_)
            continue;
        scratch.points.normals[lower] = activated.normal1;
        scratch.points.normals[upper] = activated.normal2;
    }
}

// The vertices of edges that stay and of those that came, with the levels of their leaf edges.
template <class Sample>
void EdgeBlockSource<Sample>::numberVertices(BrickSlot slot, const LiveSurface<Live>& surface, Scratch& scratch) const {
    BrickDraft<Live>& draft = scratch.draft;
    draft.active.edges = edges_[slot.index()];
    draft.edgeVertices = numberEdges(draft.active, draft.codes.data(), draft.vertices);
    if (!merges_)
        return;
    const auto setLevel = [&](ClosedEdge edge, int level) {
        if (draft.active.edges[static_cast<std::size_t>(axisOf(edge))].test(startOf(edge)))
            draft.codes[draft.vertices.of(edge)] = vertexCode(edge, level);
    };
    const std::uint32_t had = surface.brick(slot).edgeVertices;
    const VertexCode* const old = had > 0 ? surface.codes(slot) : nullptr;
    for (std::uint32_t k = 0; k < had; ++k)
        setLevel(edgeOf(old[k]), levelOf(old[k]));
    for (const Activated& change : activatedIn(slot, scratch))
        setLevel(change.edge, change.level);
}

template <class Sample>
void EdgeBlockSource<Sample>::changeBrick(BrickSlot slot, const Move& move, LiveSurface<Live>& surface,
                                          Scratch& scratch) {
    BrickDraft<Live>& draft = scratch.draft;
    const bool isNew = surface.brick(slot).edgeVertices == 0;
    const std::array<BitString, 3> before = edges_[slot.index()];
    if (!toggle(slot, surface, scratch)) {
        scratch.isConsistent = false;
        return;
    }
    const std::array<BitString, 3>& after = edges_[slot.index()];
    fillPoints(slot, surface, scratch);
    numberVertices(slot, surface, scratch);
    if (draft.edgeVertices == 0)
        scratch.emptied.push_back(slot);
    draft.merged.clear();
    const bool hasMerged = leaves_[slot.index()].hasMerged();
    if (hasMerged)
        findLeavesAround(slot, surface, scratch);
    findSigns(slot, before, surface, scratch);
    if ((hasMerged && !mergeCells(slot, scratch)) || (merges_ && !areUnmergedWhole(scratch)) ||
        !areSignsWhole(slot, scratch)) {
        scratch.isConsistent = false;
        return;
    }
    if (isNew) {
        draft.changed.words.fill(~std::uint64_t{0});
    } else {
        std::array<BitString, 3> flipped;
        for (std::size_t a = 0; a < 3; ++a)
            for (std::size_t w = 0; w < kBitWords; ++w)
                flipped[a].words[w] = before[a].words[w] ^ after[a].words[w];
        BitString ends;
        endsOfEdges(flipped, ends);
        cellsAtPoints(ends, draft.changed);
    }
    const BrickMasks& masks = surface.masks(slot);
    draft.ownedEdges = 0;
    for (std::size_t a = 0; a < 3; ++a)
        for (std::size_t w = 0; w < kBitWords; ++w)
            draft.ownedEdges += static_cast<std::uint32_t>(std::popcount(after[a].words[w] & masks.owned[a].words[w]));
    Corners corners(hiddenCorners_, surface.brick(slot).index, pointsOf(slot, surface, scratch), scratch.error);
    surface.replace(slot, draft, corners, move.isovalue);
}

#define ISO_INSTANTIATE(Sample, Name) template class EdgeBlockSource<Sample>;
ISO_FOR_EACH_SAMPLE_TYPE(ISO_INSTANTIATE)
#undef ISO_INSTANTIATE

} // namespace isoslider::extract
