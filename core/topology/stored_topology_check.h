#pragma once

#include <filesystem>
#include <vector>

#include "core/base/file_system.h"
#include "core/base/job_control.h"
#include "core/index/validation/index_validation.h"

namespace isoslider::topology {

struct StoredTopologyCheck {
    bool isThere = false;
    bool hasEvents = true; ///< else counts only: TopologySummary::hasEvents
    std::uint64_t events = 0; ///< or isovalues with counts
    std::vector<index::IndexFault> faults;
};

/// Reads all that is stored of a volume's topology behind its index: checksums, the order of events, that each begins
/// with the counts that the one before it ends with, and that there is no surface before the first and after the last.
/// Errors: IoError, Cancelled.
Result<StoredTopologyCheck> checkStoredTopology(const std::filesystem::path& index, const JobControl& job = {},
                                                FileSystem& fileSystem = defaultFileSystem());

} // namespace isoslider::topology
