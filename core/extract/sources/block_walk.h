#pragma once

#include <cstdint>
#include <functional>
#include <mutex>
#include <stop_token>
#include <vector>

#include "core/base/result.h"
#include "core/extract/surface_frame.h"
#include "core/index/index_reader.h"
#include "core/index/lazy_levels.h"
#include "core/index/page_cache.h"
#include "core/index/skip_list.h"

namespace isoslider::extract {

/// The walk along an index's skip list from one threshold to another, with its caches: for all that
/// becomes active and inactive at values. What the records stand for, grid edges or bricks, is the
/// visitor's business.
///
/// Pages that cannot be read are remembered: later walks take the levels below in place of their blocks, which cost
/// more and give the same. Below level 0 there is nothing, so its pages are tried again by every walk that needs them.
/// Any thread.
template <class Key>
class BlockWalk {
public:
    using SumUp = typename index::PageCache<Key>::SumUp;

    /// `reader` must outlive the walk. `sumUp`: pages that are taken whole have totals in place of records; without it
    /// there are records only, and no lazy levels.
    BlockWalk(const index::IndexReader& reader, std::uint64_t cacheBytes, SumUp sumUp = {});

    /// A run of records of one page, or, where it has totals, the whole of it. All records lie in the interval of the
    /// walk; entries with both ends in it may be among them, since blocks are smaller than the walk.
    struct Part {
        const index::ChangePage<Key>& page;
        std::size_t begin, end; ///< records
    };
    using Visit = std::function<void(const Part&)>;

    /// Visits every record of net changes in [lower, upper), each once, from several threads. Fills
    /// `stats` with what was read (edgesTouched, bytesRead, walk). O(log N + K). Errors: IoError, Corruption,
    /// Cancelled. After the first two another walk may succeed where pagesLost() has risen.
    Status visit(KeyThreshold lower, KeyThreshold upper, SlideStats& stats, std::stop_token stop, const Visit& visit);

    /// Entries that visit() would look at, about.
    std::uint64_t estimate(KeyThreshold lower, KeyThreshold upper) const {
        const std::lock_guard lock(damagedMutex_);
        return skipList_.estimateEdges(lower, upper, damaged_);
    }
    /// Whether a page that is known to be damaged lies on the way, so that visit() fails unless it has been repaired.
    bool isBlocked(KeyThreshold lower, KeyThreshold upper) const {
        const std::lock_guard lock(damagedMutex_);
        return skipList_.isBlocked(lower, upper, damaged_);
    }
    /// How many times a page was found to be damaged; never falls.
    std::uint64_t pagesLost() const {
        const std::lock_guard lock(damagedMutex_);
        return pagesLost_;
    }

    /// Of what is kept of the list.
    std::uint64_t memoryBytes() const { return cache_.memoryBytes() + lazyLevels_.memoryBytes(); }
    /// And of damaged pages.
    void dropCaches() {
        lazyLevels_.wait();
        lazyLevels_.clear();
        cache_.clear();
        const std::lock_guard lock(damagedMutex_);
        damaged_.clear();
    }

    /// Whether lazy levels are built: otherwise those that are there are used, no others.
    void setBuildsLevels(bool builds) {
        if (!builds)
            lazyLevels_.stopBuilding();
    }
    /// Waits until those are built that walks have asked for.
    void waitForLevels() { lazyLevels_.wait(); }

private:
    struct Task;
    /// The pages of a walk; whole runs of top-level blocks come from lazy levels where those are there.
    std::vector<Task> makeTasks(const std::vector<index::WalkSegment>& segments);
    void addGroup(const index::WalkSegment& segment, const index::BlockGroup& group, std::vector<Task>& tasks);
    void addBlocks(const index::WalkSegment& segment, std::uint64_t begin, std::uint64_t end, std::vector<Task>& tasks);
    /// As PageCache::get; remembers which pages cannot be read.
    Result<typename index::PageCache<Key>::Lookup> getPage(const Task& task);
    bool isTakenWhole(const Task& task) const;
    Result<typename index::PageCache<Key>::Lookup> getLazyPage(const Task& task);
    static Part partOf(const index::ChangePage<Key>& page, const Task& task, WalkStep& step);

    const index::IndexReader& reader_;
    index::SkipList skipList_;
    index::PageCache<Key> cache_;
    mutable std::mutex damagedMutex_;
    index::DamagedPages damaged_;
    std::uint64_t pagesLost_ = 0;
    index::LazyLevels<Key> lazyLevels_;
};

extern template class BlockWalk<std::uint16_t>;
extern template class BlockWalk<std::uint32_t>;
extern template class BlockWalk<std::uint64_t>;

} // namespace isoslider::extract
