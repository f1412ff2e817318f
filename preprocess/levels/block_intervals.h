#pragma once

#include <cstdint>
#include <vector>

#include "core/base/state_archive.h"
#include "preprocess/levels/key_intervals.h"

namespace isoslider::preprocess {

/// Where the blocks of the skip levels begin, decided before any record is sorted.
///
/// The paper (2.1) walks a level, consolidates blocks, and ends a consolidated block when its
/// redundant edges exceed k times the active edges. How many edges have both ends in an interval can
/// be read off a histogram over span space: counts of edges by (bin of lower scalar, bin of upper
/// scalar). So boundaries of all levels are known before the sort, every record goes to its block of
/// every level in one pass, and nothing is consolidated twice. DEVIATION: boundaries fall on bins
/// (one value each when there are few values, at most kMaxSpanBins quantiles otherwise).
inline constexpr int kMaxSpanBins = 1024;

/// Bins with about equally many points; one for each key of `counts` where these are few.
KeyIntervals makeSpanBins(const std::vector<KeyCount>& counts);

/// Counts of edges by the bins of their ends, lower scalar first. Row-major, bins * bins.
class SpanHistogram {
public:
    explicit SpanHistogram(std::size_t bins) : bins_(bins), counts_(bins * bins, 0) {}
    void add(std::size_t lower, std::size_t upper) { ++counts_[lower * bins_ + upper]; }
    void merge(const SpanHistogram& other);
    void state(StateArchive& archive) { archive.fixed(std::span(counts_)); }
    std::size_t bins() const { return bins_; }
    std::uint64_t memoryBytes() const { return counts_.size() * sizeof counts_[0]; }
    std::uint32_t at(std::size_t lower, std::size_t upper) const { return counts_[lower * bins_ + upper]; }

private:
    std::size_t bins_;
    std::vector<std::uint32_t> counts_;
};

/// Block boundaries per level above 0: for level L, beginKeys[L - 1] are the first keys of its blocks.
/// Each block of a level is a union of at least two blocks of the level below (level 0: of values).
/// Stops early when a level has a single block. O(bins^2).
std::vector<std::vector<std::uint64_t>> chooseBlockBegins(const SpanHistogram& histogram, const KeyIntervals& bins,
                                                          int skipLevels, double redundancyThreshold);

/// Edge entries (E+ and E-) of all levels above 0 with these block boundaries. O(levels * bins^2).
std::uint64_t countEntriesAbove(const SpanHistogram& histogram, const KeyIntervals& bins,
                                const std::vector<std::vector<std::uint64_t>>& blockBegins);

} // namespace isoslider::preprocess
