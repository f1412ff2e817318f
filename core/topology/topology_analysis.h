#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <span>

#include "core/base/file_system.h"
#include "core/base/job_control.h"
#include "core/grid/grid_geometry.h"
#include "core/grid/scalar_grid.h"
#include "core/grid/scalar_type.h"
#include "core/topology/measuring.h"
#include "core/topology/topology_curve.h"

namespace isoslider::topology {

/// Memory for each sample that an analysis takes at most where it may put off the rest to a file.
inline constexpr std::uint64_t kBytesPerSample = 8;

/// A volume to analyse, read in planes that rise.
struct PlaneSource {
    GridGeometry geometry;
    ScalarType type = ScalarType::U8;
    /// Fills `out` with planes [zBegin, zEnd), x fastest. One call at a time, from any thread.
    std::function<Status(std::int64_t zBegin, std::int64_t zEnd, std::span<std::byte> out)> read;
    std::uint64_t heldBytes = 0; ///< that it keeps while it is read: part of what the analysis may take
};
/// `grid` must outlive it.
PlaneSource planesOf(const ScalarGrid& grid);

/// Volumes with planes of as many samples or more are not analysed.
inline constexpr std::int64_t kMostPlaneSamples = std::int64_t{1} << 27;

struct AnalysisOptions {
    std::uint64_t memoryBytes = std::numeric_limits<std::uint64_t>::max();
    MeasurePlan measures; ///< none: the curves stay empty
    bool mayLackEvents = true; ///< where memory does not hold them, and measures are planned
    /// Planes read at once, 3 to 16, and rows of cells worked on at once; 0: as is best (StripCut). Events are the same
    /// with any number, but for which of several places of one isovalue is stated.
    std::int64_t planesAtOnce = 0, rowsAtOnce = 0;
    /// Two files for what is found and memory does not hold: changes, until events are made of them, and pages of
    /// these, as long as the curve is there. They have no name once they are there. Empty: none. With them, no
    /// more is taken than kBytesPerSample, as far as layers allow, whatever `memoryBytes`.
    std::filesystem::path scratch;
    FileSystem* fileSystem = &defaultFileSystem(); ///< of that
    std::string* scratchProblem = nullptr; ///< is told why the file was done without, where it was
    /// Points of the boundary of all cells that are settled together, 1 or more; events are the same with any number.
    std::size_t boundaryPointsAtOnce = std::size_t{1} << 13;
};

/// Every isovalue at which the topology of the volume's surface changes. TOPOLOGY.md.
/// O(n) in samples, O(m log m) in what can be an event; all threads. Memory: some planes, and what can be an event
/// as far as it is not put off to `options.scratch`. Where that is more than `options.memoryBytes`, and events may be
/// lacking: counts only, at some thousand isovalues (TopologySummary::hasEvents), in memory for some planes. Samples
/// may then be read twice, also where the file fails.
/// Errors: those of `source`; InvalidArgument (planes of 2^27 samples or more); OutOfSpace (more than
/// `options.memoryBytes` even so); Cancelled.
Result<TopologyCurve> analyseTopology(const PlaneSource& source, const AnalysisOptions& options = {},
                                      const JobControl& job = {});

} // namespace isoslider::topology
