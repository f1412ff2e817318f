#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include <glm/vec3.hpp>

#include "core/extract/merged/merge_bound.h"
#include "core/grid/brick_box.h"
#include "core/grid/grid_geometry.h"
#include "core/index/format/skip_level.h"

namespace isoslider::extract {

/// One stretch of the walk along the skip list during a move.
struct WalkStep {
    index::SkipLevel level;
    std::uint64_t blocks = 0; ///< blocks read at this level
    std::uint64_t edges = 0; ///< edge entries decoded there; of levels built later (LazyLevels), bricks
    std::uint64_t bytes = 0; ///< encoded bytes decoded there (cached pages included)
};

/// What one move cost, counted where the work happens.
struct SlideStats {
    double isovalue = 0.0;
    /// Active edges. Of the grid where cells are merged, too; there, bricks that leave count their vertices, and so do
    /// bricks of one cell.
    std::uint64_t edgesAdded = 0;
    std::uint64_t edgesRemoved = 0;
    std::uint64_t edgesTouched = 0; ///< edge entries looked at, redundant ones included, and bricks of lazy levels
    std::uint64_t cellsRetriangulated = 0;
    std::uint64_t cellsResolved = 0; ///< ambiguous cells decided in the move, by their corner scalars
    std::uint64_t ambiguousCells = 0; ///< active cells whose signs do not determine their surface
    std::uint64_t activeEdges = 0;
    std::uint64_t triangles = 0;
    LeafCounts activeLeaves{}; ///< active cells by their level: above 0 merged ones
    std::uint64_t bricksRead = 0; ///< bricks of samples looked into
    std::uint64_t chunksRead = 0; ///< chunks of samples decoded; 0 in memory
    std::uint64_t bytesRead = 0; ///< bytes read from the index file: what was in no cache
    std::uint64_t bytesAhead = 0; ///< read in the background since the last move, in the hope of this one
    double updateMs = 0.0;
    double interpolateMs = 0.0;
    bool hasRebuilt = false; ///< the surface was built again instead of patched
    std::vector<WalkStep> walk;
};

template <class Live>
class BrickPicture;
class SurfacePieces;

/// An immutable picture of the surface, handed from the worker to the window: either bricks of the live surface, or
/// whole arrays where there are no bricks, or none that a graphics card could draw (expandPicture() makes them).
struct SurfaceFrame {
    std::shared_ptr<const BrickPicture<float>> bricks;
    GridGeometry geometry;
    double isovalue = 0.0;
    std::vector<glm::vec3> positions; ///< grid index units
    std::vector<glm::vec3> normals; ///< unit, along the grid's axes, towards lower scalars
    std::vector<std::uint32_t> indices;
    std::vector<std::uint32_t> changedIndices; ///< triangles retriangulated by the last move
    bool findsPieces = false; ///< wanted by whoever looks: `pieces`
    /// Of the bricks; where there are arrays, those bricks came one after the other. Null where nobody wants it, and
    /// for what is not made of bricks, or where there was no memory for them.
    std::shared_ptr<const SurfacePieces> pieces;
    bool marksChanges = true; ///< wanted by whoever looks: `changedIndices`, or those of the bricks
    MergeBound mergeBound; ///< wanted by whoever looks; afterwards the one that the surface has
    /// Wanted by whoever looks; afterwards where the surface was made: what lies outside is missing, in `stats` too.
    /// None: nothing is missing.
    std::optional<BrickBox> region;
    SlideStats stats;
    bool isFromIndex = false; ///< false: from the volume in memory, before the index was there
    /// Not slid to: every triangle is new, no cell merged, nothing missing, whatever was wanted.
    bool isWholeExtraction = false;
    /// Above 1: a coarser surface to look at, its vertices merged in blocks of so many cells along each axis. `stats`
    /// are of the whole one.
    std::int64_t mergedCells = 1;
};

/// What a frame takes on a graphics card.
std::uint64_t pictureBytes(const SurfaceFrame& frame);

} // namespace isoslider::extract
