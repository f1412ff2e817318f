#include "core/extract/edge_block_source.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <optional>

#include <tbb/parallel_for.h>

#include "core/base/job_control.h"

namespace isoslider::extract {

using index::DecodedPage;
using index::WalkSegment;

// One page to take from: of the file, or a merged block that is in memory already.
template <class Sample>
struct EdgeBlockSource<Sample>::Task {
    const WalkSegment* segment;
    std::size_t page = 0;
    typename index::LazyLevels<Key>::Page merged = nullptr;
    int level = 0;
    bool beginsBlock = false; // at level 0 blocks are counted by their keys
};

template <class Sample>
struct EdgeBlockSource<Sample>::Counts {
    std::vector<WalkStep> steps; // by level
};

template <class Sample>
EdgeBlockSource<Sample>::EdgeBlockSource(const index::IndexReader& reader, std::uint64_t cacheBytes)
    : reader_(reader), skipList_(reader.meta().levels), cache_(reader, cacheBytes),
      lazyLevels_(cacheBytes / 4), hiddenCorners_(reader) {}

template <class Sample>
KeyThreshold EdgeBlockSource<Sample>::highest() const {
    return KeyThreshold{keyOf(static_cast<Sample>(reader_.info().max))} + 1;
}

template <class Sample>
std::uint64_t EdgeBlockSource<Sample>::estimate(KeyThreshold from, KeyThreshold to) const {
    return skipList_.estimateEdges(std::min(from, to), std::max(from, to));
}

template <class Sample>
Result<std::vector<typename EdgeBlockSource<Sample>::Task>> EdgeBlockSource<Sample>::makeTasks(
    const std::vector<WalkSegment>& segments, SlideStats& stats) {
    using Lazy = index::LazyLevels<Key>;
    const int top = skipList_.levelCount() - 1;
    typename Lazy::Below below;
    below.pages = [&](std::uint64_t b) -> Result<std::vector<typename Lazy::Page>> {
        const index::BlockEntry& block = skipList_.block(top, b);
        std::vector<typename Lazy::Page> pages;
        for (std::uint64_t p = 0; p < block.pageCount; ++p) {
            auto lookup = cache_.get(top, block.firstPage + p);
            if (!lookup.isOk())
                return std::move(lookup).error();
            stats.bytesRead += lookup.value().bytesRead;
            pages.push_back(std::move(lookup).value().page);
        }
        return pages;
    };
    below.interval = [&](std::uint64_t begin, std::uint64_t end) {
        return std::pair{skipList_.block(top, begin).firstKey, skipList_.block(top, end - 1).lastKey + 1};
    };
    std::vector<Task> tasks;
    const auto addBlocks = [&](const WalkSegment& segment, std::uint64_t begin, std::uint64_t end) {
        for (std::uint64_t b = begin; b < end; ++b) {
            const index::BlockEntry& block = skipList_.block(segment.level, b);
            for (std::uint64_t p = 0; p < block.pageCount; ++p)
                tasks.push_back({&segment, block.firstPage + p, nullptr, segment.level, p == 0});
        }
    };
    for (const WalkSegment& segment : segments) {
        if (segment.level == 0) {
            for (std::size_t page = segment.firstPage; page < segment.pageEnd; ++page)
                tasks.push_back({&segment, page, nullptr, 0});
        } else if (segment.level < top) {
            addBlocks(segment, segment.firstBlock, segment.firstBlock + segment.blocks);
        } else {
            for (const typename Lazy::Group& group : Lazy::groupsOf(segment.firstBlock, segment.firstBlock + segment.blocks)) {
                typename Lazy::Page merged;
                if (group.level > 0) {
                    auto made = lazyLevels_.get(group, below);
                    if (!made.isOk())
                        return std::move(made).error();
                    merged = std::move(made).value();
                }
                if (merged)
                    tasks.push_back({&segment, 0, std::move(merged), top + group.level});
                else
                    addBlocks(segment, group.firstBlock(), group.blockEnd());
            }
        }
    }
    return tasks;
}

template <class Sample>
Status EdgeBlockSource<Sample>::collect(KeyThreshold from, KeyThreshold to, ChangeSet<Live>& changes, SlideStats& stats,
                                        std::stop_token stop) {
    const KeyThreshold lower = std::min(from, to);
    const KeyThreshold upper = std::max(from, to);
    std::vector<WalkSegment> segments = skipList_.plan(lower, upper);
    auto madeTasks = makeTasks(segments, stats);
    if (!madeTasks.isOk())
        return std::move(madeTasks).error();
    const std::vector<Task> tasks = std::move(madeTasks).value();
    constexpr int kMaxLevels = index::kMaxSkipLevels + index::LazyLevels<Key>::kMaxLevel;

    tbb::enumerable_thread_specific<Counts> allCounts([] { return Counts{std::vector<WalkStep>(kMaxLevels)}; });
    std::atomic<std::uint64_t> bytesRead{0};
    std::mutex errorMutex;
    std::optional<Error> firstError;
    tbb::parallel_for(std::size_t{0}, tasks.size(), [&](std::size_t i) {
        if (stop.stop_requested())
            return;
        const Task& task = tasks[i];
        Counts& counts = allCounts.local();
        WalkStep& step = counts.steps[static_cast<std::size_t>(task.level)];
        if (task.merged) {
            ++step.blocks;
            step.bytes += task.merged->memoryBytes();
            emit(*task.merged, task, lower, upper, from < to, changes, counts);
            return;
        }
        auto lookup = cache_.get(task.segment->level, task.page);
        if (!lookup.isOk()) {
            const std::lock_guard lock(errorMutex);
            firstError = std::move(lookup).error();
            return;
        }
        bytesRead.fetch_add(lookup.value().bytesRead, std::memory_order_relaxed);
        step.bytes += skipList_.page(task.level, task.page).bytes;
        step.blocks += task.beginsBlock;
        emit(*lookup.value().page, task, lower, upper, from < to, changes, counts);
    });
    if (firstError)
        return std::move(*firstError);
    if (stop.stop_requested())
        return cancelledError();

    stats.bytesRead += bytesRead;
    std::vector<WalkStep> levels(kMaxLevels);
    for (const Counts& counts : allCounts)
        for (std::size_t l = 0; l < levels.size(); ++l) {
            levels[l].blocks += counts.steps[l].blocks;
            levels[l].edges += counts.steps[l].edges;
            levels[l].bytes += counts.steps[l].bytes;
        }
    for (std::size_t l = 0; l < levels.size(); ++l) {
        levels[l].skipLevel = static_cast<int>(l);
        stats.edgesTouched += levels[l].edges;
        if (levels[l].bytes > 0)
            stats.walk.push_back(levels[l]);
    }
    return {};
}

template <class Sample>
void EdgeBlockSource<Sample>::emit(const DecodedPage<Key>& page, const Task& task, KeyThreshold lower, KeyThreshold upper,
                                   bool goesUp, ChangeSet<Live>& changes, Counts& counts) const {
    typename ChangeSet<Live>::Lists& lists = changes.local();
    const BrickGrid& grid = reader_.grid();
    std::size_t begin = 0, end = page.pointCount();
    std::size_t edge = 0;
    const WalkSegment& segment = *task.segment;
    WalkStep& step = counts.steps[static_cast<std::size_t>(task.level)];
    if (task.level == 0) { // in key order: the part inside the segment
        const auto low = std::partition_point(page.keys.begin(), page.keys.end(), [&](Key k) { return k < segment.beginKey; });
        const auto high = std::partition_point(low, page.keys.end(), [&](Key k) { return k < segment.endKey; });
        begin = static_cast<std::size_t>(low - page.keys.begin());
        end = static_cast<std::size_t>(high - page.keys.begin());
        for (std::size_t i = 0; i < begin; ++i)
            edge += static_cast<std::size_t>(std::popcount(page.masks[i]));
        for (std::size_t i = begin; i < end; ++i)
            step.blocks += i == begin || page.keys[i] != page.keys[i - 1];
    }
    const std::size_t firstEdge = edge;
    static constexpr int kLocalStride[3] = {1, 8, 64};
    for (std::size_t i = begin; i < end; ++i) {
        const PointId id = page.ids[i];
        const Key key = page.keys[i];
        const Live near = static_cast<Live>(sampleOfKey<Sample>(key));
        for (unsigned mask = page.masks[i]; mask != 0; mask &= mask - 1, ++edge) {
            const std::uint64_t farKey = page.farKeys[edge];
            if (farKey >= lower && farKey < upper)
                continue; // redundant: crossed at both ends
            const int e = std::countr_zero(mask);
            const int axis = e >> 1;
            const bool isUpward = e & 1;
            BrickIndex brick = static_cast<BrickIndex>(id / kBrickPoints);
            int local = static_cast<int>(id % kBrickPoints);
            if (!isUpward) { // the edge starts at the far end
                const bool leaves = (local / kLocalStride[axis] & 7) == 0;
                brick = static_cast<BrickIndex>(leaves ? brick - grid.brickStride(axis) : brick);
                local += (leaves ? 7 : -1) * kLocalStride[axis];
            }
            const LocalEdge localEdge = static_cast<LocalEdge>(axis * kBrickPoints + local);
            const unsigned partition = changes.partitionOf(brick);
            if ((farKey > key) != goesUp) {
                lists.deactivated[partition].push_back({brick, localEdge});
                continue;
            }
            const Live far = static_cast<Live>(sampleOfKey<Sample>(page.farKeys[edge]));
            if (isUpward)
                lists.activated[partition].push_back({near, far, brick, localEdge, page.normals[i], page.farNormals[edge]});
            else
                lists.activated[partition].push_back({far, near, brick, localEdge, page.farNormals[edge], page.normals[i]});
        }
    }
    step.edges += edge - firstEdge;
}

template class EdgeBlockSource<std::uint8_t>;
template class EdgeBlockSource<std::int8_t>;
template class EdgeBlockSource<std::uint16_t>;
template class EdgeBlockSource<std::int16_t>;
template class EdgeBlockSource<std::int32_t>;
template class EdgeBlockSource<float>;
template class EdgeBlockSource<double>;

} // namespace isoslider::extract
