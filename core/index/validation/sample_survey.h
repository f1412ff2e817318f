#pragma once

#include <atomic>

#include "core/index/sample_store.h"
#include "core/index/validation/fault_list.h"
#include "core/index/validation/level_checks.h"

namespace isoslider::index {

struct SurveyOptions {
    std::uint64_t memoryBytes = 0; ///< for counting distinct values
    const char* origin = ""; ///< whose samples they are: "the samples", "the volume"
};

/// Compares all that an index states of its samples with samples: range, missing ones, histogram, distinct values,
/// cells with a missing corner, the curve of active edges, and level 0 (`sums`, where they are whole): every usable
/// edge, or every brick with its least and greatest key. Of merged cells, curve and edges are left out: which edges
/// are active is not up to their ends alone. Holds 34 planes. `sums` null: level 0 is not compared.
/// Errors: those of `planes.read`, Cancelled. REQUIRES: `planes` has the dims and the type of the index.
Status surveySamples(const IndexReader& reader, const ComparedVolume& planes, const Level0Sums* sums, FaultList& faults,
                     const SurveyOptions& options, const JobControl& job);

/// Planes of an index; chunks that cannot be read are zeros, and `hasFailed` becomes true: they are
/// reported with the checksums. REQUIRES: all outlive it.
ComparedVolume storedPlanes(const IndexReader& reader, const SampleStore& store, std::atomic<bool>& hasFailed);

/// Compares the samples of an index with those of a volume, bit by bit: a fault for each chunk that
/// differs. Errors: those of the volume, IoError, Cancelled.
Status compareSamples(const IndexReader& reader, const ComparedVolume& volume, FaultList& faults,
                      const JobControl& job);

} // namespace isoslider::index
