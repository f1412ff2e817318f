#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "core/base/state_archive.h"
#include "core/index/format/chunk_grid.h"
#include "core/index/format/index_format.h"
#include "preprocess/metacells/brick_list.h"
#include "preprocess/value_bins.h"

namespace isoslider::preprocess {

/// What is counted by value in one pass over the samples: the histogram, and how many edges are active where.
/// An edge is active at thresholds above its lower and up to its higher scalar, so the number of active edges
/// rises at a sample by its greater neighbours and falls by its smaller ones: a sum of six signs a sample.
/// 8- and 16-bit samples are counted by key, others by bin.
template <class Sample>
class ValueCounts {
public:
    using Key = KeyOf<Sample>;
    static constexpr bool kByKey = sizeof(Key) == 2;

    ValueCounts() : counts_(kByKey ? std::size_t{1} << 16 : ValueBins<Sample>::kCount) {}

    /// `bins` are not looked at when samples are counted by key.
    void add(Sample sample, std::int64_t change, const ValueBins<Sample>& bins) {
        if constexpr (kByKey)
            count(keyOf(sample), keyOf(sample), change);
        else
            addToBin(sample, bins.binOf(sample), change, bins);
    }
    /// As many whole rows at once. REQUIRES: no sample is missing.
    template <class Change, std::size_t kLength>
    void addRow(const Sample* row, const std::array<Change, kLength>& changes, const ValueBins<Sample>& bins) {
        if constexpr (kByKey) {
            for (std::size_t x = 0; x < kLength; ++x)
                count(keyOf(row[x]), keyOf(row[x]), changes[x]);
        } else {
            std::array<std::int32_t, kLength> binsOfRow;
            bins.binsOf(row, binsOfRow);
            for (std::size_t x = 0; x < kLength; ++x)
                addToBin(row[x], static_cast<std::size_t>(binsOfRow[x]), changes[x], bins);
        }
    }
    void merge(const ValueCounts& other);
    void state(StateArchive& archive) { archive(counts_); }
    /// Least and greatest key with a sample; false when there is none. REQUIRES: kByKey.
    bool range(Key& least, Key& greatest) const;
    std::uint64_t distinct() const; ///< REQUIRES: kByKey
    std::uint64_t samples() const;
    /// Sets the histogram and the curve of `info`, whose min and max are those of `bins`.
    void fill(index::IndexInfo& info, const ValueBins<Sample>& bins) const;

private:
    struct Count {
        std::uint64_t samples = 0;
        std::int64_t change = 0;
    };
    void count(std::size_t at, std::size_t curveAt, std::int64_t change) {
        ++counts_[at].samples;
        counts_[curveAt].change += change;
    }
    void addToBin(Sample sample, std::size_t bin, std::int64_t change, const ValueBins<Sample>& bins) {
        count(bin, bins.curveBinOf(sample, bin), change);
    }

    std::vector<Count> counts_;
};

/// One chunk with the samples around it, looked at in all the ways that an index of metacells needs while it is
/// in the nearest cache.
template <class Sample>
class ChunkScan {
public:
    /// Samples along each side of the block: the chunk, and one more on either side.
    static constexpr int kSide = index::kChunkSide + 2;
    using PlaneAt = std::function<const Sample*(std::int64_t z)>;

    explicit ChunkScan(const GridDims& dims) : dims_(dims), bricks_(dims), chunks_(dims) {}

    /// Takes the samples of a chunk and around it; those beyond the box repeat the nearest inside.
    void load(index::ChunkIndex chunk, const PlaneAt& planeAt);

    /// The chunk's own samples, packed, x fastest.
    std::span<const Sample> packed();
    const index::ChunkExtent& extent() const { return extent_; }
    /// Least and greatest keys of the chunk's bricks; those without finite samples get least > greatest.
    void spans(BrickSpans<KeyOf<Sample>>& spans) const;
    /// True when a sample of the block is missing: in the chunk or beside it.
    bool hasMissing() const { return hasMissing_; }
    void missingCells(std::vector<index::MissingCells>& cells) const;
    void countValues(const ValueBins<Sample>& bins, ValueCounts<Sample>& counts) const;

private:
    const Sample* at(int x, int y, int z) const {
        return block_.data() + (x + 1) + kSide * ((y + 1) + kSide * (z + 1));
    }
    bool isCellValid(std::int64_t x, std::int64_t y, std::int64_t z) const;
    std::int64_t changeAt(int x, int y, int z) const;
    template <class Visit>
    void forEachBrick(const Visit& visit) const;

    GridDims dims_;
    BrickGrid bricks_;
    index::ChunkGrid chunks_;
    std::array<std::int64_t, 3> origin_{};
    index::ChunkExtent extent_{};
    bool hasMissing_ = false;
    std::array<Sample, kSide * kSide * kSide> block_;
    std::array<Sample, index::kChunkSide * index::kChunkSide * index::kChunkSide> packed_;
};

} // namespace isoslider::preprocess
