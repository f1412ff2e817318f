#pragma once

#include <cstdint>

namespace isoslider {

/// Memory built into this machine, in bytes.
std::uint64_t physicalMemoryBytes();

/// Largest resident set of this process so far, in bytes; 0 where the system does not report it.
std::uint64_t peakRssBytes();

} // namespace isoslider
