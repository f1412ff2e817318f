#include "preprocess/levels/block_intervals.h"

#include <algorithm>

#include "core/base/check.h"

namespace isoslider::preprocess {

KeyIntervals makeSpanBins(const std::vector<KeyCount>& counts) {
    std::uint64_t total = 0;
    for (const KeyCount& count : counts)
        total += count.points;
    const std::uint64_t target = counts.size() <= kMaxSpanBins ? 1 : total / kMaxSpanBins + 1;
    std::vector<std::uint64_t> begins{0};
    std::uint64_t inBin = 0;
    for (const KeyCount& count : counts) {
        if (inBin >= target) {
            begins.push_back(count.key);
            inBin = 0;
        }
        inBin += count.points;
    }
    ISO_CHECK(begins.size() <= kMaxSpanBins);
    return KeyIntervals(std::move(begins));
}

void SpanHistogram::merge(const SpanHistogram& other) {
    ISO_CHECK(bins_ == other.bins_);
    for (std::size_t i = 0; i < counts_.size(); ++i)
        counts_[i] += other.counts_[i];
}

namespace {

// Edges with both ends in bins [begin, end), and edges active at a bin's lower end, in O(1).
class SpanSums {
public:
    explicit SpanSums(const SpanHistogram& histogram)
        : side_(histogram.bins() + 1), sums_(side_ * side_, 0), active_(histogram.bins() + 1, 0) {
        for (std::size_t lower = 0; lower < histogram.bins(); ++lower)
            for (std::size_t upper = 0; upper < histogram.bins(); ++upper)
                sums_[(lower + 1) * side_ + upper + 1] = histogram.at(lower, upper) + sums_[lower * side_ + upper + 1] +
                                                         sums_[(lower + 1) * side_ + upper] -
                                                         sums_[lower * side_ + upper];
        const std::size_t bins = histogram.bins();
        for (std::size_t at = 0; at <= bins; ++at) // lower end below `at`, upper end not
            active_[at] = rectangle(0, at, at, bins);
    }

    std::uint64_t inside(std::size_t begin, std::size_t end) const { return rectangle(begin, end, begin, end); }
    std::uint64_t activeAt(std::size_t bin) const { return active_[bin]; }

private:
    std::uint64_t rectangle(std::size_t lower0, std::size_t lower1, std::size_t upper0, std::size_t upper1) const {
        return sums_[lower1 * side_ + upper1] + sums_[lower0 * side_ + upper0] - sums_[lower0 * side_ + upper1] -
               sums_[lower1 * side_ + upper0];
    }

    std::size_t side_;
    std::vector<std::uint64_t> sums_;
    std::vector<std::uint64_t> active_;
};

// PAPER 2.1: blocks of the level below are consolidated until the redundant edges exceed the threshold times the active
// edges; each block has at least two below, so that there are O(log N) levels.
// One level's block begins (bin numbers, closed by the bin count) from those of the level below.
std::vector<std::size_t> consolidate(const std::vector<std::size_t>& below, bool belowIsLevel0, const SpanSums& sums,
                                     double redundancyThreshold) {
    std::vector<std::size_t> begins;
    const std::size_t blocks = below.size() - 1;
    std::size_t first = 0;
    while (first < blocks) {
        begins.push_back(below[first]);
        std::uint64_t removedBelow = 0;
        std::size_t last = first;
        while (last < blocks) {
            if (!belowIsLevel0)
                removedBelow += sums.inside(below[last], below[last + 1]);
            ++last;
            const std::uint64_t redundant = sums.inside(below[first], below[last]) - removedBelow;
            const double limit = redundancyThreshold * static_cast<double>(sums.activeAt(below[last]));
            if (last - first >= 2 && static_cast<double>(redundant) > limit)
                break;
        }
        first = last;
    }
    // A last block of one sub-block states nothing new: it joins its neighbour.
    if (begins.size() >= 2 && begins.back() == below[blocks - 1])
        begins.pop_back();
    begins.push_back(below.back());
    return begins;
}

} // namespace

std::vector<std::vector<std::uint64_t>> chooseBlockBegins(const SpanHistogram& histogram, const KeyIntervals& bins,
                                                          int skipLevels, double redundancyThreshold) {
    const SpanSums sums(histogram);
    std::vector<std::size_t> below;
    for (std::size_t bin = 0; bin <= bins.count(); ++bin)
        below.push_back(bin);
    std::vector<std::vector<std::uint64_t>> levels;
    for (int level = 1; level < skipLevels && below.size() > 2; ++level) {
        below = consolidate(below, level == 1, sums, redundancyThreshold);
        if (below.size() <= 2)
            break; // one block over everything holds no edge
        std::vector<std::uint64_t> beginKeys;
        for (std::size_t i = 0; i + 1 < below.size(); ++i)
            beginKeys.push_back(bins.begin(below[i]));
        levels.push_back(std::move(beginKeys));
    }
    return levels;
}

std::uint64_t countEntriesAbove(const SpanHistogram& histogram, const KeyIntervals& bins,
                                const std::vector<std::vector<std::uint64_t>>& blockBegins) {
    std::uint64_t entries = 0;
    std::vector<std::size_t> blockOfBin(bins.count());
    for (const std::vector<std::uint64_t>& begins : blockBegins) {
        for (std::size_t bin = 0; bin < bins.count(); ++bin)
            blockOfBin[bin] = static_cast<std::size_t>(std::upper_bound(begins.begin(), begins.end(), bins.begin(bin)) -
                                                       begins.begin());
        for (std::size_t lower = 0; lower < bins.count(); ++lower)
            for (std::size_t upper = lower; upper < bins.count(); ++upper)
                entries += blockOfBin[lower] != blockOfBin[upper] ? 2 * std::uint64_t{histogram.at(lower, upper)} : 0;
    }
    return entries;
}

} // namespace isoslider::preprocess
