#include "preprocess/edges/leaf_intervals.h"

#include <algorithm>
#include <bit>

#include "core/extract/live/merged_cells.h"
#include "core/extract/sources/leaf_finding.h"
#include "core/grid/scalar_type.h"

namespace isoslider::preprocess {
namespace {

/// Bits of merged cells in the order of their numbers.
struct CellBits {
    std::uint64_t level1 = 0, above = 0; ///< above: those of level 2, then that of level 3
    explicit CellBits(const extract::BrickLeaves& leaves)
        : level1(leaves.level1), above(leaves.level2 | std::uint64_t{leaves.level3} << 8) {}

    template <class Visit>
    void forEachNotIn(const CellBits& other, const Visit& visit) const {
        for (std::uint64_t rest = level1 & ~other.level1; rest != 0; rest &= rest - 1)
            visit(static_cast<std::size_t>(std::countr_zero(rest)));
        for (std::uint64_t rest = above & ~other.above; rest != 0; rest &= rest - 1)
            visit(static_cast<std::size_t>(64 + std::countr_zero(rest)));
    }
};

} // namespace

template <class Key>
template <class Sample>
void LeafIntervals<Key>::find(const extract::StoredSample<Sample>* samples, const extract::BrickMasks& masks,
                              const extract::MergeBound& bound) {
    using Stored = extract::StoredSample<Sample>;
    intervals_.clear();
    std::vector<Stored> values(samples, samples + extract::kClosedPoints);
    std::sort(values.begin(), values.end());
    values.erase(std::unique(values.begin(), values.end()), values.end());

    std::array<std::vector<KeyInterval<Key>>, kCells> found;
    std::array<Key, kCells> openSince{};
    extract::ClassifiedBrick<Stored> classified;
    extract::BitString before;
    extract::BrickLeaves usable;
    extract::ExceedingEdges exceeding;
    CellBits open{extract::BrickLeaves()};
    const extract::SureCells sure = extract::findSureCells<Sample>(samples, masks.cells, bound);
    const auto keyAt = [&](std::size_t i) { return keyOf(extract::sampleOf<Sample>(values[i])); };
    const auto close = [&](const CellBits& now, Key until) {
        open.forEachNotIn(now, [&](std::size_t cell) { found[cell].push_back({openSince[cell], until}); });
    };
    for (std::size_t i = 1; i < values.size(); ++i) {
        extract::classify(samples, values[i], masks,
                          i == 1 ? std::nullopt : std::optional<extract::BitsInMemory>(before), classified);
        usable =
            (i == 1 ? extract::findBrickLeaves<Sample>(samples, classified.above, classified.active, masks.cells, bound,
                                                       sure, exceeding)
                    : extract::updateBrickLeaves<Sample>(usable, before, classified.changed, samples, classified.above,
                                                         classified.active, masks.cells, bound, sure, exceeding))
                .usable;
        before = classified.above;
        const CellBits now(extract::crossedLeaves(usable, classified.active.cells));
        const Key passed = keyAt(i - 1);
        close(now, passed);
        now.forEachNotIn(open, [&](std::size_t cell) { openSince[cell] = passed; });
        open = now;
    }
    close(CellBits(extract::BrickLeaves()), values.empty() ? Key{} : keyAt(values.size() - 1));
    for (std::size_t cell = 0; cell < kCells; ++cell) {
        begins_[cell] = static_cast<std::uint32_t>(intervals_.size());
        intervals_.insert(intervals_.end(), found[cell].begin(), found[cell].end());
    }
    begins_[kCells] = static_cast<std::uint32_t>(intervals_.size());
    intervals_.shrink_to_fit();
}

template class LeafIntervals<std::uint16_t>;
template class LeafIntervals<std::uint32_t>;
template class LeafIntervals<std::uint64_t>;
#define ISO_INSTANTIATE(Sample, Name) \
    template void LeafIntervals<KeyOf<Sample>>::find<Sample>(const extract::StoredSample<Sample>*, \
                                                             const extract::BrickMasks&, const extract::MergeBound&);
ISO_FOR_EACH_SAMPLE_TYPE(ISO_INSTANTIATE)
#undef ISO_INSTANTIATE

} // namespace isoslider::preprocess
