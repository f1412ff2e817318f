#pragma once

#include <cstdint>

namespace isoslider {

/// Memory built into this machine, in bytes.
std::uint64_t physicalMemoryBytes();

/// Largest resident set of this process so far, in bytes; 0 where the system does not report it.
std::uint64_t peakRssBytes();

/// The calling thread gives way to all others of the user, from now on.
void lowerThreadPriority();
/// How much the calling thread gives way: 0 is usual, 19 the most. To set less than there is takes a privilege, and
/// does nothing without.
int threadNice();
void setThreadNice(int nice);

/// From now on, freed blocks of 4 MiB and more go back to the system at once. By default the allocator raises that
/// size to what was freed last, up to 32 MiB, and keeps holes that no later buffer fits into: a budget of memory is
/// exceeded though what is in use keeps within it.
void returnLargeBlocksAtOnce();

} // namespace isoslider
