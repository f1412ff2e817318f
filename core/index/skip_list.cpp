#include "core/index/skip_list.h"

#include <algorithm>

namespace isoslider::index {

std::vector<WalkSegment> SkipList::plan(KeyThreshold lower, KeyThreshold upper) const {
    std::vector<WalkSegment> segments;
    if (lower < upper)
        cover(top(), lower, upper, segments);
    return segments;
}

// PAPER 2.1: step up at every opportunity, walk as far as possible at the higher level, step down where its next block
// would pass the end. Here from the top: the run of whole blocks that lie in the interval, then the levels below for
// what is left on both sides. O(levels) runs.
void SkipList::cover(SkipLevel level, std::uint64_t begin, std::uint64_t end, std::vector<WalkSegment>& out) const {
    if (begin >= end)
        return;
    const LevelDirectory& directory = levels_[level.index()];
    if (level == kLevel0) {
        const auto first = std::partition_point(directory.pages.begin(), directory.pages.end(),
                                                [&](const PageEntry& p) { return p.lastKey < begin; });
        const auto last =
            std::partition_point(first, directory.pages.end(), [&](const PageEntry& p) { return p.firstKey < end; });
        if (first != last)
            out.push_back({level, begin, end, static_cast<std::size_t>(first - directory.pages.begin()),
                           static_cast<std::size_t>(last - directory.pages.begin()), 0, 0});
        return;
    }
    const auto& blocks = directory.blocks;
    const auto first =
        std::partition_point(blocks.begin(), blocks.end(), [&](const BlockEntry& b) { return b.firstKey < begin; });
    const auto last = std::partition_point(first, blocks.end(), [&](const BlockEntry& b) { return b.lastKey < end; });
    if (first == last) {
        cover(below(level), begin, end, out);
        return;
    }
    const BlockEntry& back = *(last - 1);
    const std::uint64_t coveredEnd = back.lastKey + 1;
    cover(below(level), begin, first->firstKey, out);
    out.push_back({level, first->firstKey, coveredEnd, first->firstPage, back.firstPage + back.pageCount,
                   static_cast<std::uint64_t>(first - blocks.begin()), static_cast<std::uint64_t>(last - first)});
    cover(below(level), coveredEnd, end, out);
}

// Beyond what any volume has, and a number of 64 bits.
constexpr double kMostEstimated = 1e18;

std::uint64_t SkipList::estimateEdges(KeyThreshold lower, KeyThreshold upper) const {
    double edges = 0.0;
    for (const WalkSegment& segment : plan(lower, upper))
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
