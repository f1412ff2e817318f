#pragma once

#include <cstdint>

namespace isoslider::cli {

/// Largest resident set of this process so far, in bytes; 0 where the system does not say.
std::uint64_t peakRssBytes();

} // namespace isoslider::cli
