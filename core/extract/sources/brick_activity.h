#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <tbb/enumerable_thread_specific.h>

#include "core/extract/sources/block_walk.h"
#include "core/extract/sources/point_holders.h"
#include "core/extract/virtual_array.h"

namespace isoslider::extract {

/// Which bricks are active, from the records of a skip list, as counts that they raise and lower.
///
/// Of a list of edges (PAPER 2) it is counted how many active edges each closed brick has: it arrives with its first
/// one and leaves with its last one. An edge on faces of bricks is counted by each that holds it. Where cells were
/// merged when the index was built, edges that carry vertices are counted, of which a brick has some wherever it has
/// active ones. Of a list of bricks (PAPER 3) each counts itself.
///
/// A walk adds up what its records change, from several threads; bringing the counts to where it goes is separate, so
/// that a walk may be made ahead. Two bytes a brick, and eight for each thread, of pages of memory that were touched.
template <class Key>
class BrickActivity {
public:
    enum class ListOf : std::uint8_t { Edges, Bricks };
    /// A closed brick has no more edges.
    static constexpr int kMostEdges = 3 * 8 * 9 * 9;
    struct Change {
        BrickIndex brick;
        int count; ///< more than before
    };

    BrickActivity(const BrickGrid& grid, ListOf list);
    ~BrickActivity();

    std::uint32_t count(BrickIndex brick) const { return counts_[brick.index()]; }
    /// Where nothing is active.
    void clear();

    /// Begins a walk between two thresholds. One at a time.
    void beginWalk(bool goesUp);
    /// Adds records of the walk. Any thread.
    void add(const typename BlockWalk<Key>::Part& part);
    /// What the walk has changed, each brick once; those whose counts stay are left out.
    std::vector<Change> changes();

    /// False where a brick would have a lower count than 0, or a higher one than there is: then nothing is changed.
    bool apply(std::span<const Change> changes);

private:
    struct Delta {
        std::uint32_t walk;
        std::int32_t count;
    };
    struct Deltas {
        explicit Deltas(std::size_t bricks) : byBrick(bricks) {}
        VirtualArray<Delta> byBrick; ///< of this walk, or nothing
        std::vector<BrickIndex> touched;
    };
    void addEdges(const typename BlockWalk<Key>::Part& batch, Deltas& deltas);
    void addBricks(const typename BlockWalk<Key>::Part& part, Deltas& deltas);
    void add(BrickIndex brick, int count, Deltas& deltas);

    std::optional<PointHolders> holders_; ///< with a list of edges
    std::uint64_t bricks_;
    VirtualArray<std::uint16_t> counts_;
    bool goesUp_ = false;
    std::uint32_t walk_ = 0;
    tbb::enumerable_thread_specific<Deltas> deltas_;
};

} // namespace isoslider::extract
