#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>

#include "core/base/file_system.h"
#include "core/topology/topology_summary.h"

namespace isoslider::topology {

/// Adds a summary to an index, behind it in its file: the index stays as it is. Errors: those of index::writeAppendix.
Status storeTopology(const std::filesystem::path& index, const TopologySummary& summary,
                     FileSystem& fileSystem = defaultFileSystem());

/// What was added to an index; null where nothing was, or not to its end. Reads a directory: pages of events are read
/// when they are asked for. Errors: those of index::readAppendix; Corruption.
Result<std::shared_ptr<const TopologySummary>> openTopology(const std::filesystem::path& index,
                                                            FileSystem& fileSystem = defaultFileSystem());

} // namespace isoslider::topology
