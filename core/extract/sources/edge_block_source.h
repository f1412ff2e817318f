#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include <tbb/enumerable_thread_specific.h>

#include "core/extract/live/brick_points.h"
#include "core/extract/live/chunked_array.h"
#include "core/extract/sources/crossed_points.h"
#include "core/extract/sources/edge_kernels.h"
#include "core/extract/sources/stored_normals.h"
#include "core/extract/sources/walked_source.h"
#include "core/index/hidden_corners.h"
#include "core/index/index_reader.h"

namespace isoslider::extract {

/// Changes of the live surface from an index of edge blocks (the paper's skip list).
///
/// A move from threshold a to b crosses the points with keys in [a, b) (b < a: [b, a)). Of a crossed point's edges
/// those whose far end is crossed too are redundant for the whole move, and each record carries the far end's
/// scalar: so net changes need no bookkeeping between blocks, levels or threads.
///
/// Each live brick keeps its active edges as bits, and the surface its points. A record goes, as it is, to every closed
/// brick that holds the point, mostly one and at most eight; there its edges become bits, which toggle those that are
/// kept, and the scalars at their ends are filled in. A brick that arrives has the normals of all its points read,
/// which the index keeps by place (in earlier versions entries bring them). Signs follow from the edges. What is
/// collected for a move is cut into partitions of brick numbers, so that threads share nothing, and brought into the
/// order of the bricks.
///
/// Where cells were merged when the index was built (PAPER 2.2), it states of each edge when it carries a vertex, and
/// on a leaf edge of which level; and of each merged cell when it is a leaf. Those come and go like edges. A brick with
/// leaves is made in a second step, once those of the bricks beside it are known.
template <class Sample>
class EdgeBlockSource final : public WalkedSource<Sample> {
public:
    using typename WalkedSource<Sample>::Key;
    using typename WalkedSource<Sample>::Live;
    using typename ChangeSource<Live>::Move;
    using WalkedSource<Sample>::lowest;
    using WalkedSource<Sample>::highest;

    /// `reader` must outlive the source.
    EdgeBlockSource(const index::IndexReader& reader, std::uint64_t cacheBytes);
    ~EdgeBlockSource() override;

    Status move(const Move& move, LiveSurface<Live>& surface, SlideStats& stats, const JobControl& job) override;
    void dropCaches() override {
        walk_.dropCaches();
        hiddenCorners_.clear();
        if (normals_)
            normals_->dropCaches();
    }

private:
    using typename WalkedSource<Sample>::Part;
    using WalkedSource<Sample>::reader_;
    using WalkedSource<Sample>::walk_;
    using Stored = StoredSample<Sample>;
    using Points = BrickPoints<Sample>;

    static constexpr std::size_t kPartitions = 64;
    /// An edge that becomes active or inactive by itself: where cells are merged. Activated with scalars, and normals
    /// where pages have them, at the ends of the leaf edge of `level` that contains it.
    struct ChangedEdge {
        BrickIndex brick;
        ClosedEdge edge;
        std::uint8_t level;
        bool isActivated;
        NormalCode normal1, normal2;
        Stored scalar1, scalar2;
    };
    /// A merged cell that becomes a leaf the surface passes through, or is none any more.
    struct ChangedLeaf {
        BrickIndex brick;
        std::uint8_t level;
        std::uint8_t number; ///< as leafBits() has it
        bool isActivated;
    };
    static constexpr std::size_t kBatch = 512; ///< records
    /// A record of a page, its first entry, and the edges of its point that change.
    struct Changed {
        std::size_t record, entry;
        std::uint8_t activated, deactivated;
    };
    /// What one thread has collected, by partition.
    struct Lists {
        std::array<std::vector<CrossedPoint<Key>>, kPartitions> points;
        std::array<std::vector<CrossedNormals>, kPartitions> normals; ///< of the points; empty where entries have none
        std::array<std::vector<ChangedEdge>, kPartitions> edges;
        std::array<std::vector<ChangedLeaf>, kPartitions> leaves;
        std::uint64_t edgesAdded = 0, edgesRemoved = 0;
        void clear();
    };
    /// A brick of which something was collected.
    struct TouchedBrick {
        BrickIndex brick;
        std::uint32_t points, edges; ///< how many
        bool hasActivated; ///< edges, and with them scalars
        bool isTouched; ///< by that, or by leaves
    };
    /// What was collected of one brick.
    struct Changes {
        std::span<const CrossedPoint<Key>> points;
        std::span<const CrossedNormals> normals; ///< of the points, or none
        std::span<const ChangedEdge> edges;
        bool hasActivated = false;
    };
    /// By slot, during a move.
    enum class Mark : std::uint8_t { None, LeavesChanged, Made };
    struct Scratch;
    class Corners;

    void reset();
    std::size_t collect(const Part& part, KeyThreshold lower, KeyThreshold upper, bool goesUp);
    std::size_t collectBatch(const Part& batch, KeyThreshold lower, KeyThreshold upper, bool goesUp, Lists& lists);
    void addCrossed(const index::DecodedPage<Key>& page, const Changed& changed, const CrossedEdges& edges,
                    Lists& lists) const;
    void collectMerged(const Part& part, std::size_t record, std::size_t entry, bool goesUp, Lists& lists);
    template <class Visit>
    void forEachHolder(PointId start, int axis, const Visit& visit) const;
    BrickSlot slotOf(const TouchedBrick& touched) const { return BrickSlot(slotOf_[touched.brick.index()] - 1); }
    std::size_t partitionOf(BrickIndex brick) const {
        return static_cast<std::size_t>(brick.number() * partitionScale_ >> 32);
    }
    BrickIndex firstBrickOf(std::size_t partition) const {
        return BrickIndex(((std::uint64_t{partition} << 32) + partitionScale_ - 1) / partitionScale_);
    }
    void countChanges(std::size_t partition, const LiveSurface<Live>& surface, Scratch& scratch);
    Status addArrivingBricks(LiveSurface<Live>& surface, SlideStats& stats, const JobControl& job);
    Status startPoints(LiveSurface<Live>& surface, std::vector<BrickIndex> bricks, SlideStats& stats,
                       const JobControl& job);
    void sortChanges(std::size_t partition, Scratch& scratch);
    void changeBrick(BrickSlot slot, const Changes& changes, const Move& move, LiveSurface<Live>& surface,
                     Scratch& scratch);
    void prefetchBrick(BrickSlot slot, const LiveSurface<Live>& surface) const;
    void listCrossedSaddles(const Move& move, const LiveSurface<Live>& surface, std::vector<BrickSlot>& crossed,
                            std::vector<BrickSlot>& refreshed) const;
    void findToggled(const Changes& changes, const BrickMasks& masks, bool goesUp, Scratch& scratch) const;
    template <class Visit>
    static void forEachEnd(std::span<const CrossedPoint<Key>> points, const Visit& visit);
    static bool hasAllEnds(const Points& points, std::span<const CrossedPoint<Key>> crossed);
    void fillPoints(BrickSlot slot, const Changes& changes, const LiveSurface<Live>& surface, Scratch& scratch) const;
    void numberVertices(BrickSlot slot, const Changes& changes, const LiveSurface<Live>& surface,
                        Scratch& scratch) const;
    static const Points& pointsOf(BrickSlot slot, const LiveSurface<Live>& surface, const Scratch& scratch);
    void findMergedSigns(BrickSlot slot, const LiveSurface<Live>& surface, Scratch& scratch) const;
    static void seedFromVertices(const Stored* samples, const BrickDraft<Live>& draft, BitString& above);
    void changeLeaves(std::size_t partition, Scratch& scratch);
    void listBesideLeaves(const LiveSurface<Live>& surface, std::vector<BrickSlot>& beside) const;
    void findLeafEdges(BrickSlot slot, const Scratch& scratch, std::array<BitString, 3>& edges) const;
    void findLeavesAround(BrickSlot slot, const LiveSurface<Live>& surface, Scratch& scratch) const;
    bool mergeCells(BrickSlot slot, Scratch& scratch) const;
    bool areUnmergedWhole(const Scratch& scratch) const;

    static constexpr std::uint64_t kNormalsShare = 4; ///< of the cache, where normals are stored by place
    bool merges_; ///< the index has merged cells
    std::unique_ptr<StoredNormals> normals_; ///< null: entries bring them
    GridDims cellBricks_; ///< bricks with cells along each axis
    PointHolders holders_;
    std::uint64_t partitionScale_;
    index::HiddenCorners hiddenCorners_;
    ChunkedArray<std::uint32_t, 16> slotOf_; ///< by brick; one more than the slot, 0 for none
    ChunkedArray<std::array<BitString, 3>, 8> edges_; ///< active ones, by slot
    std::vector<BrickLeaves> leaves_; ///< by slot: those that the surface passes through, with their halves
    std::vector<Mark> marks_; ///< by slot, during a move
    std::array<std::vector<TouchedBrick>, kPartitions> touched_; ///< during a move
    std::unique_ptr<tbb::enumerable_thread_specific<Lists>> lists_;
    std::unique_ptr<tbb::enumerable_thread_specific<Scratch>> scratches_;
    std::uint64_t lastCollected_ = 0;
};

} // namespace isoslider::extract
