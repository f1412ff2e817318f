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
EdgeBlockSource<Sample>::EdgeBlockSource(const index::IndexReader& reader, std::uint64_t cacheBytes)
    : WalkedSource<Sample>(reader,
                           hasNormalChunks(reader.info()) ? cacheBytes - cacheBytes / kNormalsShare : cacheBytes),
      merges_(reader.info().mergeError > 0.0),
      normals_(hasNormalChunks(reader.info()) ? std::make_unique<StoredNormals>(reader, cacheBytes / kNormalsShare)
                                              : nullptr),
      holders_(reader.grid()),
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
}

template <class Sample>
EdgeBlockSource<Sample>::~EdgeBlockSource() = default;

template <class Sample>
void EdgeBlockSource<Sample>::reset() {
    slotOf_.shrink(0);
    slotOf_.grow(reader_.grid().brickCount());
    edges_.shrink(0);
    leaves_.clear();
    marks_.clear();
}

// Slots for bricks that have none yet.
template <class Sample>
Status EdgeBlockSource<Sample>::addArrivingBricks(LiveSurface<Live>& surface, SlideStats& stats,
                                                  const JobControl& job) {
    forEachIndex(kPartitions, 1, [&](std::size_t partition) { countChanges(partition, surface, scratches_->local()); });
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
    marks_.resize(surface.slotCount());
    leaves_.resize(surface.slotCount());
    for (const Scratch& scratch : *scratches_)
        if (!scratch.isConsistent)
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

// Bricks in which a cell changes though none of its edges does, and those whose vertices inside cells move.
template <class Sample>
void EdgeBlockSource<Sample>::listCrossedSaddles(const Move& move, const LiveSurface<Live>& surface,
                                                 std::vector<BrickSlot>& crossed,
                                                 std::vector<BrickSlot>& refreshed) const {
    for (const BrickSlot slot : firstIds<BrickSlot>(marks_.size())) {
        if (marks_[slot.index()] != Mark::None)
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
    if (lastCollected_ > 4 * this->estimate(move.from, move.to) + kKeptEntries) {
        lists_->clear();
        scratches_->clear();
    }
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
                marks_[slot.index()] = Mark::None;
    }

    const JobControl making = job.part(normals_ ? 0.5 : 0.0, 1.0);
    SharedProgress progress(making, kPartitions, "extracting");
    forEachIndex(kPartitions, 1, [&](std::size_t partition) {
        Scratch& scratch = scratches_->local();
        sortChanges(partition, scratch);
        const std::vector<TouchedBrick>& touched = touched_[partition];
        std::size_t points = 0, edges = 0;
        for (std::size_t i = 0; i < touched.size(); ++i) {
            if (stop.stop_requested())
                return;
            constexpr std::size_t kAhead = 2;
            if (i + 2 * kAhead < touched.size())
                surface.prefetchHead(slotOf(touched[i + 2 * kAhead]));
            if (i + kAhead < touched.size())
                prefetchBrick(slotOf(touched[i + kAhead]), surface);
            changeBrick(slotOf(touched[i]), scratch.changesOf(touched[i], points, edges), move, surface, scratch);
            points += touched[i].points;
            edges += touched[i].edges;
        }
        finishStreams();
        progress.add(1);
    });
    if (stop.stop_requested())
        return cancelledError();
    // Which bricks have been made must be known before the others are looked through.
    std::vector<BrickSlot> crossed, refreshed;
    const auto markTouched = [&](Mark mark) {
        for (const std::vector<TouchedBrick>& touched : touched_)
            for (const TouchedBrick& brick : touched)
                marks_[slotOf(brick).index()] = mark;
    };
    markTouched(Mark::Made);
    for (const BrickSlot slot : beside)
        if (marks_[slot.index()] == Mark::None)
            crossed.push_back(slot);
    for (const BrickSlot slot : crossed)
        marks_[slot.index()] = Mark::Made;
    listCrossedSaddles(move, surface, crossed, refreshed);
    markTouched(Mark::None);
    for (const BrickSlot slot : crossed)
        marks_[slot.index()] = Mark::None;
    forEachIndex(crossed.size(), kBricksTogether, [&](std::size_t i) {
        if (!stop.stop_requested())
            changeBrick(crossed[i], {}, move, surface, scratches_->local());
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

// Where the points of the brick are: those that it will have from now on.
template <class Sample>
auto EdgeBlockSource<Sample>::pointsOf(BrickSlot slot, const LiveSurface<Live>& surface, const Scratch& scratch)
    -> const Points& {
    return scratch.draft.newPoints ? scratch.points : pointsIn<Sample>(surface.points(slot));
}

// The vertices of edges that stay and of those that came, with the levels of their leaf edges.
template <class Sample>
void EdgeBlockSource<Sample>::numberVertices(BrickSlot slot, const Changes& changes, const LiveSurface<Live>& surface,
                                             Scratch& scratch) const {
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
    for (std::size_t a = 0; a < 3; ++a) // of points: they have none
        forEachSetBit(scratch.toggled.activated[a],
                      [&](ClosedPoint start) { setLevel(closedEdge(static_cast<int>(a), start), 0); });
    for (const ChangedEdge& change : changes.edges)
        if (change.isActivated)
            setLevel(change.edge, change.level);
}

template <class Sample>
void EdgeBlockSource<Sample>::changeBrick(BrickSlot slot, const Changes& changes, const Move& move,
                                          LiveSurface<Live>& surface, Scratch& scratch) {
    BrickDraft<Live>& draft = scratch.draft;
    const BrickMasks& masks = surface.masks(slot);
    const bool isNew = surface.brick(slot).edgeVertices == 0;
    findToggled(changes, masks, move.from < move.to, scratch);
    ChangedBrick& changed = scratch.changed;
    changeEdges(scratch.toggled, masks, surface.brick(slot).above, edges_[slot.index()], changed);
    if (!changed.isConsistent) {
        scratch.isConsistent = false;
        return;
    }
    fillPoints(slot, changes, surface, scratch);
    numberVertices(slot, changes, surface, scratch);
    if (draft.edgeVertices == 0)
        scratch.emptied.push_back(slot);
    draft.merged.clear();
    if (merges_)
        findMergedSigns(slot, surface, scratch);
    draft.active.cells = changed.signs.cells;
    draft.above = changed.signs.above;
    if (merges_)
        changed.isOfSigns = mergeCells(slot, scratch);
    if (!changed.isOfSigns) {
        scratch.isConsistent = false;
        return;
    }
    if (isNew)
        draft.changed.words.fill(~std::uint64_t{0});
    else
        draft.changed = changed.changed;
    draft.ownedEdges = changed.ownedEdges;
    Corners corners(hiddenCorners_, surface.brick(slot).index, pointsOf(slot, surface, scratch), scratch.error);
    surface.replace(slot, draft, corners, move.isovalue);
}

#define ISO_INSTANTIATE(Sample, Name) template class EdgeBlockSource<Sample>;
ISO_FOR_EACH_SAMPLE_TYPE(ISO_INSTANTIATE)
#undef ISO_INSTANTIATE

} // namespace isoslider::extract
