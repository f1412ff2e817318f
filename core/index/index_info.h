#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/grid/grid_geometry.h"
#include "core/grid/scalar_type.h"

namespace isoslider::index {

/// One level of the skip list, as counted when it was built.
struct SkipLevelInfo {
    std::uint64_t blocks = 0;
    std::uint64_t points = 0;         ///< point records
    std::uint64_t edges = 0;          ///< edge entries, E+ and E- together
    std::uint64_t activatedEdges = 0; ///< E+
    std::uint64_t bytes = 0;          ///< encoded bytes of its pages
    std::uint64_t redundantRemoved = 0; ///< entries of the level below that cancelled out here
};

/// Counts of finite samples in equal bins over [min, max].
struct Histogram {
    double min = 0.0;
    double max = 0.0;
    std::vector<std::uint64_t> counts;
};

/// What an index says of itself and of its volume; all that is read when it is opened.
struct IndexInfo {
    GridGeometry geometry;
    ScalarType type = ScalarType::U8;
    double min = 0.0;
    double max = 0.0;
    std::uint64_t distinctValues = 0;
    std::uint64_t nanCount = 0;    ///< missing samples: NaN and Inf
    std::uint64_t indexBytes = 0;
    std::uint64_t hiddenCorners = 0;     ///< samples stored because sliding cannot learn them from active edges
    std::uint64_t hiddenCornerBytes = 0; ///< encoded bytes of their pages
    double redundancyThreshold = 0.0; ///< k of the paper, section 2.1
    std::string sourceName;        ///< file name of the volume, without its folder
    std::vector<SkipLevelInfo> levels;
    Histogram histogram;
    /// Active edges at the lower end of each histogram bin: the cost of an isovalue before a visit.
    std::vector<std::uint64_t> activeEdgesPerBin;
};

} // namespace isoslider::index
