#pragma once

#include <cstdint>
#include <functional>
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
template <class Key>
class BlockWalk {
public:
    /// `reader` must outlive the walk.
    BlockWalk(const index::IndexReader& reader, std::uint64_t cacheBytes);

    /// A run of records of one page. All lie in the interval of the walk; entries with both ends in it
    /// may be among them, since blocks are smaller than the walk.
    struct Part {
        const index::DecodedPage<Key>& page;
        std::size_t begin, end; ///< points
        std::size_t firstEntry; ///< of point `begin`, in the page's far columns
    };
    /// Returns the entry after the last one of the part.
    using Visit = std::function<std::size_t(const Part&)>;

    /// Visits every record of net changes in [lower, upper), each once, from several threads. Fills
    /// `stats` with what was read (edgesTouched, bytesRead, walk). O(log N + K). Errors: IoError, Corruption,
    /// Cancelled.
    Status visit(KeyThreshold lower, KeyThreshold upper, SlideStats& stats, std::stop_token stop, const Visit& visit);

    /// Entries that visit() would look at, about.
    std::uint64_t estimate(KeyThreshold lower, KeyThreshold upper) const {
        return skipList_.estimateEdges(lower, upper);
    }

    void dropCaches() {
        cache_.clear();
        lazyLevels_.clear();
    }

private:
    struct Task;
    /// The pages of a walk; whole runs of top-level blocks come from lazy levels where there is room.
    Result<std::vector<Task>> makeTasks(const std::vector<index::WalkSegment>& segments, SlideStats& stats);
    static Part partOf(const index::DecodedPage<Key>& page, const Task& task, WalkStep& step);

    const index::IndexReader& reader_;
    index::SkipList skipList_;
    index::PageCache<Key> cache_;
    index::LazyLevels<Key> lazyLevels_;
};

extern template class BlockWalk<std::uint16_t>;
extern template class BlockWalk<std::uint32_t>;
extern template class BlockWalk<std::uint64_t>;

} // namespace isoslider::extract
