#pragma once

#include <cstdint>

#include "core/base/memory_limit.h"

namespace isoslider::io {

/// What ReadOptions::memoryBytes allows.
inline std::uint64_t readingMemoryOf(std::uint64_t memoryBytes) {
    return memoryBytes > 0 ? memoryBytes : usableMemoryBytes();
}

} // namespace isoslider::io
