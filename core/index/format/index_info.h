#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/grid/grid_geometry.h"
#include "core/grid/histogram.h"
#include "core/grid/scalar_type.h"

namespace isoslider::index {

/// What becomes active and inactive along the skip list. What bricks look like is read from the samples, which an
/// index keeps compressed.
enum class IndexKind : std::uint8_t {
    Edges, ///< grid edges with the scalars of their ends
    Metacells, ///< bricks
    BrickList, ///< bricks alone, of a volume that is in memory; never a file
};

/// "edges", "metacells"; the latter too of a list of bricks.
const char* indexKindName(IndexKind kind);

/// One level of the skip list, as counted when it was built. With metacells a record is a brick that becomes
/// active or inactive, and has one entry.
struct SkipLevelInfo {
    std::uint64_t blocks = 0;
    std::uint64_t points = 0; ///< records: of points, or of bricks
    std::uint64_t edges = 0; ///< entries: of edges, E+ and E- together, or of bricks
    std::uint64_t activatedEdges = 0; ///< those that become active upwards: E+
    std::uint64_t bytes = 0; ///< encoded bytes of its pages
    std::uint64_t redundantRemoved = 0; ///< entries of the level below that cancelled out here
};

/// What an index states of itself and of its volume; all that is read when it is opened.
struct IndexInfo {
    IndexKind kind = IndexKind::Edges;
    int formatMajor = 0; ///< version of the file that it was read from
    GridGeometry geometry;
    ScalarType type = ScalarType::U8;
    double min = 0.0;
    double max = 0.0;
    std::uint64_t distinctValues = 0;
    std::uint64_t nanCount = 0; ///< missing samples: NaN and Inf
    std::uint64_t indexBytes = 0;
    std::uint64_t chunkBytes = 0; ///< encoded bytes of the chunks of samples
    double redundancyThreshold = 0.0; ///< k of the paper, section 2.1
    /// Edges: within how much cells are merged (PAPER 2.2); 0: they are not, or are while sliding.
    double mergeError = 0.0;
    bool isMergeErrorInCells = false; ///< else % of the value range
    std::string sourceName; ///< file name of the volume, without its folder
    std::string lengthUnit; ///< of spacing and origin (core/grid/length_unit.h); empty: unknown
    bool isPatientSpace =
        false; ///< its places are a patient's: left, posterior, superior (LPS). False: not known to be
    std::string resampling; ///< what resampling the volume onto a uniform grid lost, in one line; empty: it was not
    std::vector<SkipLevelInfo> levels;
    Histogram histogram;
    /// Active edges at the lower end of each histogram bin: the cost of an isovalue before a visit.
    std::vector<std::uint64_t> activeEdgesPerBin;
};

} // namespace isoslider::index
