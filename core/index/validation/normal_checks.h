#pragma once

#include "core/index/validation/fault_list.h"

namespace isoslider::index {

/// Compares the normals that an index of edges keeps with those of the volume's samples: a fault for each chunk that
/// differs. Errors: those of the volume, IoError, Cancelled. REQUIRES: hasNormalChunks(), and the volume has the dims
/// and the type of the index.
Status compareNormals(const IndexReader& reader, const ComparedVolume& volume, FaultList& faults,
                      const JobControl& job);

} // namespace isoslider::index
