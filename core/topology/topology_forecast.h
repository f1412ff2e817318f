#pragma once

#include <cstdint>

#include "core/topology/topology_analysis.h"

namespace isoslider::topology {

/// Bytes that the volume's events and curves will take behind its index, about: off by a fifth as a rule. Looks at
/// cubes spread over the volume and counts the isovalues at which the Euler number changes inside them. O(cubes), a
/// twentieth of a second or so. 0 for a volume that is not analysed. Memory: ten planes. Errors: those of the source;
/// Cancelled.
Result<std::uint64_t> forecastTopologyBytes(const PlaneSource& source, const JobControl& job = {});

} // namespace isoslider::topology
