#pragma once

#include <memory>

#include "core/extract/change_source.h"
#include "core/extract/hidden_scalars.h"
#include "core/index/hidden_corners.h"
#include "core/index/index_reader.h"
#include "core/index/lazy_levels.h"
#include "core/index/page_cache.h"
#include "core/index/skip_list.h"

namespace isoslider::extract {

/// Net edge changes from an index of edge blocks (the paper's skip list).
///
/// A move from threshold a to b crosses the points with keys in [a, b) (b < a: [b, a)). Of a crossed
/// point's edges those whose far end is crossed too are redundant for the whole move, and each record
/// carries the far end's scalar: so net changes need no bookkeeping between blocks, levels or threads.
template <class Sample>
class EdgeBlockSource final
    : public ChangeSource<std::conditional_t<std::is_same_v<Sample, std::int32_t> || std::is_same_v<Sample, double>, double, float>>,
      public HiddenScalars {
public:
    using Key = KeyOf<Sample>;
    using Live = std::conditional_t<std::is_same_v<Sample, std::int32_t> || std::is_same_v<Sample, double>, double, float>;

    /// `reader` must outlive the source.
    EdgeBlockSource(const index::IndexReader& reader, std::uint64_t cacheBytes);

    Status collect(KeyThreshold from, KeyThreshold to, ChangeSet<Live>& changes, SlideStats& stats, std::stop_token stop) override;
    std::uint64_t estimate(KeyThreshold from, KeyThreshold to) const override;
    KeyThreshold threshold(double isovalue) const override { return thresholdOf<Sample>(isovalue); }
    KeyThreshold lowest() const override { return 0; }
    KeyThreshold highest() const override;
    Result<std::optional<double>> hiddenScalar(BrickIndex brick, LocalPoint cell, int corner) override {
        return hiddenCorners_.find(brick, cell, corner);
    }
    std::uint64_t hiddenBytesRead() const override { return hiddenCorners_.bytesRead(); }

private:
    struct Counts;
    struct Task;
    /// The pages of a walk; whole runs of top-level blocks come from lazy levels where there is room.
    Result<std::vector<Task>> makeTasks(const std::vector<index::WalkSegment>& segments, SlideStats& stats);
    void emit(const index::DecodedPage<Key>& page, const Task& task, KeyThreshold lower, KeyThreshold upper,
              bool goesUp, ChangeSet<Live>& changes, Counts& counts) const;

    const index::IndexReader& reader_;
    index::SkipList skipList_;
    index::PageCache<Key> cache_;
    index::LazyLevels<Key> lazyLevels_;
    index::HiddenCorners hiddenCorners_;
};

} // namespace isoslider::extract
