#pragma once

#include <memory>

#include "core/index/hidden_corners.h"
#include "core/extract/walked_source.h"
#include "core/index/index_reader.h"

namespace isoslider::extract {

/// Net edge changes from an index of edge blocks (the paper's skip list).
///
/// A move from threshold a to b crosses the points with keys in [a, b) (b < a: [b, a)). Of a crossed
/// point's edges those whose far end is crossed too are redundant for the whole move, and each record
/// carries the far end's scalar: so net changes need no bookkeeping between blocks, levels or threads.
template <class Sample>
class EdgeBlockSource final : public WalkedSource<Sample> {
public:
    using typename WalkedSource<Sample>::Key;
    using typename WalkedSource<Sample>::Live;

    /// `reader` must outlive the source.
    EdgeBlockSource(const index::IndexReader& reader, std::uint64_t cacheBytes);

    Status collect(KeyThreshold from, KeyThreshold to, ChangeSet<Live>& changes, SlideStats& stats, std::stop_token stop) override;
    Result<std::optional<double>> hiddenScalar(BrickIndex brick, LocalPoint cell, int corner) override {
        return hiddenCorners_.find(brick, cell, corner);
    }
    void dropCaches() override {
        walk_.dropCaches();
        hiddenCorners_.clear();
    }
    std::uint64_t hiddenBytesRead() const override { return hiddenCorners_.bytesRead(); }

private:
    using typename WalkedSource<Sample>::Part;
    using WalkedSource<Sample>::reader_;
    using WalkedSource<Sample>::walk_;
    std::size_t emit(const Part& part, KeyThreshold lower, KeyThreshold upper, bool goesUp, ChangeSet<Live>& changes) const;

    index::HiddenCorners hiddenCorners_;
};

} // namespace isoslider::extract
