#pragma once

#include <filesystem>
#include <memory>

#include "core/base/job_control.h"
#include "core/index/index_reader.h"
#include "core/topology/topology_analysis.h"

namespace isoslider::topology {

/// Where what is found may lie until events are made of it: beside the index.
std::filesystem::path scratchPathOf(const std::filesystem::path& index);

/// Planes of samples of an index, sixteen of them decoded at a time. `reader` must outlive it.
PlaneSource planesOf(const index::IndexReader& reader);

/// The topology of the volume of an index, analysed from its samples. `options.measures` are made. Errors: those of
/// analysing and of reading the index.
Result<TopologyCurve> analyseIndex(const index::IndexReader& reader, AnalysisOptions options, const JobControl& job);

/// What is stored with the index, or else (none, or a damaged one) analysed now, and added to the index for the next
/// time where that can be: `storing` reports how that went. Errors: those of opening an index, and of analysing it.
struct IndexTopology {
    std::shared_ptr<const TopologySummary> summary;
    Status storing;
    bool isNew = false; ///< analysed now: with as much memory as there is
};
Result<IndexTopology> topologyOfIndex(const std::filesystem::path& index, const AnalysisOptions& options,
                                      const JobControl& job);

/// For an index whose stored topology has no events: analysed again, and stored in its place. Errors as above;
/// OutOfSpace (its events take more than `options.memoryBytes` here, too: what is stored stays).
Result<IndexTopology> addEvents(const std::filesystem::path& index, AnalysisOptions options, const JobControl& job);

} // namespace isoslider::topology
