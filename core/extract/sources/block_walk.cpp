#include "core/extract/sources/block_walk.h"

#include <algorithm>
#include <atomic>
#include <mutex>
#include <optional>

#include <tbb/enumerable_thread_specific.h>

#include "core/base/job_control.h"
#include "core/base/worker_team.h"

namespace isoslider::extract {

using index::ChangePage;
using index::WalkSegment;

// One page to take from: of the file, or of a lazy level.
template <class Key>
struct BlockWalk<Key>::Task {
    const WalkSegment* segment;
    std::size_t page = 0;
    index::SkipLevel level;
    bool beginsBlock = false; // at level 0 blocks are counted by their keys
    std::shared_ptr<const index::StoredGroup> lazy = nullptr; // `page` is a page of it
    index::BlockGroup group = {};
};

template <class Key>
BlockWalk<Key>::BlockWalk(const index::IndexReader& reader, std::uint64_t cacheBytes, SumUp sumUp)
    : reader_(reader),
      skipList_(reader.meta().levels),
      cache_(reader, cacheBytes, sumUp),
      lazyLevels_(reader, cacheBytes / 4, std::move(sumUp)) {}

// A page that fails may be gone around, one that could be read after all no longer is: a disk may have been out of
// reach.
template <class Key>
Result<typename index::PageCache<Key>::Lookup> BlockWalk<Key>::getPage(const Task& task) {
    using Form = typename index::PageCache<Key>::Form;
    auto lookup = cache_.get(task.level, task.page, isTakenWhole(task) ? Form::Totals : Form::Records);
    if (lookup.isOk() && lookup.value().bytesRead == 0)
        return lookup; // of the cache
    const std::lock_guard lock(damagedMutex_);
    if (lookup.isOk())
        damaged_.erase({task.level, task.page});
    else if (lookup.error().code == ErrorCode::Corruption || lookup.error().code == ErrorCode::IoError)
        pagesLost_ += damaged_.emplace(task.level, task.page).second;
    return lookup;
}

// Pages of level 0 are in key order: one at an end of a segment is cut.
template <class Key>
bool BlockWalk<Key>::isTakenWhole(const Task& task) const {
    if (task.level > index::kLevel0)
        return true;
    const index::PageEntry& page = skipList_.page(task.level, task.page);
    return page.firstKey >= task.segment->beginKey && page.lastKey < task.segment->endKey;
}

// A group that is damaged is none: the next walk goes over its blocks.
template <class Key>
Result<typename index::PageCache<Key>::Lookup> BlockWalk<Key>::getLazyPage(const Task& task) {
    const index::StoredPage& page = task.lazy->pages[task.page];
    auto lookup = cache_.getOther(page.number, page.bytes, [&](std::vector<index::BrickTotal>& totals) {
        return lazyLevels_.load(page, totals);
    });
    if (!lookup.isOk()) {
        lazyLevels_.forget(task.group);
        const std::lock_guard lock(damagedMutex_);
        ++pagesLost_;
    }
    return lookup;
}

template <class Key>
void BlockWalk<Key>::addBlocks(const WalkSegment& segment, std::uint64_t begin, std::uint64_t end,
                               std::vector<Task>& tasks) {
    for (std::uint64_t b = begin; b < end; ++b) {
        const index::BlockEntry& block = skipList_.block(segment.level, b);
        for (std::uint64_t p = 0; p < block.pageCount; ++p)
            tasks.push_back({&segment, block.firstPage + p, segment.level, p == 0});
    }
}

// A group that is not there gives way to smaller ones that are, and to its blocks.
template <class Key>
void BlockWalk<Key>::addGroup(const WalkSegment& segment, const index::BlockGroup& group, std::vector<Task>& tasks) {
    auto stored = group.level > 0 ? lazyLevels_.find(group) : nullptr;
    if (stored && stored->isWorthwhile) {
        for (std::size_t p = 0; p < stored->pages.size(); ++p)
            tasks.push_back({&segment, p, above(segment.level, group.level), p == 0, stored, group});
    } else if (stored || group.level == 0) {
        addBlocks(segment, group.firstBlock(), group.blockEnd(), tasks);
    } else {
        addGroup(segment, {group.level - 1, 2 * group.index}, tasks);
        addGroup(segment, {group.level - 1, 2 * group.index + 1}, tasks);
    }
}

// PAPER 2.1: E+ and E- of every block on the way. DEVIATION: blocks are taken in any order and by several threads,
// because what they list are net changes between two thresholds, which do not depend on each other.
template <class Key>
std::vector<typename BlockWalk<Key>::Task> BlockWalk<Key>::makeTasks(const std::vector<WalkSegment>& segments) {
    std::vector<Task> tasks;
    std::vector<index::BlockGroup> missing;
    for (const WalkSegment& segment : segments) {
        if (segment.level == index::kLevel0) {
            for (std::size_t page = segment.firstPage; page < segment.pageEnd; ++page)
                tasks.push_back({&segment, page, segment.level});
        } else if (segment.level < skipList_.top()) {
            addBlocks(segment, segment.firstBlock, segment.firstBlock + segment.blocks, tasks);
        } else {
            for (const index::BlockGroup& group :
                 index::LazyLevels<Key>::groupsOf(segment.firstBlock, segment.firstBlock + segment.blocks)) {
                if (group.level > 0 && !lazyLevels_.find(group))
                    missing.push_back(group);
                addGroup(segment, group, tasks);
            }
        }
    }
    lazyLevels_.request(std::move(missing));
    return tasks;
}

// The records of a page that belong to the walk: all, or at level 0, which is in key order, those inside the
// segment.
template <class Key>
typename BlockWalk<Key>::Part BlockWalk<Key>::partOf(const ChangePage<Key>& page, const Task& task, WalkStep& step) {
    if (page.hasTotals || task.level > index::kLevel0) {
        step.edges += page.entries;
        step.blocks += task.level == index::kLevel0 ? page.distinctKeys : 0;
        return {page, 0, page.recordCount()};
    }
    const WalkSegment& segment = *task.segment;
    const auto low =
        std::partition_point(page.keys.begin(), page.keys.end(), [&](Key k) { return k < segment.beginKey; });
    const auto high = std::partition_point(low, page.keys.end(), [&](Key k) { return k < segment.endKey; });
    const auto begin = static_cast<std::size_t>(low - page.keys.begin()),
               end = static_cast<std::size_t>(high - page.keys.begin());
    for (std::size_t i = begin; i < end; ++i)
        step.blocks += i == begin || page.keys[i] != page.keys[i - 1];
    step.edges += page.entriesOf(begin, end);
    return {page, begin, end};
}

template <class Key>
Status BlockWalk<Key>::visit(KeyThreshold lower, KeyThreshold upper, SlideStats& stats, std::stop_token stop,
                             const Visit& visit) {
    const std::vector<WalkSegment> segments = [&] {
        const std::lock_guard lock(damagedMutex_);
        return skipList_.plan(lower, upper, damaged_);
    }();
    const std::vector<Task> tasks = makeTasks(segments);
    constexpr int kMaxLevels = index::kMaxSkipLevels + index::kMaxGroupLevel;

    tbb::enumerable_thread_specific<std::vector<WalkStep>> allSteps([] { return std::vector<WalkStep>(kMaxLevels); });
    std::atomic<std::uint64_t> bytesRead{0};
    std::mutex errorMutex;
    std::optional<Error> firstError;
    std::size_t firstErrorPage = ~std::size_t{0}; // of several the same is reported every time
    forEachIndex(tasks.size(), 1, [&](std::size_t i) {
        if (stop.stop_requested())
            return;
        const Task& task = tasks[i];
        WalkStep& step = allSteps.local()[task.level.index()];
        auto lookup = task.lazy ? getLazyPage(task) : getPage(task);
        if (!lookup.isOk()) {
            const std::lock_guard lock(errorMutex);
            if (!firstError || task.page < firstErrorPage)
                firstError = std::move(lookup).error();
            firstErrorPage = std::min(firstErrorPage, task.page);
            return;
        }
        bytesRead.fetch_add(lookup.value().bytesRead, std::memory_order_relaxed);
        step.bytes += task.lazy ? task.lazy->pages[task.page].bytes : skipList_.page(task.level, task.page).bytes;
        step.blocks += task.beginsBlock;
        visit(partOf(*lookup.value().page, task, step));
    });
    if (firstError)
        return std::move(*firstError);
    if (stop.stop_requested())
        return cancelledError();

    stats.bytesRead += bytesRead;
    std::vector<WalkStep> levels(kMaxLevels);
    for (const std::vector<WalkStep>& steps : allSteps)
        for (std::size_t l = 0; l < levels.size(); ++l) {
            levels[l].blocks += steps[l].blocks;
            levels[l].edges += steps[l].edges;
            levels[l].bytes += steps[l].bytes;
        }
    for (std::size_t l = 0; l < levels.size(); ++l) {
        levels[l].level = index::SkipLevel(l);
        stats.edgesTouched += levels[l].edges;
        if (levels[l].bytes > 0)
            stats.walk.push_back(levels[l]);
    }
    return {};
}

template class BlockWalk<std::uint16_t>;
template class BlockWalk<std::uint32_t>;
template class BlockWalk<std::uint64_t>;

} // namespace isoslider::extract
