#pragma once

#include <cstdint>

namespace isoslider::io {

/// How much memory reading a volume may hold, in this program or in its reader process; that of this machine unless it
/// is set. checkFitsMemory() refuses what needs more. Set before a volume is opened; any thread.
std::uint64_t readingMemoryBytes();
void setReadingMemoryBytes(std::uint64_t bytes);

} // namespace isoslider::io
