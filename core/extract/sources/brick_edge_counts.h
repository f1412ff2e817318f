#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <tbb/enumerable_thread_specific.h>

#include "core/extract/sources/block_walk.h"
#include "core/extract/sources/point_holders.h"
#include "core/extract/virtual_array.h"

namespace isoslider::extract {

/// How many active edges each brick has, from the records of an index of edges (PAPER 2): a brick arrives with its
/// first one and leaves with its last. Of an edge on faces of bricks each brick counts it that holds it. Where cells
/// were merged when the index was built, edges that carry vertices are counted, of which a brick has some wherever it
/// has active ones.
///
/// A walk adds up what its records change, from several threads; bringing the counts to where it goes is separate, so
/// that a walk may be made ahead. Two bytes a brick, and eight for each thread, of pages of memory that were touched.
template <class Key>
class BrickEdgeCounts {
public:
    /// A closed brick has no more edges.
    static constexpr int kMostEdges = 3 * 8 * 9 * 9;
    struct Change {
        BrickIndex brick;
        int edges; ///< more than before
    };

    explicit BrickEdgeCounts(const BrickGrid& grid);
    ~BrickEdgeCounts();

    std::uint32_t at(BrickIndex brick) const { return counts_[brick.index()]; }
    /// Where no edge is active.
    void clear();

    /// Begins a walk between two thresholds. One at a time.
    void beginWalk(KeyThreshold lower, KeyThreshold upper, bool goesUp);
    /// Adds records of the walk; returns the entry after the last one. Any thread.
    std::size_t add(const typename BlockWalk<Key>::Part& part);
    /// What the walk has changed, each brick once; those with as many edges as before are left out.
    std::vector<Change> changes();

    /// False where a brick would have fewer edges than none, or more than there are: then nothing is changed.
    bool apply(std::span<const Change> changes);

private:
    struct Delta {
        std::uint32_t walk;
        std::int32_t edges;
    };
    struct Deltas {
        explicit Deltas(std::size_t bricks) : byBrick(bricks) {}
        VirtualArray<Delta> byBrick; ///< of this walk, or nothing
        std::vector<BrickIndex> touched;
    };
    void addBatch(const typename BlockWalk<Key>::Part& batch, Deltas& deltas);
    void add(BrickIndex brick, int edges, Deltas& deltas);

    PointHolders holders_;
    std::uint64_t bricks_;
    VirtualArray<std::uint16_t> counts_;
    KeyThreshold lower_ = 0, upper_ = 0;
    bool goesUp_ = false;
    std::uint32_t walk_ = 0;
    tbb::enumerable_thread_specific<Deltas> deltas_;
};

} // namespace isoslider::extract
