#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <tbb/enumerable_thread_specific.h>

#include "core/extract/sources/block_walk.h"
#include "core/extract/sources/brick_deltas.h"
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
/// that a walk may be made ahead. Memory: two bytes a brick, where one was active, and tables of those that walks
/// change.
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

    /// Begins a walk between two thresholds, one at a time; another one that has not come to its end is forgotten.
    void beginWalk(bool goesUp);
    /// Adds records of the walk, or totals. Any thread.
    void add(const typename BlockWalk<Key>::Part& part);
    /// What the records of a page add up to, in the order in which bricks come first. Any thread.
    void sumUp(const index::ChangePage<Key>& page, std::vector<index::BrickTotal>& totals);
    /// Ends the walk: what it has changed, each brick once; those whose counts stay are left out. O(bricks it touched).
    std::vector<Change> changes();

    /// False where a brick would have a lower count than 0, or a higher one than there is: then nothing is changed.
    bool apply(std::span<const Change> changes);

private:
    void endWalk();
    void addRecords(const typename BlockWalk<Key>::Part& part, BrickDeltas& deltas) const;
    void addEdges(const typename BlockWalk<Key>::Part& batch, BrickDeltas& deltas) const;

    std::optional<PointHolders> holders_; ///< with a list of edges
    VirtualArray<std::uint16_t> counts_;
    bool goesUp_ = false; ///< the walk
    BrickDeltasPool pool_;
    tbb::enumerable_thread_specific<std::unique_ptr<BrickDeltas>> walk_; ///< null until a thread has added something
};

} // namespace isoslider::extract
