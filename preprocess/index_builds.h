#pragma once

#include <filesystem>

#include "core/base/file_system.h"
#include "preprocess/build_index.h"

namespace isoslider::preprocess {

// The two ways to build an index, behind buildIndex(): options are checked, threads bounded.

Result<index::IndexInfo> buildEdges(io::VolumeSource& source, const std::filesystem::path& indexPath,
                                    const BuildOptions& options, const JobControl& job);
Result<index::IndexInfo> buildMetacells(io::VolumeSource& source, const std::filesystem::path& indexPath,
                                        const BuildOptions& options, const JobControl& job);

inline FileSystem& fileSystemOf(const BuildOptions& options) {
    return options.fileSystem ? *options.fileSystem : defaultFileSystem();
}

/// Where sort runs go.
inline std::filesystem::path spillPathOf(const std::filesystem::path& indexPath, const BuildOptions& options) {
    std::filesystem::path name = indexPath.filename();
    name += ".sort.partial";
    return options.temporaryFolder.empty() ? indexPath.parent_path() / name : options.temporaryFolder / name;
}

} // namespace isoslider::preprocess
