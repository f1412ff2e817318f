#pragma once

#include <array>
#include <memory>
#include <vector>

#include <tbb/enumerable_thread_specific.h>

#include "core/extract/live/chunked_array.h"
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
/// Each live brick keeps its active edges as bits, and the surface its records. An entry goes to every brick that holds
/// the edge, at most four; there it toggles a bit and is merged into the records. Signs follow from the edges.
/// What is collected for a move is cut into partitions of brick numbers, so that threads share nothing.
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

    Status move(const Move& move, LiveSurface<Live>& surface, SlideStats& stats, std::stop_token stop) override;
    void dropCaches() override {
        walk_.dropCaches();
        hiddenCorners_.clear();
    }

private:
    using typename WalkedSource<Sample>::Part;
    using WalkedSource<Sample>::reader_;
    using WalkedSource<Sample>::walk_;
    using Record = EdgeRecord<Live>;

    static constexpr std::size_t kPartitions = 64;
    struct Deactivated {
        BrickIndex brick;
        ClosedEdge edge;
    };
    struct Activated {
        BrickIndex brick;
        Record record;
    };
    /// What one thread has collected.
    struct Lists {
        std::array<std::vector<Activated>, kPartitions> activated;
        std::array<std::vector<Deactivated>, kPartitions> deactivated;
        std::uint64_t edgesAdded = 0, edgesRemoved = 0;
        void clear();
    };
    /// The changes of one brick, as chains through the lists of its partition.
    struct Chain {
        std::uint32_t firstActivated, firstDeactivated;
    };
    struct Scratch;
    class Corners;

    void reset();
    std::size_t collect(const Part& part, KeyThreshold lower, KeyThreshold upper, bool goesUp);
    template <class Visit>
    void forEachHolder(PointId start, int axis, const Visit& visit) const;
    std::size_t partitionOf(BrickIndex brick) const {
        return static_cast<std::size_t>(brick.number() * partitionScale_ >> 32);
    }
    Status addArrivingBricks(LiveSurface<Live>& surface);
    void chainChanges(std::size_t partition, Scratch& scratch);
    void changeBrick(BrickSlot slot, const Move& move, LiveSurface<Live>& surface, Scratch& scratch);
    void listCrossedSaddles(const Move& move, const LiveSurface<Live>& surface, std::vector<BrickSlot>& crossed,
                            std::vector<BrickSlot>& refreshed) const;
    bool toggle(BrickSlot slot, const LiveSurface<Live>& surface, const Scratch& scratch);
    void mergeRecords(BrickSlot slot, const LiveSurface<Live>& surface, Scratch& scratch) const;
    bool findSigns(BrickSlot slot, const LiveSurface<Live>& surface, Scratch& scratch) const;

    GridDims cellBricks_; ///< bricks with cells along each axis
    bool allHaveCells_ = false;
    std::uint64_t partitionScale_;
    index::HiddenCorners hiddenCorners_;
    ChunkedArray<std::uint32_t, 16> slotOf_; ///< by brick; one more than the slot, 0 for none
    ChunkedArray<std::array<BitString, 3>, 8> edges_; ///< active ones, by slot
    std::vector<Chain> chains_; ///< by slot, during a move
    std::unique_ptr<tbb::enumerable_thread_specific<Lists>> lists_;
    std::unique_ptr<tbb::enumerable_thread_specific<Scratch>> scratches_;
    std::uint64_t lastCollected_ = 0;
};

} // namespace isoslider::extract
