#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>

#include "core/index/format/index_info.h"

namespace isoslider::cli {

/// Over the lower ends of the histogram's bins: even steps through the range of isovalues.
inline double meanActiveEdges(const index::IndexInfo& info) {
    const auto& counts = info.activeEdgesPerBin;
    const double sum = std::accumulate(counts.begin(), counts.end(), 0.0);
    return counts.empty() ? 0.0 : sum / static_cast<double>(counts.size());
}

/// Edges, bricks or entries of merged edges that come or go from one value to the next.
inline double meanChange(const index::IndexInfo& info) {
    const bool isMerged = info.mergeError > 0.0; // there, values may have no block
    const std::uint64_t values = info.levels.empty() ? 0 : isMerged ? info.distinctValues : info.levels[0].blocks;
    return values == 0 ? 0.0 : static_cast<double>(info.levels[0].edges) / static_cast<double>(values);
}

/// Of a grid point.
inline double bytesPerPoint(const index::IndexInfo& info, std::uint64_t bytes) {
    return static_cast<double>(bytes) / static_cast<double>(std::max<std::int64_t>(1, pointCount(info.geometry.dims)));
}

} // namespace isoslider::cli
