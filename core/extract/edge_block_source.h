#pragma once

#include <memory>

#include "core/extract/block_walk.h"
#include "core/extract/change_source.h"
#include "core/extract/hidden_scalars.h"
#include "core/index/hidden_corners.h"
#include "core/index/index_reader.h"

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
    using Part = typename BlockWalk<Key>::Part;
    std::size_t emit(const Part& part, KeyThreshold lower, KeyThreshold upper, bool goesUp, ChangeSet<Live>& changes) const;

    const index::IndexReader& reader_;
    BlockWalk<Key> walk_;
    index::HiddenCorners hiddenCorners_;
};

} // namespace isoslider::extract
