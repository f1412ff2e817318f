#include "core/index/skip_list.h"

#include <algorithm>

namespace isoslider::index {

namespace {

using BlockIterator = std::vector<BlockEntry>::const_iterator;

// The first of the blocks [begin, end) that has a damaged page; `end` if none has.
BlockIterator firstDamaged(SkipLevel level, BlockIterator begin, BlockIterator end, const DamagedPages& damaged) {
    if (damaged.empty() || begin == end)
        return end;
    const auto page = damaged.lower_bound({level, static_cast<std::size_t>(begin->firstPage)});
    if (page == damaged.end() || page->first != level)
        return end;
    return std::partition_point(begin, end,
                                [&](const BlockEntry& b) { return b.firstPage + b.pageCount <= page->second; });
}

} // namespace

std::vector<WalkSegment> SkipList::plan(KeyThreshold lower, KeyThreshold upper, const DamagedPages& damaged) const {
    Plan plan{damaged, {}};
    if (lower < upper)
        cover(top(), lower, upper, plan);
    return std::move(plan.segments);
}

// PAPER 2.1: step up at every opportunity, walk as far as possible at the higher level, step down where its next block
// would pass the end. Here from the top: the runs of whole blocks that lie in the interval, then the levels below for
// what is left beside and between them. O(levels) runs where nothing is damaged.
void SkipList::cover(SkipLevel level, std::uint64_t begin, std::uint64_t end, Plan& plan) const {
    if (begin >= end)
        return;
    const LevelDirectory& directory = levels_[level.index()];
    if (level == kLevel0) {
        const auto first = std::partition_point(directory.pages.begin(), directory.pages.end(),
                                                [&](const PageEntry& p) { return p.lastKey < begin; });
        const auto last =
            std::partition_point(first, directory.pages.end(), [&](const PageEntry& p) { return p.firstKey < end; });
        if (first != last)
            plan.segments.push_back({level, begin, end, static_cast<std::size_t>(first - directory.pages.begin()),
                                     static_cast<std::size_t>(last - directory.pages.begin()), 0, 0});
        return;
    }
    const auto& blocks = directory.blocks;
    const auto last =
        std::partition_point(blocks.begin(), blocks.end(), [&](const BlockEntry& b) { return b.lastKey < end; });
    for (auto first =
             std::partition_point(blocks.begin(), last, [&](const BlockEntry& b) { return b.firstKey < begin; });
         first != last;) {
        const auto runEnd = firstDamaged(level, first, last, plan.damaged);
        if (runEnd != first) {
            const BlockEntry& back = *(runEnd - 1);
            cover(below(level), begin, first->firstKey, plan);
            plan.segments.push_back(
                {level, first->firstKey, back.lastKey + 1, first->firstPage, back.firstPage + back.pageCount,
                 static_cast<std::uint64_t>(first - blocks.begin()), static_cast<std::uint64_t>(runEnd - first)});
            begin = back.lastKey + 1;
        }
        first = runEnd == last ? last : runEnd + 1;
    }
    cover(below(level), begin, end, plan);
}

bool SkipList::isBlocked(KeyThreshold lower, KeyThreshold upper, const DamagedPages& damaged) const {
    if (damaged.empty() || damaged.begin()->first != kLevel0)
        return false;
    const std::vector<WalkSegment> segments = plan(lower, upper, damaged);
    return std::any_of(segments.begin(), segments.end(), [&](const WalkSegment& segment) {
        if (segment.level != kLevel0)
            return false;
        const auto page = damaged.lower_bound({kLevel0, segment.firstPage});
        return page != damaged.end() && page->first == kLevel0 && page->second < segment.pageEnd;
    });
}

// Beyond what any volume has, and a number of 64 bits.
constexpr double kMostEstimated = 1e18;

std::uint64_t SkipList::estimateEdges(KeyThreshold lower, KeyThreshold upper, const DamagedPages& damaged) const {
    double edges = 0.0;
    for (const WalkSegment& segment : plan(lower, upper, damaged))
        for (std::size_t i = segment.firstPage; i < segment.pageEnd; ++i) {
            const PageEntry& p = page(segment.level, i);
            const std::uint64_t from = std::max(p.firstKey, segment.beginKey);
            const std::uint64_t to = std::min(p.lastKey, segment.endKey - 1);
            const double share = p.firstKey == p.lastKey ? 1.0
                                                         : (static_cast<double>(to - from) + 1.0) /
                                                               (static_cast<double>(p.lastKey - p.firstKey) + 1.0);
            edges += std::min(share, 1.0) * p.edges; // pages of a forged directory need not overlap their segment
        }
    return static_cast<std::uint64_t>(std::min(edges, kMostEstimated));
}

} // namespace isoslider::index
