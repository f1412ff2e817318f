#pragma once

#include <cstdint>

namespace isoslider {

/// Resident set of this process now, in bytes; 0 where the system does not report it. The largest so far: machine.h.
std::uint64_t residentBytes();

/// Largest resident set of the processes that this one started and has waited for; 0 if there was none. It begins with
/// that of this process when it started them.
std::uint64_t peakRssOfHelpersBytes();

/// What the allocator keeps of freed blocks goes back to the system.
void returnFreeBlocks();

} // namespace isoslider
