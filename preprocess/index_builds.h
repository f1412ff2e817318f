#pragma once

#include <filesystem>

#include "core/base/file_system.h"
#include "preprocess/build_index.h"

namespace isoslider::preprocess {

// The two ways to build an index, behind buildIndex(): options are checked, threads bounded. They set the report's
// index, its forecast, and whether an unfinished build was gone on with.

Status buildEdges(io::VolumeSource& source, const std::filesystem::path& indexPath, const BuildOptions& options,
                  const JobControl& job, BuildReport& report);
Status buildMetacells(io::VolumeSource& source, const std::filesystem::path& indexPath, const BuildOptions& options,
                      const JobControl& job, BuildReport& report);

inline FileSystem& fileSystemOf(const BuildOptions& options) {
    return options.fileSystem ? *options.fileSystem : defaultFileSystem();
}

/// Where sort runs go.
inline std::filesystem::path spillPathOf(const std::filesystem::path& indexPath, const BuildOptions& options) {
    std::filesystem::path name = indexPath.filename();
    name += ".sort.partial";
    return options.temporaryFolder.empty() ? indexPath.parent_path() / name : options.temporaryFolder / name;
}

/// Whether a build makes no checkpoint, being over before one is due as a rule.
inline bool isBrief(const GridDims& dims, const BuildOptions& options) {
    constexpr std::int64_t kPoints = std::int64_t{1} << 20; // a second, on a slow machine
    return options.checkpointSeconds < 0.0 || (options.checkpointSeconds >= 1.0 && pointCount(dims) <= kPoints);
}

} // namespace isoslider::preprocess
