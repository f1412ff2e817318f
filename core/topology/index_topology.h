#pragma once

#include <filesystem>
#include <memory>

#include "core/base/job_control.h"
#include "core/topology/topology_summary.h"

namespace isoslider::topology {

/// The topology of the volume of an index of metacells, analysed from its samples.
/// Errors: those of opening an index; InvalidArgument (an index of edges); Cancelled.
Result<std::shared_ptr<const TopologySummary>> analyseIndex(const std::filesystem::path& index, const JobControl& job);

} // namespace isoslider::topology
