#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "core/base/file_system.h"
#include "core/base/job_control.h"
#include "core/extract/merged/merge_bound.h"
#include "core/index/format/index_info.h"
#include "core/volume_io/sources/volume_source.h"
#include "preprocess/forecast/disk_forecast.h"

namespace isoslider::preprocess {

struct BuildOptions {
    index::IndexKind kind = index::IndexKind::Edges;
    /// With edges: cells are merged within this error (PAPER 2.2). With metacells that is decided while sliding.
    extract::MergeError mergeError = {};
    int skipLevels = 5; ///< levels written, level 0 included; 1..8
    /// k: a block ends when redundant edges exceed k * active edges. 0: with edges the smallest of
    /// kRedundancyChoices with which the index is expected to stay below kBytesPerVoxelAim, else 1.
    double redundancyThreshold = 0.0;
    std::uint64_t memoryBytes = std::uint64_t{1} << 30;
    int threads = 0; ///< 0: all cores
    std::filesystem::path temporaryFolder; ///< for sort runs; empty: beside the index
    std::string sourceName;
    /// Topology will be added behind the index (topology::storeTopology): the forecast has room for it.
    bool withTopology = false;
    /// Goes on with an unfinished build of this index, if there is one, and leaves one if it does not come to its end
    /// (resume/RESUME.md).
    bool resumes = false;
    /// An unfinished build that does not fit, of another input or another version of the program, makes room for this
    /// one; otherwise it is refused.
    bool replacesUnfit = false;
    /// Whoever builds adds the topology next, and calls forgetCompletedBuild() then. Until then NAME.resume states that
    /// the index is complete: a build that is to go on builds nothing.
    bool leavesTopology = false;
    double checkpointSeconds = 10.0; ///< at least, between two checkpoints; below 0: none
    FileSystem* fileSystem = nullptr; ///< what to write through; null: the disk
};

/// Finer levels make moves cheaper and the index larger.
inline constexpr double kRedundancyChoices[] = {0.5, 1.0, 2.0, 4.0};
inline constexpr double kBytesPerVoxelAim = 20.0;

/// Smallest accepted BuildOptions::memoryBytes.
inline constexpr std::uint64_t kMinBuildMemoryBytes = std::uint64_t{64} << 20;

struct BuildReport {
    double seconds = 0.0;
    std::uint64_t peakRssBytes = 0;
    index::IndexInfo info;
    bool isResumed = false; ///< an unfinished build was gone on with
    DiskForecast forecast; ///< before the work was done
    std::uint64_t temporaryBytes = 0; ///< the most that lay beside the index at one time
};

/// Builds the index for a volume and publishes it at `indexPath`: written to a
/// temporary file beside it, synced, renamed. The same bytes for any thread count and memory budget.
/// On failure or cancel an earlier index at `indexPath` is untouched, and nothing is left behind but what
/// `options.resumes` asks for.
/// Errors: InvalidArgument (also when the volume's files changed meanwhile), IoError, OutOfSpace (also when the
/// forecast asks for more of the disk than is free), Cancelled, whatever the source reports.
Result<BuildReport> buildIndex(io::VolumeSource& source, const std::filesystem::path& indexPath,
                               const BuildOptions& options = {}, const JobControl& job = {});

/// The topology is there, or will not be: see BuildOptions::leavesTopology.
void forgetCompletedBuild(const std::filesystem::path& indexPath, FileSystem& fileSystem = defaultFileSystem());

} // namespace isoslider::preprocess
