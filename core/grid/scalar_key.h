#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <type_traits>

#include "core/grid/scalar_type.h"

namespace isoslider {

/// Samples as unsigned integers in the same order: compared exactly, coded by differences, and the
/// same code for every type. 8- and 16-bit samples have 16-bit keys, f64 64-bit keys, others 32-bit.
template <class Sample>
using KeyOf = std::conditional_t<(sizeof(Sample) <= 2), std::uint16_t,
                                 std::conditional_t<(sizeof(Sample) == 4), std::uint32_t, std::uint64_t>>;

/// REQUIRES: not NaN. -0 and +0 have one key.
template <class Sample>
inline KeyOf<Sample> keyOf(Sample sample) {
    using Key = KeyOf<Sample>;
    if constexpr (std::is_floating_point_v<Sample>) {
        constexpr Key kSign = Key(1) << (8 * sizeof(Key) - 1);
        const Key bits = std::bit_cast<Key>(sample + Sample(0)); // -0 + 0 = +0
        return (bits & kSign) ? static_cast<Key>(~bits) : static_cast<Key>(bits | kSign);
    } else {
        constexpr std::int64_t kLowest = std::numeric_limits<Sample>::lowest();
        return static_cast<Key>(static_cast<std::int64_t>(sample) - kLowest);
    }
}

/// Inverse of keyOf.
template <class Sample>
inline Sample sampleOfKey(KeyOf<Sample> key) {
    using Key = KeyOf<Sample>;
    if constexpr (std::is_floating_point_v<Sample>) {
        constexpr Key kSign = Key(1) << (8 * sizeof(Key) - 1);
        return std::bit_cast<Sample>((key & kSign) ? static_cast<Key>(key & ~kSign) : static_cast<Key>(~key));
    } else {
        return static_cast<Sample>(static_cast<std::int64_t>(key) + std::numeric_limits<Sample>::lowest());
    }
}

/// A position on the isovalue axis between keys: a point is above when key >= threshold.
/// Every isovalue has one, so the rule for ties is exact for every sample type.
using KeyThreshold = std::uint64_t;

/// REQUIRES: isovalue is not NaN.
template <class Sample>
inline KeyThreshold thresholdOf(double isovalue) {
    if constexpr (std::is_same_v<Sample, double>) {
        return keyOf(isovalue);
    } else if constexpr (std::is_same_v<Sample, float>) {
        if (isovalue > std::numeric_limits<float>::max())
            return keyOf(std::numeric_limits<float>::infinity());
        if (isovalue < std::numeric_limits<float>::lowest())
            return 0;
        const float nearest = static_cast<float>(isovalue);
        return KeyThreshold{keyOf(nearest)} + (static_cast<double>(nearest) < isovalue ? 1 : 0);
    } else {
        const double ceiling = std::ceil(isovalue);
        if (ceiling <= static_cast<double>(std::numeric_limits<Sample>::lowest()))
            return 0;
        if (ceiling > static_cast<double>(std::numeric_limits<Sample>::max()))
            return KeyThreshold{keyOf(std::numeric_limits<Sample>::max())} + 1;
        return keyOf(static_cast<Sample>(ceiling));
    }
}

} // namespace isoslider
