#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>

#include "core/base/file_system.h"
#include "core/index/index_reader.h"
#include "core/topology/topology_curve.h"

namespace isoslider::topology {

/// Adds the topology of the volume of `index`, behind it in its file: the index stays as it is. One that is there
/// stays, unless `replaces`. Errors: those of index::writeAppendix.
Status storeTopology(const index::IndexReader& index, const TopologyCurve& summary, bool replaces = false,
                     FileSystem& fileSystem = defaultFileSystem());

/// What was added to an index; null where nothing was, or not to its end. Reads a directory: pages of events are read
/// when they are asked for. Errors: those of index::readAppendix; Corruption; UnsupportedVersion (added by a later
/// version of the program).
Result<std::shared_ptr<const TopologySummary>> openTopology(const std::filesystem::path& index,
                                                            FileSystem& fileSystem = defaultFileSystem());

} // namespace isoslider::topology
