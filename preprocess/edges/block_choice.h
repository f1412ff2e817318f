#pragma once

#include <cstdint>
#include <vector>

#include "core/grid/brick_grid.h"
#include "core/index/format/point_record.h"
#include "preprocess/levels/block_intervals.h"

namespace isoslider::preprocess {

/// Where the blocks of the levels above 0 begin, and the k with which they were chosen.
struct BlockChoice {
    std::vector<std::vector<std::uint64_t>> begins;
    double redundancyThreshold = 0.0;
};

/// Bytes per edge entry at level 0 when some records are encoded for a trial, from which those of the levels above
/// follow roughly (they keep fewer edges per point). Takes records in any order; 0 where there are none.
template <class Key>
double bytesPerEntry(std::vector<index::PointRecord<Key>> sample, const BrickGrid& grid);

/// With this k; if it is 0, with the smallest of kRedundancyChoices with which `points` grid points are expected to
/// take no more than kBytesPerVoxelAim each. `histogram` is of their edges.
BlockChoice chooseBlocks(const SpanHistogram& histogram, const KeyIntervals& bins, int skipLevels,
                         double redundancyThreshold, double bytesPerEntry, double points);

/// Calls visit(e) for each edge of a record.
template <class Key, class Visit>
void forEachEdge(const index::PointRecord<Key>& record, const Visit& visit) {
    for (int e = 0; e < index::kPointEdges; ++e)
        if (record.edgeMask >> e & 1)
            visit(e);
}

extern template double bytesPerEntry(std::vector<index::PointRecord<std::uint16_t>>, const BrickGrid&);
extern template double bytesPerEntry(std::vector<index::PointRecord<std::uint32_t>>, const BrickGrid&);
extern template double bytesPerEntry(std::vector<index::PointRecord<std::uint64_t>>, const BrickGrid&);

} // namespace isoslider::preprocess
