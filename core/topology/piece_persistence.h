#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/job_control.h"
#include "core/index/sample_blocks.h"
#include "core/topology/analysis/component_graph.h"

namespace isoslider::topology {

/// How long a piece of the surface is there as such while the isovalue moves. A piece parts two regions: one above the
/// isovalue and one below it. A region comes at its first point (the highest, the lowest) and ends where it joins a
/// region that came earlier (the elder rule); with the region that lasts shorter the piece goes. So this is the
/// persistence of the events at which it comes or goes (TopologyEvent).
struct PiecePersistence {
    double persistence = 0.0; ///< in scalars
    bool isAtLeast = false; ///< the regions are too large to be walked to their ends: it is that or more
    Side side = Side::Above; ///< of the region that lasts shorter
    double comes = 0.0; ///< scalar of that region's first point, as far as it was walked
    double ends = 0.0; ///< isovalue at which it joins an elder one, or up to which it was walked
    bool lasts = false; ///< it never joins one; `ends` means nothing
};

/// A vertex of a piece: the lower grid point and the axis of the edge, or of several in a row, that it lies on.
struct PieceVertex {
    std::array<std::int32_t, 3> edgeStart{};
    int edgeAxis = 0;
};

struct PersistenceOptions {
    double least = 0.0, greatest = 0.0; ///< of the volume: what never joins has lasted from end to end
    /// That are walked to on each side; one microsecond each, ten in noise.
    std::uint64_t mostPoints = std::uint64_t{1} << 19;
    /// The same of all walks of findShortLivedPieces() together.
    std::uint64_t mostPointsInAll = std::uint64_t{1} << 24;
};

/// From samples alone, by walking from the vertex: through both regions, then on through what is joined next, until an
/// elder region is met. Small regions take no time, whatever the volume. Cells beside missing samples do not count, as
/// in all topology here. O(points log points). Errors: Cancelled, those of `samples`; InvalidArgument (no surface
/// crosses there).
Result<PiecePersistence> persistenceOfPiece(index::SampleBlocks& samples, const PieceVertex& vertex, double isovalue,
                                            const PersistenceOptions& options, const JobControl& job = {});

/// Which of several pieces last for less than asked.
struct PieceLifetimes {
    std::vector<bool> isShortLived; ///< by place among the pieces; false where it was not found out
    bool isComplete = true; ///< false: for some the walks grew too long, and they count as lasting
};

/// Whether persistenceOfPiece() is below `least`, for pieces of one surface. A walk ends where its region is known to
/// last, most of them after some hundred points, and no region is walked through twice: the number of pieces may be
/// large. A vertex that the surface does not cross is of a lasting piece. Errors: Cancelled, those of `samples`.
Result<PieceLifetimes> findShortLivedPieces(index::SampleBlocks& samples, std::span<const PieceVertex> pieces,
                                            double isovalue, double least, const PersistenceOptions& options,
                                            const JobControl& job = {});

} // namespace isoslider::topology
