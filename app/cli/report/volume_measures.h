#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/job_control.h"
#include "core/extract/merged/merge_bound.h"
#include "core/grid/scalar_grid.h"
#include "core/index/format/index_info.h"
#include "core/volume_io/sources/volume_source.h"

namespace isoslider::cli {

/// What to measure of a volume, and with what.
struct MeasureOptions {
    std::vector<index::IndexKind> kinds{index::IndexKind::Edges, index::IndexKind::Metacells};
    std::vector<double> percents{0.01, 0.1, 1, 2, 5, 10}; ///< step sizes, % of the value range; PAPER Table 3
    int steps = 12; ///< of each size
    std::vector<extract::MergeError> errors; ///< PAPER Fig. 10
    std::filesystem::path folder; ///< where indexes are written meanwhile
    std::uint64_t memoryBytes = std::uint64_t{1} << 30; ///< a build's budget
    std::uint64_t mostIndexBytes = 0; ///< an index of edges that may become larger is not built
};

/// An index of one kind.
struct MeasuredIndex {
    index::IndexKind kind = index::IndexKind::Edges;
    double buildSeconds = 0.0;
    std::optional<index::IndexInfo> info; ///< none: it would be too large
};

/// What steps of one size cost with one kind of index, or from nothing.
struct StepCost {
    double changedEdges = 0.0; ///< mean of those activated and deactivated
    double ms = 0.0; ///< median, until the picture is in memory
};
struct MeasuredStep {
    double percent = 0.0;
    std::vector<std::optional<StepCost>> byKind; ///< as VolumeMeasures::indexes; none without that index
    double freshMs = 0.0; ///< median of a whole extraction at some of the same isovalues; 0: not in memory
};

/// The surface at VolumeMeasures::centre with cells merged within an error, and 1 % steps with it.
struct MeasuredError {
    extract::MergeError error;
    std::uint64_t triangles = 0; ///< cells of up to 32 a side, from the volume; 0: not in memory
    std::uint64_t trianglesOfSlide = 0; ///< cells of up to 8 a side, from the index; 0: there is none of metacells
    double ms = 0.0; ///< median of a step of 1 % in it
};

/// Measured of one volume: the paper's Tables 1 to 3 and Fig. 10.
struct VolumeMeasures {
    std::string name;
    GridDims dims{0, 0, 0};
    ScalarType type = ScalarType::U8;
    std::uint64_t fileBytes = 0; ///< of the samples
    index::IndexInfo facts; ///< of any kind of index
    double centre = 0.0; ///< isovalue with the most active edges in the middle 40 % of the range
    std::vector<MeasuredIndex> indexes;
    std::vector<MeasuredStep> steps;
    std::vector<MeasuredError> errors; ///< the first: none
    bool isInMemory = false; ///< what needs the whole volume in memory was measured
};

/// The isovalue of the bin's lower end with the most active edges in the middle 40 % of the range.
double busiestIsovalue(const index::IndexInfo& info);

/// Isovalues `percent` % of the range apart, the first included: centred on `centre`, turned round at 2 % and 98 % of
/// the range.
std::vector<double> walkAround(const index::IndexInfo& info, double centre, double percent, int steps);

/// Builds indexes of a volume and slides on them in turn. They are gone afterwards. The volume is also held in memory,
/// if that has twice the room. Errors: those of reading, building and sliding; Cancelled.
Result<VolumeMeasures> measureVolume(io::VolumeSource& source, const std::filesystem::path& path,
                                     const MeasureOptions& options, const JobControl& job);

} // namespace isoslider::cli
