#pragma once

#include "core/index/validation/fault_list.h"

namespace isoslider::index {

/// Reads each part that the directory of an index names, in the order of the file: its checksum is right, none lies in
/// another's place, and no byte before meta belongs to none. Counts them in `report`. Errors: IoError, Cancelled.
Status checkParts(const IndexReader& reader, FaultList& faults, ValidationReport& report, const JobControl& job);

} // namespace isoslider::index
