#pragma once

#include "core/index/validation/fault_list.h"

namespace isoslider::index {

/// Reads each part that the directory of an index names, in the order of the file: its checksum is right, none lies in
/// another's place, and no byte before meta belongs to none; where `decodes`, its chunks hold what they should. Counts
/// them in `report`. Errors: IoError, Cancelled.
Status checkParts(const IndexReader& reader, bool decodes, FaultList& faults, ValidationReport& report,
                  const JobControl& job);

} // namespace isoslider::index
