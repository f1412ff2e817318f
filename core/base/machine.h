#pragma once

#include <cstdint>

namespace isoslider {

/// Memory built into this machine, in bytes.
std::uint64_t physicalMemoryBytes();

} // namespace isoslider
