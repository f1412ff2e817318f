#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/base/job_control.h"
#include "core/extract/inner_vertices.h"
#include "core/extract/live/brick_draft.h"
#include "core/extract/live/brick_picture.h"
#include "core/extract/live/brick_shapes.h"
#include "core/extract/live/brick_slot.h"
#include "core/extract/live/cell_triangles.h"
#include "core/extract/live/chunked_array.h"
#include "core/extract/live/kept_points.h"
#include "core/extract/live/live_brick.h"
#include "core/extract/live/retired_runs.h"
#include "core/extract/live/run_arena.h"
#include "core/extract/merged/merge_bound.h"
#include "core/extract/surface_mesh.h"

namespace isoslider::extract {

/// The live surface: closed bricks of 8^3 cells, each with all vertices of its triangles. See LIVE.md.
///
/// A brick is replaced whole, from its draft; bricks do not depend on each other. Vertices are codes (vertex_code.h)
/// that refer to the brick's points (brick_points.h), static while the isovalue crosses no sample of the brick;
/// triangles are 16-bit indices into the brick's own vertices. Welding by edge id happens at export.
///
/// Invariants, between moves: 1. the vertices of a brick are those of its active edges in ascending order, then the
/// vertices inside its cells; 2. its indices are the triangles of its active cells in cell order, those of merged cells
/// behind those of others, and so are the vertices inside them; 3. its ambiguous cells are listed in cell order, and
/// the isovalue lies in each one's interval; so are its merged cells;
/// 4. `activeEdges()` and `triangles()` are sums over the bricks, each edge counted by its owner only; 5. what a
/// picture refers to is neither changed nor used again while the picture lives.
///
/// Threads: replace(), putPoints() and refreshInnerVertices() may run for different bricks at once; everything else
/// alone.
template <class Live>
class LiveSurface {
public:
    using Record = EdgeRecord<Live>;

    using Brick = LiveBrick;

    /// `type`: of the samples that the points of bricks hold. `missingCells` must outlive the surface; sorted by brick.
    /// `keepsGroups`: what vertices are made from, in the arenas of its pictures.
    LiveSurface(const GridGeometry& geometry, ScalarType type, const std::vector<index::MissingCells>& missingCells,
                bool keepsGroups = false);

    bool keepsGroups() const { return arenas_->hasGroups; }
    /// From now on points of bricks that leave are kept, up to that many bytes of them, for when the bricks come back;
    /// what is more than that is given up. REQUIRES: bricks have all their points from the first replace() on; no move
    /// has begun.
    void keepPoints(std::uint64_t bytes);
    /// So much memory is never given back by compact(): a handle goes to and fro, and to have memory again costs as
    /// much as filling it.
    void setSlack(std::uint64_t bytes) { slackBytes_ = bytes; }
    /// The points of a brick that is to come back, if they were kept. REQUIRES: add() follows.
    std::optional<KeptPoints::Kept> takeKeptPoints(BrickIndex brick) { return kept_.take(brick); }
    void dropKeptPoints();

    /// Drops all bricks. Their memory serves the next ones; compact() gives back what those do not need.
    void clear();
    /// The same after a move that has failed, in whatever state that has left the surface; gives the memory back.
    void drop() noexcept;
    /// So many may be added before tables grow again. Throws std::bad_alloc.
    void makeRoomFor(std::size_t bricks);
    /// Starts a live brick without triangles. REQUIRES: shapes().hasCells(brick).
    BrickSlot add(BrickIndex brick, const std::optional<KeptPoints::Kept>& points = std::nullopt);
    void remove(BrickSlot slot);

    /// Starts a move: what has changed is counted from here. What only pictures that are gone refer to becomes free.
    /// Throws std::bad_alloc.
    void beginMove();
    /// Triangulates the draft and puts it in the place of what the brick was. `corners` is asked about ambiguous
    /// cells whose state is not known any more. O(active edges and cells of the brick).
    void replace(BrickSlot slot, BrickDraft<Live>& draft, const CornerScalarsOfBrick& corners, double isovalue);
    /// Puts the draft's points into the brick ahead of replace(), which then finds them there.
    void putPoints(BrickSlot slot, BrickDraft<Live>& draft);
    /// Moves the vertices inside the brick's cells to `isovalue`, which crosses nothing in the brick.
    void refreshInnerVertices(BrickSlot slot, BrickDraft<Live>& draft, const CornerScalarsOfBrick& corners,
                              double isovalue);
    /// Takes over what a thread's draft has counted since beginMove(), and takes back the runs that it has not used.
    /// The threads that have replaced bricks must have called finishStreams() since.
    void finishMove(BrickDraft<Live>& draft);
    /// After all drafts, or a clear(): gives memory back where the surface has been much smaller for some moves. Throws
    /// std::bad_alloc.
    void compact();

    const BrickShapes& shapes() const { return shapes_; }
    const BrickMasks& masks(BrickSlot slot) const {
        return bricks_[slot.index()].isNearMissing ? *nearMissing_[slot.index()]
                                                   : shapes_.masks(bricks_[slot.index()].index);
    }
    std::size_t slotCount() const { return intervals_.size(); }
    /// All, in use or not.
    IdRange<BrickSlot> slots() const { return firstIds<BrickSlot>(slotCount()); }
    const Brick& brick(BrickSlot slot) const { return bricks_[slot.index()]; }
    /// Asks for the memory that replace() will read and write, so that it comes while another brick is made. The head,
    /// which states where the rest is, must have come before.
    void prefetchHead(BrickSlot slot) const {
        __builtin_prefetch(static_cast<const LiveBrickHead*>(&bricks_[slot.index()]));
    }
    void prefetch(BrickSlot slot) const;
    /// Of the edges, then of what lies inside cells. REQUIRES for this and the next: the brick has been replaced once.
    const VertexCode* codes(BrickSlot slot) const { return arenas_->vertices.at(bricks_[slot.index()].vertices.begin); }
    const PointLine* points(BrickSlot slot) const { return arenas_->points.at(bricks_[slot.index()].points.begin); }
    bool hasBricks() const { return liveBricks_ > 0; }
    /// Isovalues between which no cell of the brick changes its state; everything for a slot without a brick.
    const cell::StateInterval& stateInterval(BrickSlot slot) const { return intervals_[slot.index()]; }
    bool hasInnerVertices(BrickSlot slot) const { return hasInner_[slot.index()] != 0; }

    std::uint64_t activeEdges() const { return activeEdges_; }
    std::uint64_t triangles() const { return triangles_; }
    std::uint64_t ambiguousCells() const { return ambiguousCells_; }
    /// Active cells, by their level.
    const LeafCounts& activeLeaves() const { return activeLeaves_; }

    /// The surface as it is now, for other threads to draw; `pointsOutChanges`: with the triangles that the last move
    /// has changed. O(live bricks + what has changed).
    std::shared_ptr<const BrickPicture<Live>> picture(bool pointsOutChanges) const;
    /// Welded by edge id, in grid order: as extractFull() gives it. Errors: Cancelled, OutOfSpace (too many vertices).
    Result<SurfaceMesh> mesh(double isovalue, const JobControl& job) const;

private:
    void triangulate(BrickSlot slot, BrickDraft<Live>& draft, const CornerScalarsOfBrick& corners, double isovalue);
    void findStates(const Brick& brick, BrickDraft<Live>& draft, const CornerScalarsOfBrick& corners,
                    double isovalue) const;
    void placeInner(const std::array<std::int32_t, 3>& origin, const PointLine* points,
                    std::span<const AmbiguousCell> ambiguous, BrickDraft<Live>& draft,
                    const CornerScalarsOfBrick& corners, double isovalue) const;
    void triangulateMerged(BrickSlot slot, BrickDraft<Live>& draft, double isovalue);
    void placeCentres(const std::array<std::int32_t, 3>& origin, const Record* records,
                      std::span<const MergedLeaf> merged, const std::uint16_t* indices, BrickDraft<Live>& draft,
                      double isovalue) const;
    void commit(BrickSlot slot, BrickDraft<Live>& draft);
    void forgetBricks() noexcept;
    void trim() noexcept;
    void moveRunsDown();
    std::uint64_t moveDown(KeptPoints::Kept& kept);
    /// What pictures may refer to.
    void leave(RetiredRuns& runs);
    void readRecords(const PointLine* points, const VertexCode* codes, std::uint32_t count,
                     BrickDraft<Live>& draft) const;
    Record recordOf(BrickSlot slot, std::uint32_t vertex) const;
    static RetiredRuns takeRuns(Brick& brick);
    void addKeptRuns(std::vector<RetiredRuns>& runs);
    void leavePoints(Brick& brick);
    void release(RetiredRuns& runs);
    void release(std::span<const RetiredRuns> runs);
    void show(BrickSlot slot);
    void listChanges(std::vector<ChangedTriangles>& triangles, std::vector<std::uint16_t>& indices) const;
    /// An active cell of a brick, merged or not, and where its triangles are among the brick's indices.
    struct SurfaceCell {
        ClosedPoint cell{};
        std::uint8_t level = 0;
        std::uint8_t innerVertices = 0;
        std::uint16_t indexCount = 0;
        std::uint32_t firstIndex = 0;
    };
    /// Calls visit(SurfaceCell) for the active cells of a brick, the merged ones last.
    template <class Visit>
    void forEachCell(BrickSlot slot, const Visit& visit) const;
    std::span<const MergedLeaf> mergedLeaves(const Brick& brick) const {
        return {brick.mergedCells > 0 ? merged_.at(brick.merged.begin) : nullptr, brick.mergedCells};
    }
    /// Adds a brick's active cells to numbers by level, times `sign`.
    template <class Counts>
    static void countLeaves(const Brick& brick, int sign, Counts& counts);
    class Welding;

    GridGeometry geometry_;
    std::uint32_t pointLines_; ///< of a brick
    std::span<const cell::CellState> states_ = cell::cellStates();
    std::span<const std::uint16_t> edgesOfInner_ = edgesOfInnerVertices();
    glm::vec3 inverseSpacing_;
    BrickShapes shapes_;
    bool hasMissing_;
    ChunkedArray<Brick, 12> bricks_; ///< by slot; in chunks below the size of large pages, which would hold few
    std::vector<std::unique_ptr<BrickMasks>> nearMissing_; ///< by slot
    std::vector<cell::StateInterval> intervals_; ///< by slot: read for every brick at every move
    std::vector<std::uint8_t> hasInner_; ///< by slot, likewise
    std::vector<BrickSlot> free_;
    std::vector<PictureBrick> shown_; ///< by slot: the table of the next picture
    std::shared_ptr<BrickArenas> arenas_;
    KeptPoints kept_;
    std::shared_ptr<BrickArenas> spare_; ///< empty; for drop(), which cannot make any
    RunArena<AmbiguousCell, 4, 16> ambiguous_;
    RunArena<MergedLeaf, 8, 16> merged_;
    RetiredList retired_;
    std::shared_ptr<PictureLeases> leases_ = std::make_shared<PictureLeases>();
    std::uint32_t version_ = 0; ///< counts moves
    static constexpr int kSparseMoves = 8;
    static constexpr std::uint64_t kVerySparse = 8; ///< one in so many is used: then at once
    std::uint64_t slackBytes_ = 0;
    std::size_t nextToMove_ = 0; ///< the first slot that moveRunsDown() has not looked at
    int sparseMoves_ = 0; ///< after which much of the arenas was free, one after the other
    bool hasCleared_ = false; ///< since compact()
    bool isWatched_ = false; ///< in this move: there are pictures, and nothing of them may be written to
    std::vector<BrickSlot> replaced_; ///< in the last move
    std::uint64_t liveBricks_ = 0;
    std::uint64_t activeEdges_ = 0;
    std::uint64_t triangles_ = 0;
    std::uint64_t ambiguousCells_ = 0;
    LeafCounts activeLeaves_{};
};

template <class Live>
template <class Visit>
void LiveSurface<Live>::forEachCell(BrickSlot slot, const Visit& visit) const {
    const Brick& brick = bricks_[slot.index()];
    const BitString above = brick.above().copy();
    const AmbiguousCell* ambiguous = brick.ambiguousCells > 0 ? ambiguous_.at(brick.ambiguous.begin) : nullptr;
    std::uint32_t first = 0;
    forEachSetBit(brick.cells(), [&](ClosedPoint cell) {
        const std::uint8_t signs = signsOfCell(above, cell);
        const cell::CellState& state =
            states_[ambiguousSignTable()[signs] ? (ambiguous++)->state : cell::StateId{signs}];
        const auto count = static_cast<std::uint16_t>(state.triangles.size());
        visit(SurfaceCell{cell, 0, state.innerVertices, count, first});
        first += count;
    });
    for (const MergedLeaf& leaf : mergedLeaves(brick)) {
        visit(SurfaceCell{leaf.cell, leaf.level, leaf.hasCentre, leaf.indexCount, first});
        first += leaf.indexCount;
    }
}

extern template class LiveSurface<float>;
extern template class LiveSurface<double>;

} // namespace isoslider::extract
