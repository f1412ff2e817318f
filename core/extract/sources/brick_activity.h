#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
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
/// that a walk may be made ahead. Two bytes a brick, and sixteen for each thread, of pages of memory that were touched.
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
    /// Adds records of the walk, or totals. Any thread.
    void add(const typename BlockWalk<Key>::Part& part);
    /// What the records of a page add up to, in the order in which bricks come first. Any thread.
    void sumUp(const index::ChangePage<Key>& page, std::vector<typename index::ChangePage<Key>::Total>& totals);
    /// What the walk has changed, each brick once; those whose counts stay are left out.
    std::vector<Change> changes();

    /// False where a brick would have a lower count than 0, or a higher one than there is: then nothing is changed.
    bool apply(std::span<const Change> changes);

private:
    /// Changes by brick, of which one thread makes many: no memory is cleared in between.
    class Deltas {
    public:
        explicit Deltas(std::size_t bricks) : byBrick_(bricks) {}
        void begin();
        void add(BrickIndex brick, int count) {
            Delta& delta = byBrick_[brick.index()];
            if (delta.number != number_) {
                delta = {number_, 0};
                touched_.push_back(brick);
            }
            delta.count += count;
        }
        const std::vector<BrickIndex>& touched() const { return touched_; }
        /// And it is 0 from then on.
        int take(BrickIndex brick) {
            Delta& delta = byBrick_[brick.index()];
            return delta.number == number_ ? std::exchange(delta.count, 0) : 0;
        }

    private:
        struct Delta {
            std::uint32_t number; ///< of those that it is of
            std::int32_t count;
        };
        VirtualArray<Delta> byBrick_;
        std::vector<BrickIndex> touched_;
        std::uint32_t number_ = 1;
    };
    void addRecords(const typename BlockWalk<Key>::Part& part, Deltas& deltas) const;
    void addEdges(const typename BlockWalk<Key>::Part& batch, Deltas& deltas) const;

    std::optional<PointHolders> holders_; ///< with a list of edges
    std::uint64_t bricks_;
    VirtualArray<std::uint16_t> counts_;
    bool goesUp_ = false;
    tbb::enumerable_thread_specific<Deltas> deltas_; ///< of the walk
    tbb::enumerable_thread_specific<Deltas> sums_; ///< of a page
};

} // namespace isoslider::extract
