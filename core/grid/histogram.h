#pragma once

#include <cstdint>
#include <vector>

namespace isoslider {

/// Counts of finite samples in equal bins over [min, max].
struct Histogram {
    double min = 0.0;
    double max = 0.0;
    std::vector<std::uint64_t> counts;
};

} // namespace isoslider
